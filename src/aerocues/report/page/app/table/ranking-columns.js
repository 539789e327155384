/* The columns of the table of all combinations. */

import {make} from "../basis/elements.js";
import {CODES, definitionOf, measureOf, measuresOf, remember} from "../basis/entries.js";
import {duration, fixed, isKnown, NONE, percent, sentenceCase, shown, valueText} from "../basis/numbers.js";

/** @param {Entry} entry */
export function rankingColumns(entry) {
  return remember(entry, "ranking columns", () => [
    ...scoreColumns(entry), ...methodColumns(entry), ...meanColumns(entry), ...timeColumns(entry)]);
}

/** @param {Entry} entry @returns {Column[]} */
function scoreColumns(entry) {
  const score = entry.score;
  /** @type {(name: ScoreFigure, text: (value: Value) => string) => Pick<Column, "number" | "value" | "text">} */
  const of = (name, text) => ({number: true, value: a => score[name][a], text: a => text(score[name][a])});
  return [
    {key: "rank", label: "Rank", title: "Rank by CUES", usual: true, ...of("rank", shown)},
    {key: "combination", label: "Combination", title: "Detector-descriptor-norm-matcher",
      usual: true, value: a => entry.combinations[a], text: a => entry.combinations[a]},
    {key: "score", label: "CUES", usual: true, title: "Score with its 95 % interval over the pairs",
      ...of("score", fixed), cell: (a, span) => intervalCell(score, a, span)},
    {key: "score_low", label: "CUES, low", title: "Lower end of the 95 % interval", ...of("score_low", fixed)},
    {key: "score_high", label: "CUES, high", title: "Upper end of the 95 % interval", ...of("score_high", fixed)},
    {key: "rank_low", label: "Ranks", usual: true, title: "95 % interval of the rank",
      number: true, value: a => score.rank_low[a],
      text: a => (isKnown(score.rank_low[a]) ? `${score.rank_low[a]}–${score.rank_high[a]}` : NONE)},
    {key: "rank_high", label: "Rank, worst", title: "Upper end of the rank's interval", ...of("rank_high", shown)},
    {key: "probability_best", label: "First in", usual: true,
      title: "Share of resamples in which it is the best", ...of("probability_best", percent)},
    {key: "probability_top", label: `In top ${score.settings.top_k}`, title: "Share of resamples in which it is among the best",
      ...of("probability_top", percent)},
    {key: "p_value", label: "p", usual: true, title: "Test of the difference from the best, corrected for the number "
      + "of comparisons; large: not significantly different", ...of("p_value", value => (isKnown(value) && value < 0.001 ? "< 0.001" : shown(value, 2)))},
    {key: "success_rate", label: "Success", usual: true, title: "Share of successful pairs",
      ...of("success_rate", percent)},
    {key: "repeats", label: "Pairs", title: "Number of pairs measured", ...of("repeats", shown)},
  ];
}

/** @param {Score} score @param {number} a @param {Span} span */
function intervalCell(score, a, [from, to]) {
  const [value, low, high] = [score.score[a], score.score_low[a], score.score_high[a]];
  if (!isKnown(value)) return NONE;
  const bar = make("span", {class: "interval", "aria-hidden": "true", title: `${fixed(low)} to ${fixed(high)}`});
  /** @type {(end: Value, otherwise: number) => string} */
  const place = (end, otherwise) => (((isKnown(end) ? end : otherwise) - from) / (to - from)).toFixed(4);
  bar.style.setProperty("--low", place(low, value));
  bar.style.setProperty("--high", place(high, value));
  bar.style.setProperty("--at", place(value, value));
  return make("span", {class: "score"}, fixed(value), bar);
}

/** @param {Entry} entry @returns {Column[]} */
function methodColumns(entry) {
  return CODES.map(code => ({key: code, label: sentenceCase(code), title: `The ${code}`,
    value: a => entry[code][a], text: a => entry[code][a]}));
}

const USUAL_MEANS = [
  ["ref_precision@3", "precision_beyond_chance", "precision"],
  ["ref_matches@3", "excess_inliers", "inliers"],
  ["gt_precision@3"], ["homography_auc@3"], ["pose_auc@10"]];

/** @param {Entry} entry @returns {Column[]} */
function meanColumns(entry) {
  const usual = new Set(USUAL_MEANS.map(names => names.find(name => measureOf(entry, name))));
  return measuresOf(entry)
    .filter(measure => !["score", "success_rate"].includes(measure.key))
    .map(measure => ({
      key: measure.key, label: sentenceCase(measure.label), number: true, usual: usual.has(measure.key),
      title: `Mean over the successful pairs: ${definitionOf(entry, measure.key)}`,
      value: a => measure.values[a], text: a => valueText(measure.key, measure.values[a]),
    }));
}

/** @type {[Stage | "total", string][]} */
const STAGES = [["detect", "Detect"], ["describe", "Describe"], ["match", "Match"], ["verify", "Verify"], ["total", "Total time"]];

/** @param {Entry} entry @returns {Column[]} */
function timeColumns(entry) {
  return STAGES.filter(([stage]) => entry.medians[stage].some(isKnown))
    .map(([stage, label]) => ({
      key: `median_${stage}`, label, number: true, usual: stage === "total",
      title: stage === "total" ? "Median over the pairs, for one image and one pair" : "Median over the pairs",
      value: a => entry.medians[stage][a], text: a => duration(entry.medians[stage][a]),
    }));
}
