/* Section 5: how far the ranking can be trusted, and how it carries over. */

addSection({
  id: "relations",
  title: "Relations",
  read: "How far the ranking can be trusted: what depends on choices made in the scoring, what other methods of "
    + "decision make of the same numbers, and whether it carries over to other images and machines.",
  build(body) {
    for (const spec of [CRITERIA_MATRIX, SENSITIVITY, AGREEMENT, CRITICAL, SLOPES, RANKINGS_MATRIX]) addFigure(body, spec);
    body.append(make("div", {id: "reversal", class: "figure"}), make("div", {id: "versatility", class: "figure wide"}));
  },
  update(body, changed) {
    if ([...changed].every(key => key.includes(".") || key === "theme")) return;
    body.querySelector("#reversal").replaceChildren(...reversalWords(currentEntry()));
    body.querySelector("#versatility").replaceChildren(...versatilityTable());
    body.querySelector("#versatility").hidden = !payload.comparison;
  },
});

/* A matrix of correlations with its numbers in the cells. */
function matrixFigure({x, y, z, theme, narrow, what, low = -1}) {
  const numbered = narrow && x.length > 4 && x.length === y.length;
  const labels = numbered
    ? {x: x.map((_, i) => `${i + 1} `), y: y.map((name, i) => `${safe(name)} ${i + 1}`)}
    : {x: x.map(safe), y: y.map(safe)};
  const roomy = x.length <= (narrow ? 6 : 12);
  const size = narrow || x.length > 6 ? 9 : 10.5;
  return {
    data: [{
      type: "heatmap", name: what, ...labels, z, zmin: low, zmax: 1, xgap: 1, ygap: 1, hoverongaps: false,
      colorscale: low < 0 ? DIVERGING[theme] : SCALE,
      colorbar: {thickness: 10, outlinewidth: 0, len: 0.8, tickfont: {size: 10}},
      hovertemplate: "%{y}<br>%{x}<br>%{z:.3f}<extra></extra>",
    }, ...(roomy ? cellTexts({...labels, z, texts: z.map(row => row.map(correlationText)), size,
      isBright: value => (low < 0 ? isBrightOnDiverging(theme, value) : isBrightOnScale((value - low) / (1 - low)))}) : [])],
    height: y.length * (y.length > 6 ? 26 : 38) + (numbered ? 60 : (y.length > 6 ? 150 : 100)),
    layout: {xaxis: {...categoryAxis(labels.x), autorange: true, tickangle: !numbered && x.some(each => each.length > 8) ? -40 : 0, tickfont: {size: narrow ? 9 : 10.5}},
      yaxis: {...categoryAxis(labels.y), tickfont: {size: narrow ? 9 : 10.5}}},
  };
}

/* As short as can be: ".92". */
function correlationText(value) {
  return isKnown(value) ? value.toFixed(2).replace(/^(-?)0\./, "$1.").replace("1.00", "1") : "";
}

function lowestOf(matrix) {
  const known = matrix.flat().filter(isKnown);
  return known.length ? Math.min(...known) : 0;
}

/* Correlations of rankings are seldom negative: the colours begin where the values do. */
function lowEnd(matrix) {
  const low = lowestOf(matrix);
  return low < 0 ? -1 : Math.min(0.9, Math.floor(low * 10) / 10);
}

function reversalWords(entry) {
  const found = entry.validation?.rank_reversal;
  const head = [make("h3", {}, "When some are left out"),
    make("p", {class: "read"}, "Scores belong to what is compared: a part of the combinations is left out at random, and the rest is ranked again.")];
  if (!found) return [...head, make("p", {class: "nothing"}, "A single combination cannot be ranked again.")];
  return [...head, figuresList([
    ["Left out each time", percent(found.share)], ["Rounds", shown(found.rounds)],
    ["The best stays the best in", percent(found.best_kept)],
    ["Others move by", `${shown(found.mean_shift, 2)} places on average, ${shown(found.largest_shift)} at most`],
    ["Correlation with the whole", `${fixed(found.spearman_mean, 4)} on average, ${fixed(found.spearman_lowest, 4)} at least`]])];
}
