/* The best combinations with their intervals. */

import {safe} from "../basis/elements.js";
import {isBinary, rankText, withRank} from "../basis/entries.js";
import {fixed, isKnown, percent, shown} from "../basis/numbers.js";
import {categoryAxis, names} from "../shell/axes.js";
import {topControl} from "../shell/controls.js";

const NORMS = [{norm: "L2", binary: false, series: 0, filled: "circle"}, {norm: "Hamming", binary: true, series: 1, filled: "diamond"}];
/** The symbol of each standing, from that of its norm.
 * @type {Record<string, (filled: string) => string>} */
const STANDINGS = {"not significantly different": filled => filled, "significantly worse": filled => `${filled}-open`,
  "not compared": () => "x-thin-open"};

/** How a combination compares with the best.
 * @param {Entry} entry @param {number} a */
function standingOf({score}, a) {
  if (a === score.best || score.indistinguishable.includes(a)) return "not significantly different";
  return isKnown(score.p_value[a]) ? "significantly worse" : "not compared";
}

/** @type {FigureSpec} */
export const SCORE_DOTS = {
  id: "dots", title: "The best, with intervals", tall: true,
  read: "The dot is the score, the bar its 95 % interval over the pairs. Filled: not significantly different from the best; "
    + "hollow: significantly worse; cross: not compared, because it shares too few pairs with the best. Intervals can overlap although the difference is significant, because all combinations share the pairs.",
  controls: [topControl()],
  draw({entry, shown: rows, colours, option}) {
    const scored = withRank(entry, rows);
    if (!scored.length) return {empty: "None of these combinations has a score."};
    const top = scored.slice(0, Number(option("top")));
    const groups = NORMS.flatMap(({norm, binary, series, filled}) => Object.entries(STANDINGS).map(([standing, mark]) => {
      const members = top.filter(a => isBinary(entry, a) === binary && standingOf(entry, a) === standing);
      return dotsTrace(entry, members, `${norm}, ${standing}`, colours.series[series], mark(filled));
    }));
    const data = groups.filter(trace => trace.y.length);
    return {
      data, height: top.length * 30 + 110,
      layout: {xaxis: {title: "CUES"}, yaxis: categoryAxis(names(entry, top)), hovermode: "closest"},
      summary: `Best: ${entry.combinations[top[0]]}, ${fixed(entry.score.score[top[0]])}`,
    };
  },
};

/** @param {Entry} entry @param {number[]} rows @param {string} name @param {string} color @param {string} symbol */
function dotsTrace(entry, rows, name, color, symbol) {
  const score = entry.score;
  /** @type {(from: Value[], to: Value[]) => number[]} */
  const reach = (from, to) => rows.map(a => Number(to[a] ?? NaN) - Number(from[a] ?? NaN) || 0);
  return {
    type: "scatter", mode: "markers", name, x: rows.map(a => score.score[a]), y: names(entry, rows),
    marker: {color, symbol, size: 9, line: {width: 2, color}},
    error_x: {type: "data", symmetric: false, array: reach(score.score, score.score_high),
      arrayminus: reach(score.score_low, score.score), color, thickness: 1.5, width: 3},
    hovertext: rows.map(a => `<b>${safe(entry.combinations[a])}</b><br>CUES ${fixed(score.score[a])} `
      + `(${fixed(score.score_low[a])} to ${fixed(score.score_high[a])})<br>rank ${safe(rankText(score, a))}`
      + `<br>first in ${safe(percent(score.probability_best[a]))} of resamples`
      + `${isKnown(score.p_value[a]) ? `<br>p = ${shown(score.p_value[a], 2)}` : ""}`),
    hoverinfo: "text",
  };
}
