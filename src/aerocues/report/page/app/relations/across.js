/* Across datasets and machines. */

import {seriesStyle} from "../basis/colours.js";
import {saveCsv} from "../basis/downloads.js";
import {make, plainTable, safe} from "../basis/elements.js";
import {entries} from "../basis/entries.js";
import {shownIn} from "../basis/filter.js";
import {fixed, isKnown, NONE, shown, span} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {scaleControl} from "../shell/controls.js";
import {lowEnd, matrixFigure} from "../shell/matrix.js";

const NO_COMPARISON = "There is only one ranking. To compare rankings, make the report from several results folders.";

/** @type {FigureSpec} */
export const RANKINGS_MATRIX = {
  id: "rankings", title: "Agreement of the rankings", ignoresFilter: true,
  read: "Rank correlation between datasets or machines over the combinations that they share. Near 1, the best on one are also the best on the other.",
  controls: [{name: "of", label: "By", fallback: () => "spearman", options: () => [
    {key: "spearman", label: "Spearman"}, {key: "kendall", label: "Kendall’s tau"}]}],
  draw({option, theme, narrow}) {
    if (!payload.comparison) return {empty: NO_COMPARISON};
    const {names: labels, shared} = payload.comparison;
    const z = payload.comparison[option("of") === "kendall" ? "kendall" : "spearman"];
    const figure = matrixFigure({x: labels, y: labels, z, theme, narrow, what: option("of"), low: lowEnd(z)});
    const numbers = shared.flatMap((row, i) => row.filter((_, j) => j > i));
    return {...figure, note: `Over ${span(numbers)} shared combinations.`};
  },
};

/** @type {FigureSpec} */
export const SLOPES = {
  id: "slopes", title: "Ranks by dataset", tall: true,
  read: "Each line is a combination, with its rank on each dataset; 1 is at the top. A flat line means the same rank everywhere. The best by mean score are shown.",
  controls: [{name: "top", label: "Combinations", fallback: () => "10",
    options: () => [7, 10, 14].map(size => ({key: String(size), label: `${size} most versatile`}))},
  scaleControl("log")],
  acrossEntries: true,
  draw(context) {
    const {option, theme, narrow} = context;
    if (!payload.comparison) return {empty: NO_COMPARISON};
    const top = versatile(payload.comparison).slice(0, Number(option("top")));
    if (!top.length) return {empty: "No combination matches the filter."};
    const labels = payload.comparison.names.map(name => safe(name).replace(" (", "<br>("));
    const data = top.map((row, i) => {
      const {color, symbol} = seriesStyle(theme, i);
      return {type: "scatter", mode: "lines+markers", name: safe(row.alternative), x: labels, y: row.ranks,
        line: {color, width: 1.8, dash: i < 7 ? "solid" : "dot"}, marker: {color, symbol, size: 8}, connectgaps: true,
        hovertemplate: `${safe(row.alternative)}<br>%{x}: rank %{y}<extra></extra>`};
    });
    return {
      data, height: narrow ? 460 + 16 * top.length : 460,
      layout: {hovermode: "closest", xaxis: {type: "category", range: [-0.15, labels.length - 0.85], tickfont: {size: narrow ? 9 : 11}},
        yaxis: {title: "rank", type: option("scale"), autorange: "reversed", ...(option("scale") === "log" ? {tickvals: [1, 2, 3, 5, 10, 20, 50, 100, 200, 400]} : {})},
        legend: narrow ? {} : {orientation: "v", x: 1.01, y: 1, yanchor: "top"}},
    };
  },
};

/** Rows of the comparison that match the filter in at least one entry.
 * @param {Comparison} comparison */
function versatile(comparison) {
  const passed = new Set(entries.flatMap(entry => shownIn(entry).map(a => entry.combinations[a])));
  return comparison.versatility.filter(row => passed.has(row.alternative));
}

const VERSATILE_ROWS = 20;

export function versatilityTable() {
  if (!payload.comparison) return [];
  const rows = versatile(payload.comparison);
  const labels = payload.comparison.names;
  /** @type {PlainColumn<Versatility>[]} */
  const columns = [
    {label: "Combination", text: row => row.alternative},
    {label: "Mean CUES", number: true, text: row => fixed(row.mean)},
    {label: "Lowest", number: true, text: row => fixed(row.min)},
    {label: "Spread", number: true, text: row => fixed(row.spread)},
    {label: "Mean rank", number: true, text: row => shown(row.mean_rank)},
    {label: "Worst rank", number: true, text: row => shown(row.worst_rank)},
    ...labels.map((label, i) => ({label, number: true, title: "CUES and rank",
      text: (/** @type {Versatility} */ row) => (isKnown(row.scores[i]) ? `${fixed(row.scores[i])} (${shown(row.ranks[i])})` : NONE)})),
  ];
  return [make("h3", {}, "Versatility"),
    make("p", {class: "read"}, "Combinations that are good on all datasets, the best mean score first. The spread is the largest minus the smallest score; ranks are in parentheses."),
    make("div", {class: "controls"}, make("span", {class: "save"}, make("button", {type: "button", class: "quiet",
      "aria-label": "Save the versatility table as CSV", onclick: () => saveCsv("versatility",
        ["combination", "mean", "min", "spread", "mean_rank", "worst_rank", ...labels],
        rows.map(row => [row.alternative, row.mean, row.min, row.spread, row.mean_rank, row.worst_rank, ...row.scores]))}, "CSV"))),
    plainTable(`The ${Math.min(rows.length, VERSATILE_ROWS)} most versatile of ${rows.length}`, columns, rows.slice(0, VERSATILE_ROWS))];
}
