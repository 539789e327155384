/* Why the answer is the answer: figures, how sure it is, and where it is weak. */

import {firstColumn, pairLabel, pairValues} from "../basis/entries.js";
import {isFiltered, shownIn} from "../basis/filter.js";
import {counted, duration, fixed, isKnown, labelOf, percent, sentenceCase, shown, valueText} from "../basis/numbers.js";
import {measuredAs, firstOf, RIGHT_MATCHES, SHARES_RIGHT} from "./candidates.js";
import {raceOf} from "./purposes.js";

/* Of a model, where the purpose is another one. */
const FEW = 2;

/** @param {Entry} entry @param {Candidate} chosen @param {Purpose} purpose @returns {([string, Content] | null)[]} */
export function reasons(entry, chosen, {key}) {
  const a = measuredAs(entry, chosen.name);
  const modelled = reasonsOfModel(entry, chosen.m);
  return [...(key === "model" || key === "race" ? modelled : modelled.slice(0, FEW)), ...(a === null ? [] : reasonsOfPairs(entry, a)), wholeFlight(entry, a)];
}

/** @param {Entry} entry @param {number | null} m @returns {([string, Content] | null)[]} */
function reasonsOfModel({models}, m) {
  if (!models || m === null) return [];
  const of = (/** @type {string} */ name) => models.values[name]?.[m] ?? null;
  const error = of("reprojection_error");
  return [
    ["Images in the model", `${shown(of("registered_images"))} of ${shown(of("images"))}`],
    ["3D points", `${shown(of("points_3d"))}, seen by ${shown(of("mean_track_length"), 2)} images`],
    isKnown(error) ? ["Reprojection error", `${fixed(error, 2)} px`] : null,
    isKnown(of("position_rmse")) ? ["Cameras off by", `${shown(of("position_rmse"), 2)} m`] : null,
    isKnown(of("reconstruction_seconds")) ? ["Time of the model", `${duration(of("reconstruction_seconds"))} of CPU`] : null,
  ];
}

/** @param {Entry} entry @param {number} a @returns {([string, Content] | null)[]} */
function reasonsOfPairs(entry, a) {
  const [right, count] = [firstOf(entry, SHARES_RIGHT), firstOf(entry, RIGHT_MATCHES)];
  const {score, medians, megabytes} = entry;
  const measured = Number(score.repeats[a] ?? 0);
  return [
    ["Pairs matched", `${percent(score.success_rate[a])} of ${measured}${measured < entry.pairs.length ? ` (${entry.pairs.length} in all)` : ""}`],
    right ? [sentenceCase(right.label), valueText(right.key, right.values[a])] : null,
    count ? [`${sentenceCase(count.label)} a pair`, shown(count.values[a])] : null,
    isKnown(medians.total[a]) ? ["Time per image and pair", duration(medians.total[a])] : null,
    isKnown(megabytes[a]) ? ["Descriptors of an image", `${shown(megabytes[a], 2)} MB`] : null,
  ];
}

/** What all images and pairs take with it, where the stages were measured.
 * @param {Entry} entry @param {number | null} a @returns {[string, Content] | null} */
function wholeFlight(entry, a) {
  if (a === null) return null;
  const {detect, describe, match, verify} = entry.medians;
  if (![detect, describe, match].every(stage => isKnown(stage[a]))) return null;
  const {whose, images, pairs, about} = extentOf(entry);
  const seconds = images * (Number(detect[a]) + Number(describe[a])) + pairs * (Number(match[a]) + Number(verify[a] ?? 0));
  return [`${whose} ${images} images, ${about}${counted(pairs, "pair")}`, `${duration(seconds)} on one core`];
}

/** Images and pairs of the flight. The models of a race may be of a block of it: the pairs of all grow with the images.
 * Without models, only those that were measured are known.
 * @param {Entry} entry */
function extentOf(entry) {
  const values = entry.models?.values;
  const built = Math.max(0, ...(values?.images ?? []).map(Number));
  const images = built || new Set(entry.pairs.flatMap(pair => [pair.image_1, pair.image_2])).size;
  const pairs = built ? values?.pairs?.[values.images.indexOf(built)] ?? entry.pairs.length : entry.pairs.length;
  const whole = built ? raceOf(entry)?.final?.of ?? 0 : 0;
  if (whole <= images) return {whose: built ? "Your" : "These", images, pairs, about: ""};
  return {whose: "Your", images: whole, pairs: Math.round(pairs * whole / images), about: "about "};
}

/** How sure the answer is.
 * @param {Entry} entry @param {Purpose} purpose @param {Candidate[]} ranked */
