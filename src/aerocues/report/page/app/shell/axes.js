/* Axes of figures. */

import {safe} from "../basis/elements.js";
import {isKnown, labelOf, shown} from "../basis/numbers.js";
import {boundsOf} from "../basis/statistics.js";

const PIXELS_A_ROW = 20;

/** Height of a figure with one row of text per combination.
 * @param {number} count @param {number} [extra] */
export function heightOfRows(count, extra = 70) {
  return Math.max(count, 2) * PIXELS_A_ROW + extra;
}

/** @param {string[]} names @param {Axis} [extra] @returns {Axis} */
export function categoryAxis(names, extra = {}) {
  return {type: "category", categoryorder: "array", categoryarray: names, autorange: "reversed",
    ticks: "", showgrid: false, tickfont: {size: 11}, ...extra};
}

/** @param {Entry} entry @param {number[]} positions */
export function names(entry, positions) {
  return positions.map(a => safe(entry.combinations[a]));
}

/** 1, 2, 5, 10, .. or, over many powers, 1, 10, 100, .. between two values.
 * @param {number} low @param {number} high */
function logTicks(low, high) {
  const [from, to] = [Math.log10(low), Math.log10(high)];
  const steps = to - from > 2.2 ? [1] : (to - from > 1.2 ? [1, 3] : [1, 2, 5]);
  const ticks = [];
  for (let power = Math.floor(from) - 1; power <= Math.ceil(to); power += 1) {
    for (const step of steps) ticks.push(Number(`${step}e${power}`));
  }
  return ticks;
}

/** A logarithmic axis for these values, with formatted ticks.
 * @param {(Value | undefined)[]} values @param {(value: number) => string} [words] @returns {Axis} */
export function logAxis(values, words = shown) {
  const known = values.filter(isKnown).filter(value => value > 0);
  const ticks = known.length ? logTicks(...boundsOf(known)) : [1];
  return {type: "log", tickvals: ticks, ticktext: ticks.map(value => safe(words(value)))};
}

/** @param {Entry} entry @param {string} column */
export function axisLabel(entry, column) {
  const unit = entry.columns[column]?.unit;
  const needed = unit && !["count", "ratio", ""].includes(unit) && !labelOf(column).includes(unit);
  return safe(needed ? `${labelOf(column)}, ${unit}` : labelOf(column));
}
