/* Speed against quality, or any two measures, with the answer and the Pareto front. */

import {measuredAs} from "./candidates.js";
import {rankedForPurpose} from "./purposes.js";
import {safe} from "../basis/elements.js";
import {measureNamed, measureOf} from "../basis/entries.js";
import {duration, isKnown, shown} from "../basis/numbers.js";
import {spanOf} from "../basis/statistics.js";
import {logAxis} from "../shell/axes.js";
import {colourControl, measureOptions} from "../shell/controls.js";
import {isSound, pointsByMethod, scatterFrame} from "../shell/points.js";

const SPEEDS = ["seconds_per_1k_ref_matches", "seconds_per_1k_excess_inliers", "seconds_per_1k_inliers", "seconds_per_1k_matches", "total_seconds"];
const QUALITIES = ["ref_precision@3", "precision_beyond_chance", "precision", "f1_score", "inliers"];

/** @param {Entry} entry @param {string[]} keys */
function firstMeasure(entry, keys) {
  return keys.find(key => measureOf(entry, key)) ?? "score";
}

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
    const {entry, shown: rows, option, narrow, colours, theme} = context;
    const [x, y] = [measureNamed(entry, option("x")), measureNamed(entry, option("y"))];
    const drawn = rows.filter(a => isKnown(x.values[a]) && isKnown(y.values[a]));
    if (!drawn.length) return {empty: "None of these combinations has both values."};
    const sound = drawn.filter(a => isSound(entry, a));
    const front = paretoFront(sound, x, y);
    const step = {type: "scatter", mode: "lines", name: "not in the table", showlegend: false, hoverinfo: "skip",
      x: front.map(a => x.values[a]), y: front.map(a => y.values[a]), line: {color: colours.line, width: 1.5}};
    const winner = winnerIn(entry, drawn);
    const stars = winner === null ? [] : [starOf(entry, winner, x, y, colours)];
    return {
      data: [step, ...pointsByMethod(entry, drawn, option("colour"), x, y, theme), ...stars],
      height: narrow ? 400 : 455,
      layout: {
        ...scatterFrame(measureAxis(x, drawn), measureAxis(y, drawn), narrow),
        annotations: [...frontLabels(context, drawn, front.filter(a => a !== winner), x, y),
          ...(winner === null ? [] : [labelOf(context, drawn, winner, x, y)])],
      },
      note: `Best trade-offs: ${front.map(a => entry.combinations[a]).join(", ")}.`,
    };
  },
};

/** The answer, or the same features with another matcher, where it is among the points.
 * @param {Entry} entry @param {number[]} drawn */
function winnerIn(entry, drawn) {
  const [first] = rankedForPurpose();
  const a = first ? measuredAs(entry, first.name) : null;
  return a !== null && drawn.includes(a) ? a : null;
}

/** @param {Entry} entry @param {number} a @param {Measure} x @param {Measure} y @param {Colours} colours @returns {Trace} */
function starOf(entry, a, x, y, colours) {
  return {type: "scatter", mode: "markers", name: "not in the table", showlegend: false, x: [x.values[a]], y: [y.values[a]],
    ids: [safe(entry.combinations[a])], hovertext: [`<b>${safe(entry.combinations[a])}</b><br>the answer`], hoverinfo: "text",
    marker: {symbol: "star", size: 19, color: colours.ink, line: {width: 1.5, color: colours.surface}}};
}

/** @param {FigureContext} context @param {number[]} drawn @param {number} a @param {Measure} x @param {Measure} y */
function labelOf({entry, colours}, drawn, a, x, y) {
  const place = placeOn(drawn);
  return {x: place(x, a), y: place(y, a), text: `<b>${safe(entry.combinations[a])}</b>`, showarrow: true, arrowhead: 0, arrowwidth: 1,
    arrowcolor: colours.ink, ax: 40, ay: 34, font: {size: 12, color: colours.ink}, bgcolor: colours.surface};
}

/** Places on the axes, logarithmic or not.
 * @param {number[]} drawn @returns {(measure: Measure, a: number) => number} */
function placeOn(drawn) {
  /** @type {Map<Measure, (value: number) => number>} */
  const scales = new Map();
  return (measure, a) => {
    const scale = scales.get(measure) ?? (measureAxis(measure, drawn).type === "log" ? Math.log10 : Number);
    scales.set(measure, scale);
    return scale(Number(measure.values[a]));
  };
}

/** Times and counts that span more than a factor of 10 get a logarithmic axis.
 * @param {Measure} measure @param {number[]} rows @returns {Axis} */
function measureAxis(measure, rows) {
  const values = rows.map(a => measure.values[a]).filter(isKnown);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const better = measure.better ? ` (${measure.better === "lower" ? "less" : "more"} is better)` : "";
  const title = safe(`${measure.label}${better}`);
  const timed = /seconds/.test(measure.key);
  if (!(timed || isCount(measure.key)) || low <= 0 || high / low < 10) return {title};
  return {title, tickangle: 0, ...logAxis(values, timed ? duration : shown)};
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
 * @param {FigureContext} context @param {number[]} drawn @param {number[]} front @param {Measure} x @param {Measure} y */
function frontLabels({entry, narrow, colours, width}, drawn, front, x, y) {
  if (!front.length) return [];
  const place = placeOn(drawn);
  const [spanX, spanY] = [x, y].map(measure => spanOf(drawn.map(a => place(measure, a))));
  /** @type {(a: number, b: number) => boolean} */
  const near = (a, b) => Math.abs(place(x, a) - place(x, b)) / (spanX[1] - spanX[0]) * width < 170
    && Math.abs(place(y, a) - place(y, b)) / (spanY[1] - spanY[0]) * 400 < 26;
  /** @type {number[]} */
  const picked = [];
  for (const a of [front[0], front[front.length - 1], ...front]) {
    if (picked.length < (narrow ? 3 : 7) && !picked.some(b => near(a, b))) picked.push(a);
  }
  return picked.map((a, i) => ({
    x: place(x, a), y: place(y, a), text: safe(entry.combinations[a]), showarrow: true, arrowhead: 0, arrowwidth: 1,
    arrowcolor: colours.line, ax: x.better === "lower" ? -30 : 30, ay: i % 2 ? -34 : -16, font: {size: 10, color: colours.muted},
  }));
}
