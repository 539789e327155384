/* The table of all combinations that match the filter, with their scores. */

import {rankingColumns} from "./ranking-columns.js";
import {measureOf} from "../basis/entries.js";
import {shownIn} from "../basis/filter.js";
import {isKnown} from "../basis/numbers.js";
import {spanOf} from "../basis/statistics.js";

/** @type {ColumnTableSpec} */
export const RANKING = {
  id: "ranking", title: "All combinations", prefix: "", natural: "rank",
  columns: rankingColumns, rows: shownIn,
  read(entry) {
    const tested = entry.score.p_value.some(isKnown);
    return "Click a heading to sort. The bar beside CUES is its 95\u00a0% interval, on one scale for all rows shown"
      + `${tested ? ". A dot marks the best and those that are not significantly different" : ""}. Other columns are means over the successful pairs.`;
  },
  downFirst: (entry, {key}) => measureOf(entry, key)?.better === "higher" || ["probability_best", "probability_top",
    "score_low", "score_high", "p_value", "repeats"].includes(key),
  isMarked: (entry, a) => a === entry.score.best || entry.score.indistinguishable.includes(a),
  span: (entry, drawn) => scoreSpan(entry.score, drawn),
};

/** From the lowest to the highest end of the intervals that are shown.
 * @param {Score} score @param {number[]} rows @returns {Span} */
function scoreSpan(score, rows) {
  const ends = rows.flatMap(a => [score.score_low[a], score.score[a], score.score_high[a]]).filter(isKnown);
  return ends.length ? spanOf(ends) : [0, 1];
}
