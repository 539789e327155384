/* Speed against quality, or any two measures, with the front of what nothing beats in both. */

const SPEEDS = ["seconds_per_1k_excess_inliers", "seconds_per_1k_inliers", "seconds_per_1k_matches", "total_seconds"];
const QUALITIES = ["precision_beyond_chance", "precision", "f1_score", "inliers"];

function firstMeasure(entry, keys) {
  return keys.find(key => measureOf(entry, key)) ?? "score";
}

const PARETO = {
  id: "pareto", title: "Speed against quality", wide: true,
  read: "A point is a combination, by its means over the pairs that did not fail. Points on the line are beaten by none in both "
    + "measures at once. Hollow ones failed too often to count there.",
  controls: [
    {name: "x", label: "Across", options: measureOptions,
      fallback: entry => entry.validation?.pareto?.criteria?.[0] ?? firstMeasure(entry, SPEEDS)},
    {name: "y", label: "Up", options: measureOptions,
      fallback: entry => entry.validation?.pareto?.criteria?.[1] ?? firstMeasure(entry, QUALITIES)},
    colourControl(),
  ],
  draw(context) {
    const {entry, shown: rows, option, narrow, colours, theme} = context;
    const [x, y] = [measureOf(entry, option("x")), measureOf(entry, option("y"))];
    const drawn = rows.filter(a => isKnown(x.values[a]) && isKnown(y.values[a]));
    if (!drawn.length) return {empty: "None of these combinations has both values."};
    const sound = drawn.filter(a => isSound(entry, a));
    const front = paretoFront(sound, x, y);
    const step = {type: "scatter", mode: "lines", name: "not in the table", showlegend: false, hoverinfo: "skip",
      x: front.map(a => x.values[a]), y: front.map(a => y.values[a]), line: {color: colours.line, width: 1.5}};
    return {
      data: [step, ...pointsByMethod(entry, drawn, option("colour"), x, y, theme)],
      height: narrow ? 480 : 560,
      layout: {
        ...scatterFrame(measureAxis(x, drawn), measureAxis(y, drawn), narrow),
        annotations: front.length ? frontLabels(context, drawn, front, x, y) : [],
      },
      note: `Not beaten in both: ${front.map(a => entry.combinations[a]).join(", ")}.`,
    };
  },
};

/* Axes, margins and legend of a cloud of points. The margins are given, as to have Plotly find them
   takes it twice the time. */
function scatterFrame(xaxis, yaxis, narrow) {
  return {
    xaxis: {...xaxis, automargin: false}, yaxis: {...yaxis, automargin: false}, hovermode: "closest",
    margin: narrow ? {l: 54, b: 44} : {l: 62, b: 48, r: 104},
    legend: narrow ? {} : {orientation: "v", x: 1.01, y: 1, yanchor: "top"},
  };
}

/* Times and counts that reach over more than a factor of 10 are better seen on a logarithmic axis. */
function measureAxis(measure, rows) {
  const values = rows.map(a => measure.values[a]).filter(isKnown);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const better = measure.better ? ` (${measure.better === "lower" ? "less" : "more"} is better)` : "";
  const title = safe(`${measure.label}${better}`);
  const timed = /seconds/.test(measure.key);
  if (!(timed || isCount(measure.key)) || low <= 0 || high / low < 10) return {title};
  return {title, ...logAxis(values, timed ? duration : shown)};
}

/* Means leave failed pairs out, so what fails on the hard ones looks good: a success rate near the
   best score's is asked for. */
function isSound(entry, a) {
  const {success_rate: success, best, settings} = entry.score;
  return !isKnown(success[best]) || success[a] >= (settings?.good ?? 0.9) * success[best];
}

function isCount(name) {
  return /^(inliers|excess_inliers|matches|keypoints_\d|points_3d)$/.test(name);
}

function pointsByMethod(entry, rows, code, x, y, theme) {
  const groups = [...new Set(entry[code])];
  return groups.map((name, i) => {
    const members = rows.filter(a => entry[code][a] === name);
    const {color, symbol, outline} = seriesStyle(theme, i);
    return {
      type: "scatter", mode: "markers", name: safe(name), x: members.map(a => x.values[a]),
      y: members.map(a => y.values[a]), ids: names(entry, members), marker: {color, symbol: members.map(a => (isSound(entry, a) ? symbol : outline)), size: 8, opacity: 0.85},
      hovertext: members.map(a => pointText(entry, a, x, y)), hoverinfo: "text",
    };
  }).filter(trace => trace.x.length);
}

function pointText(entry, a, ...measures) {
  return `<b>${safe(entry.combinations[a])}</b>${measures.map(measure =>
    `<br>${safe(measure.label)}: ${safe(valueText(measure.key, measure.values[a]))}`).join("")}`
    + `<br>CUES ${fixed(entry.score.score[a])}, rank ${shown(entry.score.rank[a])}, succeeds on ${percent(entry.score.success_rate[a])}`;
}

function paretoFront(rows, x, y) {
  const sign = measure => (measure.better === "lower" ? -1 : 1);
  const good = (measure, a) => sign(measure) * measure.values[a];
  const order = [...rows].sort((a, b) => good(x, b) - good(x, a) || good(y, b) - good(y, a));
  let best = -Infinity;
  return order.filter(a => {
    if (good(y, a) <= best) return false;
    best = good(y, a);
    return true;
  });
}

/* Names of a few points on the front, so far apart that they do not cover each other. */
function frontLabels({entry, narrow, colours, width}, drawn, front, x, y) {
  const place = (measure, a) => (measureAxis(measure, drawn).type === "log" ? Math.log10(measure.values[a]) : measure.values[a]);
  const [spanX, spanY] = [x, y].map(measure => spanOf(drawn.map(a => place(measure, a))));
  const near = (a, b) => Math.abs(place(x, a) - place(x, b)) / (spanX[1] - spanX[0]) * width < 170
    && Math.abs(place(y, a) - place(y, b)) / (spanY[1] - spanY[0]) * 400 < 26;
  const picked = [];
  for (const a of [front[0], front[front.length - 1], ...front]) {
    if (picked.length < (narrow ? 3 : 7) && !picked.some(b => near(a, b))) picked.push(a);
  }
  return picked.map((a, i) => ({
    x: place(x, a), y: place(y, a), text: safe(entry.combinations[a]), showarrow: true, arrowhead: 0, arrowwidth: 1,
    arrowcolor: colours.line, ax: x.better === "lower" ? -30 : 30, ay: i % 2 ? -34 : -16, font: {size: 10, color: colours.muted},
  }));
}
