/* Scales of drawings: values as pixels, linear or logarithmic, with ticks that fit. */

import {isKnown, shown} from "../basis/numbers.js";
import {boundsOf, spanOf} from "../basis/statistics.js";
import {logTicks} from "./axes.js";

const ROOM = 0.07;
const FEWEST_DECADES = 10;

/** The values of an axis with room at both ends; logarithmic where `couldBeLog` values span more than a factor of 10.
 * @param {Value[]} values @param {boolean} couldBeLog @returns {AxisRange} */
export function rangeOf(values, couldBeLog) {
  const known = values.filter(isKnown);
  const [least, most] = boundsOf(known);
  const isLog = couldBeLog && least > 0 && most / least >= FEWEST_DECADES;
  const [low, high] = spanOf(isLog ? [Math.log10(least), Math.log10(most)] : known);
  const room = ROOM * (high - low);
  return {isLog, low: low - room, high: high + room};
}

/** @param {AxisRange} range @param {Span} pixels @param {number} step in pixels, least between two ticks
 * @param {(value: number) => string} [words] @returns {Scale} */
export function scaleOf({isLog, low, high}, [from, to], step, words = shown) {
  const spread = isLog ? Math.log10 : Number;
  const at = (/** @type {number} */ value) => from + (spread(value) - low) / (high - low) * (to - from);
  const inverse = (/** @type {number} */ pixel) => low + (pixel - from) / (to - from) * (high - low);
  const wanted = isLog ? logTicks(10 ** low, 10 ** high) : linearTicks(low, high, Math.abs(to - from) / step);
  const within = wanted.filter(tick => spread(tick) >= low && spread(tick) <= high);
  return {at, inverse, ticks: apart(within.map(tick => ({at: at(tick), text: words(tick)})), step)};
}

/** Round values: at most about so many, in steps of 1, 2 or 5 of a power of 10.
 * @param {number} low @param {number} high @param {number} most */
function linearTicks(low, high, most) {
  const least = (high - low) / Math.max(2, most);
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * ([1, 2, 5].find(factor => factor * power >= least) ?? 10);
  const first = Math.ceil(low / step);
  return Array.from({length: Math.floor(high / step) - first + 1}, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** Without ticks that are too near to the one before.
 * @param {Tick[]} ticks @param {number} step */
function apart(ticks, step) {
  /** @type {Tick[]} */
  const kept = [];
  for (const tick of ticks) {
    if (!kept.length || Math.abs(tick.at - kept[kept.length - 1].at) >= step) kept.push(tick);
  }
  return kept;
}
