/* Distribution over the pairs, one row per combination. */

import {safe} from "../basis/elements.js";
import {firstColumn, mediansOf, pairLabel, pairValues} from "../basis/entries.js";
import {isKnown, isShare, labelOf, percent, valueText} from "../basis/numbers.js";
import {axisLabel, categoryAxis, logAxis, names} from "../shell/axes.js";
import {columnOptions, scaleControl, topControl} from "../shell/controls.js";

/* The first columns of these that an entry has, by pair. */
const QUALITY_COLUMNS = ["ref_precision@3", "precision_beyond_chance", "precision", "f1_score", "inliers"];
/** @typedef {{x: number[], y: string[], ids: string[]}} Points */

/** @type {FigureSpec} */
export const DISTRIBUTIONS = {
  id: "spread", title: "From pair to pair", wide: true,
  read: "Each dot is one image pair; the shape shows their distribution, and its line the median. A wide shape means "
    + "good on some pairs and poor on others. Failed pairs have no dot.",
  controls: [
    {name: "column", label: "Value", options: entry => columnOptions(entry),
      fallback: entry => firstColumn(entry, QUALITY_COLUMNS)},
    {name: "kind", label: "As", fallback: () => "violin", options: () => [
      {key: "violin", label: "violins"}, {key: "box", label: "boxes"}, {key: "strip", label: "dots only"}]},
    {name: "order", label: "Order by", fallback: () => "score", options: () => [
      {key: "score", label: "CUES"}, {key: "median", label: "median of this value"}]},
    topControl([10, 20, 40], 10), scaleControl(),
  ],
  draw(context) {
    const {entry, option, colours} = context;
    const column = option("column");
    const top = orderedBy(context, column, option("order")).slice(0, Number(option("top")));
    const points = pointsOfPairs(entry, column, top, option("scale") === "log");
    if (!points.x.length) return {empty: `None of these combinations has a value for ${labelOf(column)}.`};
    const bounded = isShare(column);
    return {
      data: spreadTraces(points, option("kind"), labelOf(column), colours),
      height: Math.max(top.length, 2) * 40 + 60,
      layout: {
        xaxis: {title: axisLabel(entry, column), ...(option("scale") === "log" ? logAxis(points.x, value => valueText(column, value)) : {}),
          ...(bounded && option("scale") === "linear" ? {range: [-0.02, 1.02]} : {})},
        yaxis: categoryAxis(names(entry, top)), showlegend: false, violinmode: "overlay", violingap: 0.15, boxgap: 0.3, hovermode: "closest",
      },
      note: failuresNote(entry, top),
    };
  },
};

/** @param {FigureContext} context @param {string} column @param {string} order */
function orderedBy({entry, shown: rows}, column, order) {
  if (order === "score") return rows;
  const medians = mediansOf(entry, column);
  const sign = entry.columns[column].better === "lower" ? 1 : -1;
  return rows.filter(a => isKnown(medians[a])).sort((a, b) => sign * (Number(medians[a]) - Number(medians[b])));
}

/** @param {Entry} entry @param {string} column @param {number[]} rows @param {boolean} positive @returns {Points} */
function pointsOfPairs(entry, column, rows, positive) {
  /** @type {Points} */
  const {x, y, ids} = {x: [], y: [], ids: []};
  for (const a of rows) {
    pairValues(entry, column, a).forEach((value, pair) => {
      if (!Number.isFinite(value) || (positive && value <= 0)) return;
      x.push(value);
      y.push(safe(entry.combinations[a]));
      ids.push(`${safe(pairLabel(entry, pair))}`);
    });
  }
  return {x, y, ids};
}

/** One trace for all rows, except for violins: Plotly gives violins of one trace different widths.
 * @param {Points} points @param {string} kind @param {string} name @param {Colours} colours @returns {Trace[]} */
function spreadTraces(points, kind, name, colours) {
  if (kind !== "violin") return [spreadTrace(points, kind, name, colours)];
  return [...new Set(points.y)].map(row => {
    const own = points.y.map((_, i) => i).filter(i => points.y[i] === row);
    const part = {x: own.map(i => points.x[i]), y: own.map(i => points.y[i]), ids: own.map(i => points.ids[i])};
    return {...spreadTrace(part, kind, name, colours), scalegroup: row};
  });
}

/** @param {Points} points @param {string} kind @param {string} name @param {Colours} colours @returns {Trace} */
function spreadTrace({x, y, ids}, kind, name, colours) {
  const color = colours.series[0];
  const marker = {color, size: 4, opacity: 0.65};
  const common = {orientation: "h", name: safe(name), x, y, text: ids, hovertemplate: "%{y}<br>%{text}<br>%{x:.4g}<extra></extra>"};
  if (kind === "violin") {
    return {...common, type: "violin", points: "all", jitter: 0.4, pointpos: 0, marker, spanmode: "hard", hoveron: "points",
      line: {color, width: 1}, fillcolor: `${color}26`, meanline: {visible: false}, scalemode: "width",
      box: {visible: true, width: 0.2, line: {color: colours.ink, width: 1}, fillcolor: "rgba(0,0,0,0)"}};
  }
  const hidden = kind === "strip";
  return {...common, type: "box", boxpoints: "all", jitter: 0.5, pointpos: 0, marker, hoveron: "points",
    line: {color: hidden ? "rgba(0,0,0,0)" : color, width: 1}, fillcolor: hidden ? "rgba(0,0,0,0)" : `${color}26`};
}

/** @param {Entry} entry @param {number[]} rows */
function failuresNote(entry, rows) {
  const failed = rows.filter(a => (entry.score.success_rate[a] ?? 1) < 1);
  if (!failed.length) return "All of these succeeded on every pair.";
  const first = failed.slice(0, 6).map(a => `${entry.combinations[a]} ${percent(entry.score.success_rate[a])}`);
  const more = failed.length > 6 ? ` and ${failed.length - 6} more` : "";
  return `Success rates below 100 %: ${first.join(", ")}${more}.`;
}
