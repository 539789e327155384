/* The critical-difference diagram of Demsar: mean ranks, and bars over groups without significant difference. */

import {safe} from "../basis/elements.js";
import {counted, shown} from "../basis/numbers.js";

/** @type {FigureSpec} */
export const CRITICAL = {
  id: "critical", title: "Critical difference", ignoresFilter: true,
  read: "Mean ranks of the best combinations over the pairs (or scenes), with 1 on the left. Combinations under one bar do not differ significantly "
    + "by Nemenyi’s test. Each pair is ranked separately, so the order can differ from that by CUES.",
  draw({entry, colours, narrow}) {
    const found = entry.validation.critical_difference;
    if (found.unavailable !== undefined) return {empty: found.unavailable};
    const rows = found.alternatives.map(safe);
    const ranks = found.mean_ranks;
    const bars = found.groups.map(([first, last], i) => ({
      type: "scatter", mode: "lines", name: i ? "not in the table" : "no significant difference", showlegend: i === 0,
      x: [ranks[first], ranks[last]], y: [-1 - i * 0.7, -1 - i * 0.7], hoverinfo: "skip",
      line: {color: colours.series[1], width: 5}}));
    const stems = {type: "scatter", mode: "lines", name: "not in the table", showlegend: false, hoverinfo: "skip",
      x: ranks.flatMap(rank => [rank, rank, null]), y: ranks.flatMap((_, i) => [-1 - found.groups.length * 0.7, i, null]),
      line: {color: colours.grid, width: 1}};
    const dots = {type: "scatter", mode: "markers+text", name: "mean rank", x: ranks, y: ranks.map((_, i) => i), ids: rows,
      text: rows.map((name, i) => `${name} ${ranks[i].toFixed(1)}`), textposition: ranks.map(rank => (rank > middleOf(ranks) ? "middle left" : "middle right")),
      textfont: {size: narrow ? 9.5 : 11}, marker: {color: colours.series[0], size: 9}, showlegend: false,
      hovertemplate: "%{text}<extra></extra>"};
    const reach = (ranks[ranks.length - 1] - ranks[0]) || 1;
    return {
      data: [stems, ...bars, dots], height: (ranks.length + found.groups.length * 0.7) * 22 + 110,
      layout: {hovermode: "closest",
        xaxis: {title: "mean rank", side: "bottom", range: [ranks[0] - reach * 0.08, ranks[ranks.length - 1] + reach * 0.08]},
        yaxis: {visible: false, range: [ranks.length - 0.3, -1.6 - found.groups.length * 0.7]}},
      note: `Critical difference ${shown(found.critical_difference)} over ${counted(found.units, "unit")}; Friedman’s test: `
        + `chi-square ${shown(found.chi_square)}, p ${found.p_value < 0.001 ? "< 0.001" : `= ${shown(found.p_value, 2)}`}.`,
    };
  },
};

/** @param {number[]} ranks */
function middleOf(ranks) {
  return (ranks[0] + ranks[ranks.length - 1]) / 2;
}