export function certainty(entry, purpose, ranked) {
  const race = raceOf(entry);
  if (purpose.key === "race" && race) return certaintyOfRace(race);
  if (purpose.key === "overall") return certaintyOfScore(entry, ranked[0]);
  if (ranked.length < 2) return "Nothing else qualifies.";
  const [first, second] = ranked;
  const gap = first.value > 0 ? 1 - second.value / first.value : 0;
  return `Next: ${second.name}${gap > 0.005 ? `, ${percent(gap)} behind` : ", as good"}. Differences are not tested for this purpose.`;
}

/** @param {RaceAnswer} race */
function certaintyOfRace(race) {
  const ends = {budget: "the budget was spent", sure: "the leader was sure enough", measured: "all possible winners were measured on all pairs"};
  const missing = race.final?.unfinished.length ? ` No time for the models of ${race.final.unfinished.join(", ")}.` : "";
  const built = race.final?.models.length ? ` Models of ${race.final.images} of ${race.final.of} images decided.` : "";
  const quicker = race.best.endsWith("-BF") ? " EXACT in place of BF finds the same matches in a fraction of the time for matching." : "";
  return `${race.leader} led with a probability of ${percent(race.probability)}.${built}${missing} `
    + `The race measured ${race.measured} of ${race.combinations} combinations on up to ${pairsOfRace(race)}, `
    + `${counted(race.measurements, "measurement")} in ${duration(race.seconds)}; ${ends[/** @type {keyof typeof ends} */ (race.ended)] ?? race.ended}.${quicker}`;
}

/** A survey chooses pairs that are not among those of the images in a row.
 * @param {RaceAnswer} race */
function pairsOfRace({pairs, candidates}) {
  return pairs > candidates ? counted(pairs, "pair") : `${pairs} of ${counted(candidates, "pair")}`;
}

/** @param {Entry} entry @param {Candidate} chosen */
function certaintyOfScore(entry, chosen) {
  const {score} = entry;
  const {best, probability_best: probability, indistinguishable, untested, units} = score;
  if (entry.combinations.length === 1) return "It is the only combination measured, so there is nothing to compare it with.";
  const measured = measuredShare(entry);
  if (chosen.a !== best) return `Of all, ${entry.combinations[best]} is the best; p = ${shown(chosen.a === null ? null : score.p_value[chosen.a], 2)} for the difference.${measured}`;
  if (units === 1) return `With a single pair (or scene) the uncertainty is unknown.${measured}`;
  const others = indistinguishable.filter(a => a !== best).length;
  const sure = isKnown(probability[best]) ? `It ranks first in ${inWords(percent(probability[best]))} of ${resamples(entry)}` : "The uncertainty is unknown";
  const rest = others ? `; ${counted(others, "other")} ${others === 1 ? "is" : "are"} not significantly different`
    : (untested.length ? "" : "; all others are significantly worse");
  const unknown = untested.length ? `; ${untested.length} share too few pairs with it to be compared` : "";
  return `${sure}${rest}${unknown}.${measured}`;
}

/** How much of the table was measured, where not all was.
 * @param {Entry} entry */
function measuredShare(entry) {
  const all = entry.combinations.length * entry.pairs.length;
  const rows = Object.values(entry.counts).reduce((sum, count) => sum + count, 0);
  const race = entry.race?.unfinished ? " No answer of a race is recorded." : "";
  return `${rows < all ? ` Only ${percent(rows / all)} of all combinations and pairs were measured.` : ""}${race}`;
}

/** @param {string} share */
function inWords(share) {
  return share.replace("> ", "more than ").replace("< ", "less than ");
}

/** @param {Entry} entry */
function resamples(entry) {
  const {resamples: number, resampled: unit} = entry.score.settings;
  const drawn = unit && unit !== "repeat" ? `whole ${unit}s` : `the ${counted(entry.pairs.length, "pair")}`;
  return number ? `${number.toLocaleString("en")} resamples of ${drawn}` : `the resamples of ${drawn}`;
}

/** The pair on which it does worst, and how many fail.
 * @param {Entry} entry @param {Candidate} chosen */
export function weakness(entry, chosen) {
  const a = measuredAs(entry, chosen.name);
  const column = firstColumn(entry, RIGHT_MATCHES);
  if (a === null || column === null || entry.pairs.length < 2) return "";
  const values = pairValues(entry, column, a);
  const known = [...values.keys()].filter(i => Number.isFinite(values[i]));
  if (!known.length) return "";
  const worst = known.reduce((i, j) => (values[j] < values[i] ? j : i));
  const failed = Math.round((1 - Number(entry.score.success_rate[a] ?? 1)) * Number(entry.score.repeats[a] ?? 0));
  return `Weakest pair: ${pairLabel(entry, worst)}, ${shown(values[worst])} ${labelOf(column)}`
    + `${failed ? `; ${counted(failed, "pair")} failed` : ""}.`;
}

/** What the filter does to the answer.
 * @param {Entry} entry */
export function filterWords(entry) {
  return isFiltered() ? `Among the ${counted(shownIn(entry).length, "combination")} that match the filter.` : "";
}
