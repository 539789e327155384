/* Speed against quality, or any two measures, with the answer and the Pareto front. */

import {measuredAs} from "./candidates.js";
import {rankedForPurpose} from "./purposes.js";
import {seriesStyle} from "../basis/colours.js";
import {measureNamed, measureOf} from "../basis/entries.js";
import {duration, isKnown, shown} from "../basis/numbers.js";
import {state} from "../basis/state.js";
import {openCombination} from "../drawer/combination.js";
import {colourControl, measureOptions} from "../shell/controls.js";
import {rangeOf} from "../shell/drawn-axes.js";
import {isSound, tipLines} from "../shell/points.js";
import {scatterDrawing} from "../shell/scatter-drawing.js";

const SPEEDS = ["seconds_per_1k_ref_matches", "seconds_per_1k_excess_inliers", "seconds_per_1k_inliers", "seconds_per_1k_matches", "total_seconds"];
const QUALITIES = ["ref_precision@3", "precision_beyond_chance", "precision", "f1_score", "inliers"];

/** @param {Entry} entry @param {string[]} keys */
function firstMeasure(entry, keys) {
  return keys.find(key => measureOf(entry, key)) ?? "score";
}

/** The part that is shown larger, and of which figure: of an entry and two measures.
 * @type {{of: string, ranges: AxisRange[] | null}} */
let zoom = {of: "", ranges: null};

/** @type {FigureSpec} */
export const SPEED_QUALITY = {
  id: "pareto", title: "Speed against quality", showsAnswer: true,
  read: "The star is the answer. Nothing is better in both measures than a point on the line; hollow points failed too often.",
  controls: [
    {name: "x", label: "Horizontal", options: measureOptions,
      fallback: entry => entry.validation.pareto.criteria[0] ?? firstMeasure(entry, SPEEDS)},
    {name: "y", label: "Vertical", options: measureOptions,
      fallback: entry => entry.validation.pareto.criteria[1] ?? firstMeasure(entry, QUALITIES)},
    colourControl(),
  ],
  draw(context) {
    const {entry, shown: rows, option, narrow} = context;
    const [x, y] = [measureNamed(entry, option("x")), measureNamed(entry, option("y"))];
    const drawn = rows.filter(a => isKnown(x.values[a]) && isKnown(y.values[a]));
    if (!drawn.length) return {empty: "None of these combinations has both values."};
    const front = paretoFront(drawn.filter(a => isSound(entry, a)), x, y);
    const scatter = scatterOf(context, drawn, front, x, y);
    return {
      svg: () => scatterDrawing(scatter), height: narrow ? 400 : 455, table: tableOf(scatter),
      note: `Best trade-offs: ${front.map(a => entry.combinations[a]).join(", ")}.`,
    };
  },
};

/** @param {FigureContext} context @param {number[]} drawn @param {number[]} front @param {Measure} x @param {Measure} y @returns {Scatter} */
function scatterOf(context, drawn, front, x, y) {
  const {entry, width, narrow, colours} = context;
  const place = (/** @type {number} */ a) => ({x: Number(x.values[a]), y: Number(y.values[a])});
  const axes = {x: axisOf(x, drawn), y: axisOf(y, drawn)};
  const winner = winnerIn(entry, drawn);
  const picked = drawn.find(a => entry.combinations[a] === state.get("decide.pick"));
  /** @type {ScatterMark[]} */
  const marks = winner === null ? [] : [{...place(winner), symbol: "star"}];
  if (picked !== undefined) marks.push({...place(picked), symbol: "ring"});
  const names = frontLabels(context, front.filter(a => a !== winner), x, y, axes).map(label => ({...label, ...place(label.a)}));
  const of = [entry.name, x.key, y.key].join("\n");
  return {
    zoomed: zoom.of === of ? zoom.ranges : null, keepZoom: ranges => { zoom = {of, ranges}; },
    id: "pareto", width, height: narrow ? 400 : 455, narrow, colours, ...axes, marks,
    line: front.map(place), groups: groupsOf(context, drawn, x, y),
    labels: winner === null ? names : [...names, {...place(winner), text: entry.combinations[winner], bold: true, dx: 16, dy: 30}],
    open: openCombination,
  };
}

