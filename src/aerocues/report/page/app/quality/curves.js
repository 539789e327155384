/* Curves along graded transformations: one panel per transformation, one line per combination. */

import {seriesStyle, SYMBOLS} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {firstColumn, pairValues} from "../basis/entries.js";
import {labelOf} from "../basis/numbers.js";
import {meanOf} from "../basis/statistics.js";
import {columnOptions} from "../shell/controls.js";

/** @type {FigureSpec} */
export const CURVES = {
  id: "curves", title: "Along the transformations", wide: true,
  read: "How the value changes with the strength of the transformation. A flat line means robust. A gap is a failure; "
    + "so is a line that ends before the others.",
  controls: [
    {name: "column", label: "Value", options: entry => columnOptions(entry),
      fallback: entry => firstColumn(entry, ["ref_precision@3", "precision_beyond_chance", "precision", "inliers"])},
    {name: "top", label: "Combinations", fallback: () => "5",
      options: () => [3, 5, 7].map(size => ({key: String(size), label: `best ${size}`}))},
    {name: "failed", label: "Failures", fallback: () => "gap", options: () => [
      {key: "gap", label: "leave a gap"}, {key: "zero", label: "count as 0"}]},
  ],
  available: entry => (entry.curves?.length ? true : "These images are not a graded series, so there are no curves."),
  draw(context) {
    const {entry, option, narrow, theme, shown: rows} = context;
    const column = option("column");
    const top = rows.slice(0, Number(option("top")));
    const columns = narrow ? 1 : [1, 1, 2, 3, 2][entry.curves.length] ?? 3;
    const lines = Math.ceil(entry.curves.length / columns);
    /** @type {Layout} */
    const layout = {annotations: [], hovermode: "closest", margin: {t: 30},
      legend: {y: 1 + 40 / (lines * 230), yanchor: "bottom"}};
    const data = entry.curves.flatMap((curve, i) => {
      placeCurve(layout, curve, i, {columns, lines});
      return top.map((a, line) => curveTrace(entry, curve, column, a, {i, line, theme, zero: option("failed") === "zero"}));
    });
    return {data, layout, height: lines * 230 + 50 + (narrow ? 16 * top.length : 16),
      note: `Vertical axis: ${labelOf(column)}.`};
  },
};

/** Means over the pairs at the same place of a curve.
 * @param {Entry} entry @param {Curve} curve @param {string} column @param {number} a @param {boolean} zero */
function curvePoints(entry, curve, column, a, zero) {
  const values = pairValues(entry, column, a);
  /** @type {Map<number, number[]>} */
  const at = new Map();
  curve.pairs.forEach((pair, i) => {
    const value = zero && !Number.isFinite(values[pair]) ? 0 : values[pair];
    at.set(curve.x[i], [...(at.get(curve.x[i]) ?? []), value]);
  });
  const places = [...at].sort(([p], [q]) => p - q);
  return {x: places.map(([place]) => place), y: places.map(([, found]) => meanOf(found))};
}

/** @param {Entry} entry @param {Curve} curve @param {string} column @param {number} a
 * @param {{i: number, line: number, theme: Theme, zero: boolean}} place  `i` of the panel, `line` of the combination.
 * @returns {Trace} */
function curveTrace(entry, curve, column, a, {i, line, theme, zero}) {
  const {color} = seriesStyle(theme, line);
  const name = safe(entry.combinations[a]);
  return {
    type: "scatter", mode: "lines+markers", name, legendgroup: name, showlegend: i === 0,
    ...curvePoints(entry, curve, column, a, zero), connectgaps: false,
    xaxis: `x${i + 1}`, yaxis: `y${i + 1}`, line: {color, width: 1.6},
    marker: {color, symbol: SYMBOLS[line % SYMBOLS.length], size: 6},
    hovertemplate: `${name}<br>${safe(curve.name)} %{x}: %{y:.3g}<extra></extra>`,
  };
}

/** @param {Layout} layout @param {Curve} curve @param {number} i @param {{columns: number, lines: number}} grid */
function placeCurve(layout, curve, i, {columns, lines}) {
  const [line, place] = [Math.floor(i / columns), i % columns];
  const gap = 0.06;
  const wide = (1 - gap * (columns - 1)) / columns;
  const left = place * (wide + gap);
  const top = 1 - line / lines;
  const bottom = top - (1 / lines) * 0.7;
  const suffix = i ? String(i + 1) : "";
  layout[`xaxis${suffix}`] = {domain: [left, left + wide], anchor: `y${i + 1}`, title: {text: safe(curve.axis), standoff: 4}, nticks: 8,
    automargin: false, tickvals: curve.x.length <= 8 ? [...new Set(curve.x)] : undefined};
  layout[`yaxis${suffix}`] = {domain: [bottom, top], anchor: `x${i + 1}`, rangemode: "tozero", nticks: 5, automargin: i === 0,
    ...(i ? {matches: "y"} : {})};
  layout.annotations.push({text: `<b>${safe(curve.name)}</b>`, xref: "paper", yref: "paper", x: left, y: top,
    xanchor: "left", yanchor: "bottom", showarrow: false, font: {size: 12}});
}
