/* Times by detector and descriptor, and brute force against FLANN. */

import {seriesStyle} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {measureNamed, measureOf} from "../basis/entries.js";
import {duration, isKnown, labelOf, shown} from "../basis/numbers.js";
import {boundsOf, medianOf, valuesAt} from "../basis/statistics.js";
import {categoryAxis, names} from "../shell/axes.js";
import {scaleControl} from "../shell/controls.js";
import {hasStages, secondsAxis, totalMedians} from "./stage-times.js";

/** @type {FigureSpec} */
export const BY_METHOD = {
  id: "bymethod", title: "By detector and by descriptor",
  read: "Each dot is a combination that matches the filter; the line in the box is the median. Detection depends on the detector "
    + "only; description also depends on the number of keypoints.",
  controls: [
    {name: "of", label: "Time of", fallback: () => "detect", options: entry => [
      ...(hasStages(entry) === true ? [{key: "detect", label: "detection, by detector"}, {key: "describe", label: "description, by descriptor"},
        {key: "match", label: "matching, by descriptor"}] : []),
      {key: "total:detector", label: "total, by detector"}, {key: "total:descriptor", label: "total, by descriptor"}]},
    scaleControl("log"),
  ],
  draw(context) {
    const {entry, option, shown: rows, colours} = context;
    const [stage, by] = /** @type {[Stage | "total", Code | undefined]} */ (option("of").split(":"));
    const methods = entry[by ?? (stage === "detect" ? "detector" : "descriptor")];
    const values = stage === "total" ? totalMedians(entry) : entry.medians[stage];
    const drawn = rows.filter(a => isKnown(values[a]) && (option("scale") === "linear" || values[a] > 0));
    if (!drawn.length) return {empty: "None of these combinations has such a time."};
    const groups = [...new Set(drawn.map(a => methods[a]))]
      .map(name => ({name, median: Number(medianOf(valuesAt(values, drawn.filter(a => methods[a] === name))))}))
      .sort((a, b) => a.median - b.median).map(({name}) => safe(name));
    return {
      data: [{type: "box", orientation: "h", name: stage, x: drawn.map(a => values[a]), y: drawn.map(a => safe(methods[a])),
        text: names(entry, drawn), boxpoints: "all", jitter: 0.5, pointpos: 0, marker: {color: colours.series[0], size: 4, opacity: 0.6},
        line: {color: colours.series[0], width: 1}, fillcolor: `${colours.series[0]}22`, hoveron: "points",
        hovertemplate: "%{text}<br>%{x:.3g} s<extra></extra>"}],
      height: groups.length * 30 + 70,
      layout: {showlegend: false, hovermode: "closest", yaxis: categoryAxis(groups),
        xaxis: secondsAxis(option("scale"), drawn.map(a => values[a]))},
    };
  },
};

/** @type {FigureSpec} */
export const MATCHERS = {
  id: "matchers", title: "Brute force against FLANN",
  read: "Each point is a detector, descriptor and norm: horizontal with brute force, vertical with FLANN. Below the line FLANN "
    + "has the lower value.",
  controls: [{name: "of", label: "Value", fallback: entry => (hasStages(entry) === true ? "match" : "total"), options: entry => [
    ...(hasStages(entry) === true ? [{key: "match", label: "matching time"}] : []), {key: "total", label: "total time"},
    {key: "score", label: "CUES"}, ...["precision", "inliers", "gt_precision@3"].filter(name => measureOf(entry, name))
      .map(name => ({key: name, label: labelOf(name)}))]}],
  available: entry => (entry.matcher.includes("BF") && entry.matcher.includes("FLANN")
    ? true : "Only one of the two matchers was measured."),
  draw({entry, option, shown: rows, theme, colours}) {
    const of = option("of");
    const time = of === "match" || of === "total";
    const values = of === "total" ? totalMedians(entry) : of === "match" ? entry.medians.match : measureNamed(entry, of).values;
    const fits = (/** @type {Value} */ value) => isKnown(value) && (!time || value > 0);
    const pairs = matcherPairs(entry, rows).filter(([a, b]) => fits(values[a]) && fits(values[b]));
    if (!pairs.length) return {empty: "No combination matches the filter with both matchers."};
    const [low, high] = boundsOf(valuesAt(values, pairs.flat()));
    const line = {type: "scatter", mode: "lines", name: "not in the table", showlegend: false, hoverinfo: "skip",
      x: [low, high], y: [low, high], line: {color: colours.line, width: 1, dash: "dot"}};
    const data = [...new Set(entry.norm)].map((norm, i) => matcherTrace(entry, norm, pairs, values, time, seriesStyle(theme, i).color));
    const axis = (/** @type {string} */ title) => ({...(time ? secondsAxis("log", [low, high], "") : {}), title});
    const lower = pairs.filter(([a, b]) => Number(values[b]) < Number(values[a])).length;
    return {
      data: [line, ...data.filter(trace => trace.x.length)], height: 440,
      layout: {xaxis: axis("brute force"), yaxis: axis("FLANN"), hovermode: "closest"},
      note: time ? `FLANN is faster in ${lower} of ${pairs.length} cases.` : `FLANN has the lower value in ${lower} of ${pairs.length} cases.`,
    };
  },
};

/** Combinations with brute force, and the same with FLANN.
 * @param {Entry} entry @param {number[]} rows @returns {[number, number][]} */
function matcherPairs(entry, rows) {
  const key = (/** @type {number} */ a) => JSON.stringify([entry.detector[a], entry.descriptor[a], entry.norm[a]]);
  const withFlann = new Map(rows.filter(a => entry.matcher[a] === "FLANN").map(a => [key(a), a]));
  return rows.filter(a => entry.matcher[a] === "BF").flatMap(a => {
    const b = withFlann.get(key(a));
    return b === undefined ? [] : [/** @type {[number, number]} */ ([a, b])];
  });
}

/** @param {Entry} entry @param {string} norm @param {[number, number][]} pairs @param {Value[]} values @param {boolean} time @param {string} color */
function matcherTrace(entry, norm, pairs, values, time, color) {
  const own = pairs.filter(([a]) => entry.norm[a] === norm);
  const text = (/** @type {Value} */ value) => safe(time ? duration(value) : shown(value));
  const name = (/** @type {number} */ a) => safe([entry.detector[a], entry.descriptor[a], norm].join("-"));
  return {type: "scatter", mode: "markers", name: safe(norm), x: own.map(([a]) => values[a]), y: own.map(([, b]) => values[b]),
    ids: own.map(([a]) => name(a)), marker: {color, symbol: norm === "L2" ? "circle" : "diamond", size: 8, opacity: 0.8}, hoverinfo: "text",
    hovertext: own.map(([a, b]) => `<b>${name(a)}</b><br>brute force: ${text(values[a])}<br>FLANN: ${text(values[b])}`)};
}
