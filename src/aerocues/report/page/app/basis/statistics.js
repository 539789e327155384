/* Means, bounds and ranks of numbers. */

import {isKnown} from "./numbers.js";

/** The values at these positions as numbers; NaN where unknown.
 * @param {Value[]} values @param {number[]} positions */
export function valuesAt(values, positions) {
  return positions.map(position => values[position] ?? NaN);
}

/** @param {Iterable<Value>} values */
export function meanOf(values) {
  let sum = 0;
  let count = 0;
  for (const value of values) if (value !== null && Number.isFinite(value)) { sum += value; count += 1; }
  return count ? sum / count : null;
}

/** @param {Iterable<Value>} values */
export function medianOf(values) {
  const known = Array.from(values).filter(isKnown).sort((a, b) => a - b);
  if (!known.length) return null;
  const middle = known.length >> 1;
  return known.length % 2 ? known[middle] : (known[middle - 1] + known[middle]) / 2;
}

/** @param {Iterable<number>} values @returns {Span} */
export function boundsOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

/** Bounds that are never the same.
 * @param {Iterable<number>} values @returns {Span} */
export function spanOf(values) {
  const [low, high] = boundsOf(values);
  return high > low ? [low, high] : [low - 0.5, high + 0.5];
}

/** @param {number[]} values @returns {number[]} */
function ranksOf(values) {
  const order = values.map((_, i) => i).sort((a, b) => values[a] - values[b]);
  const ranks = new Array(values.length);
  for (let i = 0; i < order.length;) {
    let j = i;
    while (j + 1 < order.length && values[order[j + 1]] === values[order[i]]) j += 1;
    for (let k = i; k <= j; k += 1) ranks[order[k]] = (i + j) / 2;
    i = j + 1;
  }
  return ranks;
}

/** Spearman's rank correlation; null where it is not defined.
 * @param {number[]} x @param {number[]} y */
export function spearman(x, y) {
  if (x.length < 3) return null;
  const [a, b] = [ranksOf(x), ranksOf(y)];
  const middle = (x.length - 1) / 2;
  let [ab, aa, bb] = [0, 0, 0];
  for (let i = 0; i < a.length; i += 1) {
    ab += (a[i] - middle) * (b[i] - middle);
    aa += (a[i] - middle) ** 2;
    bb += (b[i] - middle) ** 2;
  }
  return aa && bb ? ab / Math.sqrt(aa * bb) : null;
}

/** @param {ArrayLike<number>} sorted @param {number} share */
export function quantile(sorted, share) {
  return sorted[Math.min(sorted.length - 1, Math.max(0, Math.round(share * (sorted.length - 1))))];
}

/** @param {number} value @param {number} low @param {number} high */
export function clamped(value, low, high) {
  return Math.min(high, Math.max(low, value));
}
