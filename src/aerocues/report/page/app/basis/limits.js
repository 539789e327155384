/* Limits beside the filter: combinations within two values of a measure, or the worst few by it. */

import {measureOf} from "./entries.js";
import {isKnown} from "./numbers.js";
import {state} from "./state.js";

/* Keys of the state. */
export const LIMITS = ["measure", "min", "max", "worst"];

/** @param {string} key */
function numberAt(key) {
  const text = state.get(key).trim();
  return text !== "" && Number.isFinite(Number(text)) ? Number(text) : null;
}

/** @param {Entry} entry */
export function limitedMeasure(entry) {
  return measureOf(entry, state.get("measure")) ?? measureOf(entry, "score");
}

export function hasLimits() {
  return ["min", "max", "worst"].some(key => numberAt(key) !== null);
}

/** Those of these combinations that are within the limits, in the same order.
 * @param {Entry} entry @param {number[]} rows */
export function withinLimits(entry, rows) {
  const measure = limitedMeasure(entry);
  if (!measure || !hasLimits()) return rows;
  const {values, better} = measure;
  const [least, most, worst] = ["min", "max", "worst"].map(numberAt);
  const kept = rows.filter(a => isKnown(values[a]) && Number(values[a]) >= (least ?? -Infinity) && Number(values[a]) <= (most ?? Infinity));
  if (worst === null) return kept;
  const sign = better === "lower" ? -1 : 1;
  const last = new Set([...kept].sort((a, b) => sign * (Number(values[a]) - Number(values[b]))).slice(0, Math.max(0, Math.round(worst))));
  return kept.filter(a => last.has(a));
}
