/* Section 2: the score itself. */

addSection({
  id: "score",
  title: "CUES",
  read: "Where good scores come from: which detector goes with which descriptor, how far the best are apart, "
    + "what the criteria weigh, and what speed costs in quality.",
  build(body) {
    for (const spec of [HEAT_MAP, SCORE_DOTS, WEIGHTS, COMPONENTS, PARETO]) addFigure(body, spec);
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

/* 1, 2, 5, 10, .. or, over many powers, 1, 10, 100, .. between two values. */
function logTicks(low, high) {
  const [from, to] = [Math.log10(low), Math.log10(high)];
  const steps = to - from > 2.2 ? [1] : (to - from > 1.2 ? [1, 3] : [1, 2, 5]);
  const ticks = [];
  for (let power = Math.floor(from) - 1; power <= Math.ceil(to); power += 1) {
    for (const step of steps) ticks.push(Number(`${step}e${power}`));
  }
  return ticks;
}

/* A logarithmic axis for some values, with ticks in words. */
function logAxis(values, words = shown) {
  const known = values.filter(value => isKnown(value) && value > 0);
  const ticks = known.length ? logTicks(...boundsOf(known)) : [1];
  return {type: "log", tickvals: ticks, ticktext: ticks.map(value => safe(words(value)))};
}

function boundsOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

function withRank(entry, positions) {
  return positions.filter(a => isKnown(entry.score.rank[a]));
}
