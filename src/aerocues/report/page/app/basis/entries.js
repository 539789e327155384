/* Entries: one dataset on one machine each. A number `a` is the position of a combination. */

import {counted, isKnown, labelOf, NONE} from "./numbers.js";
import {arrayOf, payload} from "./payload.js";
import {meanOf, medianOf} from "./statistics.js";

export const entries = payload.entries;
/** @type {Code[]} */
export const CODES = ["detector", "descriptor", "norm", "matcher"];
/** @type {WeakMap<Entry, Map<string, any>>} */
const remembered = new WeakMap();

/** The result of `compute`, computed once for each entry and key.
 * @template T
 * @param {Entry} entry @param {string} key @param {() => T} compute @returns {T} */
export function remember(entry, key, compute) {
  const known = remembered.get(entry) ?? new Map();
  remembered.set(entry, known);
  if (!known.has(key)) known.set(key, compute());
  return known.get(key);
}

/** @param {Entry} entry @param {string} name */
export function hasColumn(entry, name) {
  return Object.hasOwn(entry.columns, name);
}

/** Values of one combination over the pairs; NaN where unknown.
 * @param {Entry} entry @param {string} name @param {number} a */
export function pairValues(entry, name, a) {
  const count = entry.pairs.length;
  return arrayOf(entry.columns[name].values).subarray(a * count, (a + 1) * count);
}

/** The mean over pairs of each combination, from the score if it has the criterion.
 * @param {Entry} entry @param {string} name @returns {Value[]} */
export function meansOf(entry, name) {
  return remember(entry, `means ${name}`, () =>
    entry.score.means[name] ?? entry.combinations.map((_, a) => meanOf(pairValues(entry, name, a))));
}

/** The same with failed pairs as 0 if higher is better: in a comparison with the truth, a combination must
 * not gain by failing on the hard pairs.
 * @param {Entry} entry @param {string} name @returns {Value[]} */
export function meansWithFailures(entry, name) {
  return remember(entry, `means with failures ${name}`, () => {
    if (entry.columns[name].better !== "higher") return meansOf(entry, name);
    const [status, count] = [arrayOf(entry.status), entry.pairs.length];
    const [good, unknown] = ["ok", "not measured"].map(each => entry.statuses.indexOf(each));
    return entry.combinations.map((_, a) => meanOf(pairValues(entry, name, a).map((value, pair) => {
      const outcome = status[a * count + pair];
      return outcome === unknown || (outcome === good && !Number.isFinite(value)) ? NaN : (outcome === good ? value : 0);
    })));
  });
}

/** @param {Entry} entry @param {string} name */
export function mediansOf(entry, name) {
  return remember(entry, `medians ${name}`, () =>
    entry.combinations.map((_, a) => medianOf(pairValues(entry, name, a))));
}

/** Positions of all combinations by rank; those without a rank come last.
 * @param {Entry} entry */
export function ranked(entry) {
  return remember(entry, "ranked", () => {
    const rank = (/** @type {number} */ a) => entry.score.rank[a] ?? Infinity;
    return entry.combinations.map((_, a) => a).sort((a, b) => (rank(a) - rank(b)) || (a - b));
  });
}

/** @param {Entry} entry @param {number} a */
export function isBinary(entry, a) {
  return entry.norm[a].toUpperCase().startsWith("HAM");
}

/** @param {Entry} entry @param {string} name */
function criterionOf(entry, name) {
  return entry.score.criteria.find(each => each.name === name);
}

/** @param {Entry} entry @param {string} name */
export function definitionOf(entry, name) {
  const listed = payload.method.columns.find(each => each.name === name);
  return entry.columns[name]?.definition || criterionOf(entry, name)?.description
    || listed?.definition || "";
}

/** Quantities for an axis: one value per combination.
 * @param {Entry} entry */
export function measuresOf(entry) {
  return remember(entry, "measures", () => {
    const score = entry.score;
    /** @type {Measure[]} */
    const measures = [
      {key: "score", label: "CUES", better: "higher", values: score.score},
      {key: "success_rate", label: "success rate", better: "higher", values: score.success_rate},
    ];
    const names = [...score.criteria.map(each => each.name), ...Object.keys(entry.columns)];
    for (const name of new Set(names)) {
      const better = criterionOf(entry, name)?.better ?? entry.columns[name]?.better ?? null;
      measures.push({
        key: name, label: labelOf(name), better,
        get values() { return meansOf(entry, name); },
      });
    }
    return measures.filter(measure => measure.values.some(value => value !== null));
  });
}

/** @param {Entry} entry @param {string} key */
export function measureOf(entry, key) {
  return measuresOf(entry).find(measure => measure.key === key) ?? null;
}

/** The measure that a control offered.
 * @param {Entry} entry @param {string} key */
export function measureNamed(entry, key) {
  const found = measureOf(entry, key);
  if (!found) throw new Error(`${entry.name} has no measure ${key}`);
  return found;
}

/** The first of these columns that the entry has.
 * @param {Entry} entry @param {string[]} names */
export function firstColumn(entry, names) {
  return names.find(name => hasColumn(entry, name)) ?? null;
}

/** @param {Entry} entry @param {number} position */
export function pairLabel(entry, position) {
  const {sequence, image_1: first, image_2: second} = entry.pairs[position];
  const leaf = (/** @type {string} */ name) => name.split("/").pop();
  const several = remember(entry, "several sequences", () => new Set(entry.pairs.map(pair => pair.sequence)).size > 1);
  return `${sequence && several ? `${sequence}: ` : ""}${leaf(first)} – ${leaf(second)}`;
}

/** @param {Entry} entry */
export function pairCount(entry) {
  return counted(entry.pairs.length, "pair");
}

/** @param {Score} score @param {number} a */
export function rankText(score, a) {
  if (!isKnown(score.rank[a])) return NONE;
  const [low, high] = [score.rank_low[a], score.rank_high[a]];
  return isKnown(low) && low !== high ? `${score.rank[a]} (${low} to ${high})` : String(score.rank[a]);
}

/** @param {Entry} entry @param {number[]} positions */
export function withRank(entry, positions) {
  return positions.filter(a => isKnown(entry.score.rank[a]));
}
