/* Time for a thousand matches and for a thousand inliers. */

import {seriesStyle, SYMBOLS} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {meansOf, measureOf} from "../basis/entries.js";
import {duration, labelOf} from "../basis/numbers.js";
import {categoryAxis, heightOfRows, names} from "../shell/axes.js";
import {scaleControl, topControl} from "../shell/controls.js";
import {inTimeOrder, ORDERS, secondsAxis} from "./stage-times.js";

/** @type {FigureSpec} */
export const PER_THOUSAND = {
  id: "thousand", title: "Time per thousand",
  read: "The time per thousand matches and per thousand inliers. The gap between the dots is the cost of wrong "
    + "matches. Means over the pairs, as in the score.",
  controls: [ORDERS, topControl(), scaleControl("log")],
  available: entry => (perThousand(entry).length ? true : "Times per thousand were not measured."),
  draw(context) {
    const {entry, option, theme} = context;
    const columns = perThousand(entry);
    const key = meansOf(entry, columns[columns.length - 1]);
    const top = inTimeOrder(context, option("order"), key).slice(0, Number(option("top")));
    if (!top.length) return {empty: "None of these combinations has such a time."};
    const data = columns.map((column, i) => {
      const values = meansOf(entry, column);
      return {type: "scatter", mode: "markers", name: safe(labelOf(column).replace("seconds ", "")),
        x: top.map(a => values[a]), y: names(entry, top), marker: {color: seriesStyle(theme, i).color, size: 9, symbol: SYMBOLS[i]},
        hovertext: top.map(a => `<b>${safe(entry.combinations[a])}</b><br>${safe(labelOf(column))}: ${safe(duration(values[a]))}`),
        hoverinfo: "text"};
    });
    return {
      data, height: heightOfRows(top.length, 100),
      layout: {hovermode: "closest", yaxis: categoryAxis(names(entry, top)),
        xaxis: secondsAxis(option("scale"), data.flatMap(trace => trace.x), "time per thousand")},
    };
  },
};

/** @param {Entry} entry */
function perThousand(entry) {
  return ["seconds_per_1k_matches", "seconds_per_1k_inliers", "seconds_per_1k_excess_inliers", "seconds_per_1k_ref_matches"]
    .filter(name => measureOf(entry, name));
}
