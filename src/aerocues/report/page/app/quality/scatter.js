/* Two measures against each other: means of combinations, or the density of all pairs. */

import {SCALE} from "../basis/colours.js";
import {hasColumn, meansOf, measureNamed, pairValues} from "../basis/entries.js";
import {counted, fixed, isKnown} from "../basis/numbers.js";
import {boundsOf, spanOf, spearman, valuesAt} from "../basis/statistics.js";
import {axisLabel, logAxis} from "../shell/axes.js";
import {colourControl} from "../shell/controls.js";
import {pointsByMethod, scatterFrame} from "../shell/points.js";

/** Traces behind the points.
 * @typedef {(context: FigureContext, drawn: number[], x: Measure, y: Measure) => Trace[]} Band */

/** @param {FigureContext} context @param {string} xName @param {string} yName
 * @param {{log: boolean, band?: Band, measure?: (entry: Entry, name: string) => Measure}} style @returns {Drawn} */
export function scatterDraw(context, xName, yName, {log, band, measure = measureNamed}) {
  const {entry, option, theme, narrow, shown: rows} = context;
  const each = option("points") === "pairs";
  const valuesOf = (/** @type {string} */ name) => (each ? rows.flatMap(a => Array.from(pairValues(entry, name, a)))
    : valuesAt(meansOf(entry, name), rows));
  const axis = (/** @type {string} */ name) => ({title: axisLabel(entry, name), tickangle: 0, nticks: narrow ? 5 : 8,
    ...(log ? logAxis(valuesOf(name)) : {})});
  const axes = {xaxis: axis(xName), yaxis: axis(yName)};
  const height = narrow ? 420 : 460;
  if (each) return densityOfPairs(context, xName, yName, log, axes, height);
  const [x, y] = [measure(entry, xName), measure(entry, yName)];
  const fits = (/** @type {Value} */ value) => isKnown(value) && (!log || value > 0);
  const drawn = rows.filter(a => fits(x.values[a]) && fits(y.values[a]));
  if (!drawn.length) return {empty: "None of these combinations has both values."};
  return {
    data: [...(band ? band(context, drawn, x, y) : []), ...pointsByMethod(entry, drawn, option("colour"), x, y, theme)],
    height,
    layout: scatterFrame(axes.xaxis, axes.yaxis, narrow),
    note: `Spearman’s correlation over ${counted(drawn.length, "combination")}: `
      + `${fixed(spearman(valuesAt(x.values, drawn), valuesAt(y.values, drawn)), 2)}.`,
  };
}

const BINS = 60;

/** All pairs of all combinations as counts on a grid, because tens of thousands of dots would overlap.
 * @param {FigureContext} context @param {string} xName @param {string} yName @param {boolean} log
 * @param {{xaxis: Axis, yaxis: Axis}} axes @param {number} height @returns {Drawn} */
function densityOfPairs({entry, shown: rows, narrow}, xName, yName, log, axes, height) {
  const scale = log ? Math.log10 : Number;
  /** @type {number[][]} */
  const points = [];
  for (const a of rows) {
    const [x, y] = [pairValues(entry, xName, a), pairValues(entry, yName, a)];
    for (let i = 0; i < x.length; i += 1) {
      const point = [scale(x[i]), scale(y[i])];
      if (point.every(Number.isFinite)) points.push(point);
    }
  }
  if (!points.length) return {empty: "None of these combinations has both values."};
  const bounds = [0, 1].map(axis => spanOf(points.map(point => point[axis])));
  const counts = Array.from({length: BINS}, () => new Array(BINS).fill(0));
  for (const point of points) {
    const [i, j] = point.map((value, axis) => Math.min(BINS - 1,
      Math.floor(BINS * (value - bounds[axis][0]) / (bounds[axis][1] - bounds[axis][0]))));
    counts[j][i] += 1;
  }
  const centres = (/** @type {number} */ axis) => Array.from({length: BINS}, (_, i) => {
    const value = bounds[axis][0] + (i + 0.5) * (bounds[axis][1] - bounds[axis][0]) / BINS;
    return log ? 10 ** value : value;
  });
  return {
    data: [{type: "heatmap", name: "pairs", x: centres(0), y: centres(1), z: counts.map(row => row.map(n => (n ? Math.log10(n) : null))),
      customdata: counts, colorscale: SCALE, hovertemplate: "%{customdata} pairs<br>%{x:.3g}, %{y:.3g}<extra></extra>",
      colorbar: {thickness: 10, outlinewidth: 0, title: {text: "pairs", side: "top"}, tickvals: [0, 1, 2, 3, 4],
        ticktext: ["1", "10", "100", "1000", "10000"], len: narrow ? 0.6 : 0.8}}],
    height, layout: axes, note: `${points.length.toLocaleString("en")} measurements of single pairs.`,
  };
}

/** @type {ControlSpec} */
const POINTS = {name: "points", label: "Points", fallback: () => "means",
  options: () => [{key: "means", label: "means of combinations"}, {key: "pairs", label: "density of all pairs"}]};

/** @type {FigureSpec} */
export const PRECISION_RECALL = {
  id: "pr", title: "Precision against recall",
  read: "Vertical: share of matches that are correct. Horizontal: share of keypoints with a correct match. Top right "
    + "is best.",
  controls: [colourControl("descriptor"), POINTS],
  available: entry => (precisionRecall(entry) ? true : "Precision and recall were not measured."),
  draw(context) {
    const [x, y] = precisionRecall(context.entry) ?? ["recall", "precision"];
    return scatterDraw(context, x, y, {log: false});
  },
};

/** @param {Entry} entry */
function precisionRecall(entry) {
  return [["recall_beyond_chance", "precision_beyond_chance"], ["recall", "precision"]]
    .find(pair => pair.every(name => hasColumn(entry, name))) ?? null;
}

/** @type {FigureSpec} */
export const INLIERS_MATCHES = {
  id: "im", title: "Inliers against matches",
  read: "Many matches are of little use if few are correct. On the upper line all matches are inliers, on the lower "
    + "line one in ten. Both axes are logarithmic.",
  controls: [colourControl("detector"), POINTS],
  available: entry => (hasColumn(entry, "inliers") && hasColumn(entry, "matches") ? true : "Inliers and matches were not measured."),
  draw: context => scatterDraw(context, "matches", "inliers", {log: true, band: shareLines}),
};

/** @type {Band} */
function shareLines({colours}, drawn, x) {
  const [low, high] = boundsOf(valuesAt(x.values, drawn));
  return [1, 0.1].map(share => ({type: "scatter", mode: "lines", name: "not in the table", showlegend: false,
    x: [low, high], y: [share * low, share * high], hoverinfo: "skip", line: {color: colours.line, width: 1, dash: "dot"}}));
}
