/* What the best combination is to be best for. */

import {definitionOf} from "../basis/entries.js";
import {shownIn} from "../basis/filter.js";
import {counted, duration, fixed, isKnown, percent, shown, valueText} from "../basis/numbers.js";
import {currentEntry, state} from "../basis/state.js";
import {byValue, candidate, firstOf, goodOnes, passingNames, RIGHT_MATCHES, SHARES_RIGHT} from "./candidates.js";
import {rankByWeights} from "./own-weights.js";

/** @param {Entry} entry @returns {RaceAnswer | null} */
export function raceOf({race}) {
  return race && !race.unfinished ? race : null;
}

/** @type {Purpose[]} */
const PURPOSES = [
  {key: "race", label: "Recommended", available: entry => raceOf(entry) !== null, rank: rankByRace,
    meaning: entry => `what the race and its models recommend for ${raceOf(entry)?.title}`},
  {key: "overall", label: "Overall", rank: (entry, rows) => byValue(entry, rows, a => entry.score.score[a], a => fixed(entry.score.score[a])),
    meaning: () => "quality and speed by CUES (0: worst in all criteria, 1: best in all)"},
  {key: "model", label: "Best 3D model", rank: rankByModels,
    meaning: entry => (modelsThatWorked(entry).length ? "by the models that were built: success, then images in place, points and error"
      : "no model was built: by what leads to good ones, right matches that cover the images and link all of them")},
  {key: "accuracy", label: "Most accurate", rank: rankByAccuracy,
    meaning: entry => `${definitionOf(entry, firstOf(entry, SHARES_RIGHT)?.key ?? "") || "share of right matches"}; failed pairs count as 0`},
  {key: "speed", label: "Fastest", available: entry => entry.medians.total.some(isKnown),
    rank: (entry, rows) => byValue(entry, goodOnes(entry, rows), a => reciprocal(entry.medians.total[a]), a => duration(entry.medians.total[a])),
    meaning: entry => `the fastest with at least ${percent(entry.score.settings.good)} of the best score and success rate`},
  {key: "memory", label: "Smallest memory", available: entry => entry.megabytes.some(isKnown),
    rank: (entry, rows) => byValue(entry, goodOnes(entry, rows), a => reciprocal(entry.megabytes[a]), a => `${shown(entry.megabytes[a], 2)} MB`),
    meaning: entry => `the smallest descriptors of an image, with at least ${percent(entry.score.settings.good)} of the best score and success rate`},
  {key: "own", label: "Own weights", rank: rankByWeights, meaning: () => "the weights below, times the share of pairs that succeeded"},
];

/** @param {Value} value */
function reciprocal(value) {
  return value ? 1 / value : null;
}

/** @param {Entry} entry */
export function purposesOf(entry) {
  return PURPOSES.filter(purpose => purpose.available?.(entry) ?? true);
}

export function currentPurpose() {
  const known = purposesOf(currentEntry());
  return known.find(purpose => purpose.key === state.get("decide.purpose")) ?? known[0];
}

/** Those that match the filter, the best for the current purpose first.
 * @returns {Candidate[]} */
export function rankedForPurpose() {
  const entry = currentEntry();
  return currentPurpose().rank(entry, shownIn(entry));
}

/** What is best for the purposes that a score may hide, where it is another combination.
 * @param {Entry} entry @param {string} taken */
export function bestForOthers(entry, taken) {
  const winners = purposesOf(entry).filter(({key}) => ["model", "accuracy", "speed"].includes(key))
    .map(({label, rank}) => ({label, best: rank(entry, shownIn(entry))[0]?.name}));
  const others = winners.filter(({best}) => best && best !== taken);
  return others.length ? `${others.map(({label, best}) => `${label}: ${best === entry.models?.baseline ? "COLMAP’s default" : best}`).join("; ")}.` : "";
}

/** Models first, as the final judged them, then the leaders of the race.
 * @param {Entry} entry */
function rankByRace(entry) {
  const race = raceOf(entry);
  if (!race) return [];
  const built = race.final?.models ?? [];
  const scores = new Map(race.ranked.map(row => [row.combination, row]));
  const names = [...new Set([race.best, ...built, ...race.ranked.map(row => row.combination)])];
  const top = race.ranked[0]?.score || 1;
  return passingNames(names).map((name, place) => {
    const row = scores.get(name);
    const text = built.includes(name) ? modelText(entry, name) : `${fixed(row?.score ?? null)}, ${percent(row?.probability ?? null)} likely`;
    return candidate(entry, name, built.includes(name) ? 1 - 0.02 * place : Number(row?.score ?? 0) / top * 0.9, text);
  });
}

/** @param {Entry} entry */
function modelsThatWorked(entry) {
  return entry.models ? passingNames(entry.models.combinations.filter((_, m) => entry.models?.status[m] === "ok")) : [];
}

/** @param {Entry} entry @param {string} name */
function modelText({models}, name) {
  const m = models?.combinations.indexOf(name) ?? -1;
  if (!models || m < 0) return "model";
  const points = models.values.points_3d?.[m] ?? null;
  return `${shown(models.values.registered_images?.[m] ?? null)} images, ${isKnown(points) ? counted(points, "point") : "no points"}`;
}

/** @param {Entry} entry @param {number[]} rows */
function rankByModels(entry, rows) {
  const built = modelsThatWorked(entry);
  if (built.length) {
    const {models} = entry;
    const quality = (/** @type {string} */ name) => Number(models?.values.model_quality?.[models.combinations.indexOf(name)] ?? 0);
    return built.map(name => candidate(entry, name, quality(name), modelText(entry, name)));
  }
  const links = entry.preset_scores.models;
  if (links) return byValue(entry, rows, a => links[a], a => fixed(links[a]));
  const counts = firstOf(entry, RIGHT_MATCHES);
  return counts ? byValue(entry, rows, a => counts.values[a], a => `${shown(counts.values[a])} a pair`) : [];
}

/** @param {Entry} entry @param {number[]} rows */
function rankByAccuracy(entry, rows) {
  const measure = firstOf(entry, SHARES_RIGHT);
  return measure ? byValue(entry, rows, a => measure.values[a], a => valueText(measure.key, measure.values[a])) : [];
}
