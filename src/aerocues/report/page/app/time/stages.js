/* Stacked times of the stages; on a logarithmic scale, where stacks would mislead, dots. */

import {SYMBOLS} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {duration, isKnown} from "../basis/numbers.js";
import {categoryAxis, heightOfRows, names} from "../shell/axes.js";
import {scaleControl, topControl} from "../shell/controls.js";
import {hasStages, inTimeOrder, ORDERS, secondsAxis, stageColour, STAGES, totalMedians} from "./stage-times.js";

/** @type {FigureSpec} */
export const STAGES_FIGURE = {
  id: "stages", title: "Where the time goes", wide: true,
  read: "The bar is the time for one image and one pair, split by stage. On a logarithmic scale each stage has its own "
    + "dot, because stacked logarithms would mislead.",
  controls: [ORDERS, topControl(), scaleControl()],
  available: entry => (totalMedians(entry).some(isKnown) ? true : "Times were not measured."),
  draw(context) {
    const {entry, option, colours} = context;
    const totals = totalMedians(entry);
    const top = inTimeOrder(context, option("order"), totals).slice(0, Number(option("top")));
    if (!top.length) return {empty: "None of these combinations has a time."};
    const stages = STAGES.filter(stage => entry.medians[stage].some(isKnown));
    /** @type {[stage: string, values: Value[], color: string][]} */
    const series = stages.map(stage => [stage, entry.medians[stage], stageColour(colours, stage)]);
    if (!stages.length) series.push(["total", totals, colours.series[0]]);
    const logarithmic = option("scale") === "log";
    if (logarithmic && stages.length) series.push(["total", totals, colours.ink]);
    const data = series.map(([stage, values, color], i) => (logarithmic
      ? stageDots(entry, top, stage, values, color, i) : stageBars(entry, top, stage, values, color)));
    return {
      data, height: heightOfRows(top.length, 100),
      layout: {barmode: "stack", bargap: 0.3, hovermode: "closest", yaxis: categoryAxis(names(entry, top)),
        xaxis: secondsAxis(option("scale"), data.flatMap(trace => trace.x))},
      note: stages.length ? "The bars add medians, which can differ slightly from the median of the sums." : String(hasStages(entry)),
    };
  },
};

/** @param {Entry} entry @param {number[]} rows @param {string} stage @param {Value[]} values */
function stageText(entry, rows, stage, values) {
  return rows.map(a => `<b>${safe(entry.combinations[a])}</b><br>${stage}: ${safe(duration(values[a]))}`
    + `<br>total: ${safe(duration(totalMedians(entry)[a]))}`);
}

/** @param {Entry} entry @param {number[]} rows @param {string} stage @param {Value[]} values @param {string} color @returns {Trace} */
function stageBars(entry, rows, stage, values, color) {
  return {type: "bar", orientation: "h", name: stage, x: rows.map(a => values[a]), y: names(entry, rows),
    marker: {color}, hovertext: stageText(entry, rows, stage, values), hoverinfo: "text"};
}

/** @param {Entry} entry @param {number[]} rows @param {string} stage @param {Value[]} values @param {string} color @param {number} i @returns {Trace} */
function stageDots(entry, rows, stage, values, color, i) {
  return {type: "scatter", mode: "markers", name: stage, x: rows.map(a => (Number(values[a]) > 0 ? values[a] : null)),
    y: names(entry, rows), marker: {color, size: 8, symbol: [...SYMBOLS, "line-ns-open"][i], line: {width: stage === "total" ? 2 : 0, color}},
    hovertext: stageText(entry, rows, stage, values), hoverinfo: "text"};
}
