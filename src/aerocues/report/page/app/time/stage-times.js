/* Times of the stages, and axes and orders by them. */

import {mediansOf} from "../basis/entries.js";
import {duration, isKnown} from "../basis/numbers.js";
import {logAxis} from "../shell/axes.js";

/** @type {Stage[]} */
export const STAGES = ["detect", "describe", "match", "verify"];

/** @param {Entry} entry @returns {true | string} */
export function hasStages(entry) {
  return STAGES.some(stage => entry.medians[stage].some(isKnown))
    ? true : "Only total times are known, not the times of the stages.";
}

/** @param {Colours} colours @param {Stage} stage */
export function stageColour(colours, stage) {
  return {detect: colours.series[0], describe: colours.series[1], match: colours.series[2], verify: colours.series[5]}[stage];
}

/** @param {Entry} entry */
export function totalMedians(entry) {
  return entry.medians.total.some(isKnown) ? entry.medians.total : mediansOf(entry, "total_seconds");
}

/** @type {ControlSpec} */
export const ORDERS = {name: "order", label: "Show", fallback: () => "score", options: () => [
  {key: "score", label: "best by CUES"}, {key: "fast", label: "fastest"}, {key: "slow", label: "slowest"}]};

/** @param {FigureContext} context @param {string} order @param {Value[]} values */
export function inTimeOrder({shown: rows}, order, values) {
  const known = rows.filter(a => isKnown(values[a]));
  if (order === "score") return known;
  return known.sort((a, b) => (order === "fast" ? 1 : -1) * (Number(values[a]) - Number(values[b])));
}

/** Ticks of a logarithmic axis of seconds, as durations.
 * @param {string} scale @param {Value[]} values @param {string} [title] @returns {Axis} */
export function secondsAxis(scale, values, title = "time") {
  if (scale !== "log") return {title: `${title}, s`, rangemode: "tozero"};
  return {title, ...logAxis(values, duration)};
}
