/* Candidates for the answer: combinations, some of which only models were built with. */

import {hasColumn, measureOf, meansOf, meansWithFailures, remember} from "../basis/entries.js";
import {currentFilter, shownIn} from "../basis/filter.js";
import {isKnown} from "../basis/numbers.js";

/** The position of a combination by its name; null where no pairs were measured with it.
 * @param {Entry} entry @param {string} name */
export function positionOf(entry, name) {
  const places = remember(entry, "positions", () => new Map(entry.combinations.map((each, a) => [each, a])));
  return places.get(name) ?? null;
}

/** The same, or else that of the same features with another matcher: their pairs tell nearly as much.
 * @param {Entry} entry @param {string} name */
export function measuredAs(entry, name) {
  const own = positionOf(entry, name);
  if (own !== null) return own;
  const features = `${name.split("-").slice(0, 3).join("-")}-`;
  return shownIn(entry).find(a => entry.combinations[a].startsWith(features)) ?? null;
}

/** @param {Entry} entry @param {string} name @param {number} value @param {string} text @returns {Candidate} */
export function candidate(entry, name, value, text) {
  const m = entry.models?.combinations.indexOf(name) ?? -1;
  return {name, value, text, a: positionOf(entry, name), m: m < 0 ? null : m};
}

/** Combinations by a value, the best first; those without one are left out.
 * @param {Entry} entry @param {number[]} rows @param {(a: number) => Value} value @param {(a: number) => string} text */
export function byValue(entry, rows, value, text) {
  return rows.filter(a => isKnown(value(a))).sort((a, b) => Number(value(b)) - Number(value(a)))
    .map(a => candidate(entry, entry.combinations[a], Number(value(a)), text(a)));
}

/** Names that pass the filter.
 * @param {string[]} names */
export function passingNames(names) {
  const passes = currentFilter();
  return names.filter(name => passes(name.split("-")));
}

/** Combinations that are nearly as good as the best of these, by score and success.
 * @param {Entry} entry @param {number[]} rows */
export function goodOnes({score}, rows) {
  const scored = rows.filter(a => isKnown(score.score[a]));
  if (!scored.length) return [];
  const best = scored.reduce((a, b) => (Number(score.score[b]) > Number(score.score[a]) ? b : a));
  /** @type {(values: Value[], a: number) => boolean} */
  const reaches = (values, a) => Number(values[a]) >= score.settings.good * Number(values[best]);
  return scored.filter(a => reaches(score.score, a) && reaches(score.success_rate, a));
}

/** The first of these measures that an entry has; failed pairs count as 0.
 * @param {Entry} entry @param {string[]} names @returns {Measure | null} */
export function firstOf(entry, names) {
  const key = names.find(name => measureOf(entry, name));
  const measure = key ? measureOf(entry, key) : null;
  if (!measure) return null;
  return {...measure, values: hasColumn(entry, measure.key) ? meansWithFailures(entry, measure.key) : meansOf(entry, measure.key)};
}

/* What is right comes first by the truth, then by the reference, then by the inliers. */
export const SHARES_RIGHT = ["gt_precision@3", "ref_precision@3", "precision_beyond_chance", "precision", "f1_score"];
export const RIGHT_MATCHES = ["ref_matches@3", "excess_inliers", "inliers", "matches"];

