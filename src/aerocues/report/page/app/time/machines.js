/* The same dataset on two machines. */

import {seriesStyle} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {counted, duration, fixed, shown} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {categoryAxis, heightOfRows} from "../shell/axes.js";

/** @param {Entry} entry */
function machinesOf(entry) {
  return payload.machines.filter(each => [each.first, each.second].includes(entry.name));
}

/** @type {FigureSpec} */
export const MACHINES = {
  id: "machines", title: "Between machines", ignoresFilter: true,
  read: "Time on the second machine divided by time on the first, by stage. The dot is the geometric mean over the same "
    + "measurements; the bar contains 90 % of them. A rank correlation near 1 means that both machines agree on what is fast.",
  available: entry => (machinesOf(entry).length ? true : "This dataset was measured on one machine only."),
  draw({entry, theme}) {
    const both = machinesOf(entry);
    const known = both.flatMap(({second, times}) => (Array.isArray(times) ? [{second, times}] : []));
    if (!known.length) return {empty: both.map(({times}) => (Array.isArray(times) ? "" : times.unavailable)).join("; ")};
    const rows = known.flatMap(({second, times}) => times.map(time => ({...time,
      label: known.length > 1 ? safe(`${second}: ${time.stage}`) : safe(time.stage)})));
    const {color} = seriesStyle(theme, 0);
    const colour = seriesStyle(theme, 1).color;
    return {
      data: [{type: "scatter", mode: "markers", name: "ratio of times", x: rows.map(row => row.ratio), y: rows.map(row => row.label),
        marker: {color: rows.map(row => (row.stage === "total" ? colour : color)), size: 10},
        error_x: {type: "data", symmetric: false, array: rows.map(row => row.ratio_high - row.ratio),
          arrayminus: rows.map(row => row.ratio - row.ratio_low), color, thickness: 1.5},
        hovertext: rows.map(row => `<b>${row.label}</b><br>${shown(row.ratio)} times as long (${shown(row.ratio_low)} to ${shown(row.ratio_high)})`
          + `<br>medians ${safe(duration(row.first_seconds))} and ${safe(duration(row.second_seconds))}`
          + `<br>rank correlation ${fixed(row.rank_correlation, 2)}<br>${counted(row.rows, "measurement")}`), hoverinfo: "text"}],
      height: heightOfRows(rows.length * 1.4, 80),
      layout: {showlegend: false, hovermode: "closest", yaxis: categoryAxis([...new Set(rows.map(row => row.label))]),
        xaxis: {title: "time on the second machine / on the first", type: "log", tickvals: [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100]}},
      note: both.map(each => `First ${each.first}, second ${each.second}: their rankings by CUES correlate with ${fixed(each.spearman, 3)} (Spearman).`).join(" ")
        + known.map(each => ` Rank correlation of the times of ${each.second}: ${each.times.map(time => `${time.stage} ${fixed(time.rank_correlation, 2)}`).join(", ")}.`).join(""),
    };
  },
};