/** One group of points for each method, as the legend names them.
 * @param {FigureContext} context @param {number[]} drawn @param {Measure} x @param {Measure} y */
function groupsOf({entry, option, theme}, drawn, x, y) {
  const methods = entry[/** @type {Code} */ (option("colour"))];
  const groups = [...new Set(methods)].map((name, i) => ({
    name, style: seriesStyle(theme, i),
    points: drawn.filter(a => methods[a] === name).map(a => ({x: Number(x.values[a]), y: Number(y.values[a]),
      name: entry.combinations[a], hollow: !isSound(entry, a), tip: tipLines(entry, a, x, y).join("\n")})),
  }));
  return groups.filter(group => group.points.length);
}

/** @param {Scatter} scatter @returns {Table} */
function tableOf({groups}) {
  return [["series", "x", "y", "value_or_name"], groups.flatMap(group => group.points.map(point => [group.name, point.x, point.y, point.name]))];
}

/** The answer, or the same features with another matcher, where it is among the points.
 * @param {Entry} entry @param {number[]} drawn */
function winnerIn(entry, drawn) {
  const [first] = rankedForPurpose();
  const a = first ? measuredAs(entry, first.name) : null;
  return a !== null && drawn.includes(a) ? a : null;
}

/** Times and counts that span more than a factor of 10 get a logarithmic axis.
 * @param {Measure} measure @param {number[]} rows @returns {ScatterAxis} */
function axisOf(measure, rows) {
  const better = measure.better ? ` (${measure.better === "lower" ? "less" : "more"} is better)` : "";
  const timed = /seconds/.test(measure.key);
  return {title: `${measure.label}${better}`, words: timed ? duration : shown,
    range: rangeOf(rows.map(a => measure.values[a]), timed || isCount(measure.key))};
}

/** @param {string} name */
function isCount(name) {
  return /^(inliers|excess_inliers|matches|ref_matches@3|keypoints_\d|points_3d)$/.test(name);
}

/** @param {number[]} rows @param {Measure} x @param {Measure} y */
function paretoFront(rows, x, y) {
  /** @type {(measure: Measure, a: number) => number} */
  const good = (measure, a) => (measure.better === "lower" ? -1 : 1) * Number(measure.values[a]);
  const order = [...rows].sort((a, b) => good(x, b) - good(x, a) || good(y, b) - good(y, a));
  let best = -Infinity;
  return order.filter(a => {
    if (good(y, a) <= best) return false;
    best = good(y, a);
    return true;
  });
}

/** Names of a few points on the front, far enough apart not to overlap.
 * @param {FigureContext} context @param {number[]} front @param {Measure} x @param {Measure} y
 * @param {{x: ScatterAxis, y: ScatterAxis}} axes */
function frontLabels({entry, narrow, width}, front, x, y, axes) {
  if (!front.length) return [];
  const share = (/** @type {Measure} */ measure, /** @type {AxisRange} */ {isLog, low, high}, /** @type {number} */ a) =>
    ((isLog ? Math.log10 : Number)(Number(measure.values[a])) - low) / (high - low);
  /** @type {(a: number, b: number) => boolean} */
  const near = (a, b) => Math.abs(share(x, axes.x.range, a) - share(x, axes.x.range, b)) * width < 170
    && Math.abs(share(y, axes.y.range, a) - share(y, axes.y.range, b)) * 400 < 26;
  /** @type {number[]} */
  const picked = [];
  for (const a of [front[0], front[front.length - 1], ...front]) {
    if (picked.length < (narrow ? 3 : 7) && !picked.some(b => near(a, b))) picked.push(a);
  }
  return picked.map((a, i) => ({a, text: entry.combinations[a], bold: false, dx: x.better === "lower" ? -30 : 30, dy: i % 2 ? -34 : -16}));
}
