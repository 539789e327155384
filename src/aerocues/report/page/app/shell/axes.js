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

/* Digits of the ticks of a logarithmic axis, from coarse to fine. */
const DIGITS = [[1], [1, 3], [1, 2, 5], [1, 1.5, 2, 3, 4, 5, 7], Array.from({length: 90}, (_, i) => (10 + i) / 10),
  Array.from({length: 900}, (_, i) => (100 + i) / 100)];
const FEWEST_TICKS = 3;

/** 1, 10, 100, .. or, between values that are near each other, finer steps: as coarse as leaves three ticks between them.
 * @param {number} low @param {number} high */
export function logTicks(low, high) {
  /** @type {number[]} */
  const powers = [];
  for (let power = Math.floor(Math.log10(low)) - 1; power <= Math.ceil(Math.log10(high)); power += 1) powers.push(power);
  for (const digits of DIGITS) {
    const ticks = powers.flatMap(power => digits.map(digit => Number(`${digit}e${power}`))).filter(tick => low / 10 <= tick && tick <= high * 10);
    if (ticks.filter(tick => low <= tick && tick <= high).length >= FEWEST_TICKS) return ticks;
  }
  return [low];
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
