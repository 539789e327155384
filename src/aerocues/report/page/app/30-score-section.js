/* Section 2: the score itself. */

addSection({
  id: "score",
  title: "CUES",
  read: "Where good scores come from: which detector goes with which descriptor, how far the best are apart, "
    + "what the criteria weigh, and what speed costs in quality.",
  build(body) {
    for (const spec of [HEAT_MAP, SCORE_DOTS, WEIGHTS, PARETO, COMPONENTS]) addFigure(body, spec);
  },
});

const PIXELS_A_ROW = 20;

/* Height of a figure with one row of text a combination. */
function heightOfRows(count, extra = 70) {
  return Math.max(count, 2) * PIXELS_A_ROW + extra;
}

function categoryAxis(names, extra = {}) {
  return {type: "category", categoryorder: "array", categoryarray: names, autorange: "reversed",
    ticks: "", showgrid: false, tickfont: {size: 11}, ...extra};
}

function names(entry, positions) {
  return positions.map(a => safe(entry.combinations[a]));
}

function withRank(entry, positions) {
  return positions.filter(a => isKnown(entry.score.rank[a]));
}
