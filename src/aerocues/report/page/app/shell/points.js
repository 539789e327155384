/* Scatter plots with one point per combination, coloured by method. */

import {seriesStyle} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {fixed, isKnown, percent, shown, valueText} from "../basis/numbers.js";
import {names} from "./axes.js";

/** Axes, margins and legend of a scatter plot. Fixed margins, because Plotly takes twice the time to find them.
 * @param {Axis} xaxis @param {Axis} yaxis @param {boolean} narrow */
export function scatterFrame(xaxis, yaxis, narrow) {
  return {
    xaxis: {...xaxis, automargin: false}, yaxis: {...yaxis, automargin: false}, hovermode: "closest",
    margin: narrow ? {l: 54, b: 44} : {l: 62, b: 48, r: 104},
    legend: narrow ? {} : {orientation: "v", x: 1.01, y: 1, yanchor: "top"},
  };
}

/** Means exclude failed pairs, so a combination that fails on the hard pairs looks good. It must therefore
 * reach a success rate close to that of the best.
 * @param {Entry} entry @param {number} a */
export function isSound(entry, a) {
  const {success_rate: success, best, settings} = entry.score;
  const [own, bestOne] = [success[a], success[best]];
  return !isKnown(bestOne) || (own ?? 0) >= settings.good * bestOne;
}

/** @param {Entry} entry @param {number[]} rows @param {string} code @param {Measure} x @param {Measure} y @param {Theme} theme @returns {Trace[]} */
export function pointsByMethod(entry, rows, code, x, y, theme) {
  const methods = entry[/** @type {Code} */ (code)];
  const groups = [...new Set(methods)];
  return groups.map((name, i) => {
    const members = rows.filter(a => methods[a] === name);
    const {color, symbol, outline} = seriesStyle(theme, i);
    return {
      type: "scatter", mode: "markers", name: safe(name), x: members.map(a => x.values[a]),
      y: members.map(a => y.values[a]), ids: names(entry, members), marker: {color, symbol: members.map(a => (isSound(entry, a) ? symbol : outline)), size: 8, opacity: 0.85},
      hovertext: members.map(a => pointText(entry, a, x, y)), hoverinfo: "text",
    };
  }).filter(trace => trace.x.length);
}

/** @param {Entry} entry @param {number} a @param {...Measure} measures */
function pointText(entry, a, ...measures) {
  const [name, ...lines] = tipLines(entry, a, ...measures).map(safe);
  return [`<b>${name}</b>`, ...lines].join("<br>");
}

/** What is told of a point: its name, its values, and how good it is.
 * @param {Entry} entry @param {number} a @param {...Measure} measures */
export function tipLines(entry, a, ...measures) {
  return [entry.combinations[a], ...measures.map(measure => `${measure.label}: ${valueText(measure.key, measure.values[a])}`),
    `CUES ${fixed(entry.score.score[a])}, rank ${shown(entry.score.rank[a])}, success ${percent(entry.score.success_rate[a])}`];
}
