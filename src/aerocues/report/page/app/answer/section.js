/* Section 1: the answer in words and a few figures, and the table of all combinations. */

import {RANKING} from "./ranking-table.js";
import {disclosure, elementOf, figuresList, make} from "../basis/elements.js";
import {firstColumn, meansOf, pairCount, ranked, rankText, withRank} from "../basis/entries.js";
import {isFiltered, shownIn} from "../basis/filter.js";
import {counted, duration, fixed, isKnown, labelOf, percent, sentenceCase, shown} from "../basis/numbers.js";
import {currentEntry} from "../basis/state.js";
import {addColumnTable, updateColumnTable} from "../shell/column-table.js";

/** @type {SectionSpec} */
export const ANSWER_SECTION = {
  id: "answer",
  title: "Answer",
  read: "The best combination for these images by CUES, the Composite Unsupervised Efficiency Score "
    + "(0: worst in all criteria, 1: best in all), and how certain this is.",
  build(body) {
    const all = make("div", {id: "all"});
    body.append(make("div", {id: "verdict"}), all);
    addColumnTable(all, RANKING);
  },
  update(_, changed) {
    const figuresOnly = [...changed].every(key => key.includes(".") || key === "theme");
    if (!figuresOnly && [...changed].some(key => !["sort", "columns", "rows"].includes(key))) {
      elementOf("verdict").replaceChildren(...verdict(currentEntry()));
    }
    if (!figuresOnly) updateColumnTable(RANKING, changed);
  },
};

/** @param {Entry} entry */
function verdict(entry) {
  const score = entry.score;
  if (!isKnown(score.best) || !isKnown(score.score[score.best])) {
    return [make("p", {class: "lead"}, "No combination has a score. See the table and the failures below.")];
  }
  return [
    make("p", {class: "lead"}, ...leadSentence(entry)),
    make("div", {class: "cards"},
      bestCard(entry), equalsCard(entry),
      choiceCard(entry, "Fastest good one", score.fastest_good,
        `the fastest with at least ${percent(score.settings.good)} of the best score and success rate`),
      choiceCard(entry, "Best with binary descriptors", score.best_binary,
        "small descriptors, compared by the Hamming distance"),
      filteredCard(entry)),
    make("p", {class: "facts"}, factsSentence(entry)),
  ];
}

/** @param {Entry} entry */
function leadSentence(entry) {
  const {best, probability_best: probability, indistinguishable, untested, units} = entry.score;
  const others = indistinguishable.filter(a => a !== best).length;
  const name = make("strong", {}, entry.combinations[best]);
  if (entry.combinations.length === 1) {
    return [name, " is the only combination measured, so there is nothing to compare it with."];
  }
  const measured = ` is the best of ${entry.combinations.length} combinations on ${entry.dataset}.`;
  if (units === 1) return [name, measured, " With a single pair (or scene) the uncertainty is unknown."];
  const sure = isKnown(probability[best])
    ? ` It ranks first in ${inWords(percent(probability[best]))} of ${resamples(entry)}`
    : " The uncertainty is unknown";
  const rest = others ? `; ${counted(others, "other")} ${others === 1 ? "is" : "are"} not significantly different`
    : (untested.length ? "" : "; all others are significantly worse");
  const unknown = untested.length
    ? `; ${untested.length} share too few pairs with it to be compared` : "";
  return [name, measured, sure, rest, unknown, "."];
}

/** @param {string} share */
function inWords(share) {
  return share.replace("> ", "more than ").replace("< ", "less than ");
}

/** @param {Entry} entry */
function resamples(entry) {
  const {resamples: number, resampled: unit} = entry.score.settings;
  const drawn = unit && unit !== "repeat" ? `whole ${unit}s` : `the ${pairCount(entry)}`;
  return number ? `${number.toLocaleString("en")} resamples of ${drawn}` : `the resamples of ${drawn}`;
}

/** @param {Entry} entry */
function factsSentence(entry) {
  /** @type {Record<string, string>} */
  const timings = {
    exclusive: "each time was measured on a core of its own",
    sampled: "some pairs were timed on a core of their own, and the times of the others were scaled to match",
    scaled: "times were scaled to match pairs that were timed on a core of their own",
    estimated: "times were measured beside other measurements, and brute force was timed on a sample",
    shared: "times were measured beside other measurements and are somewhat too long",
    mixed: "some times were measured beside other measurements",
  };
  const parts = [
    `${counted(entry.combinations.length, "combination")} on ${pairCount(entry)} of ${entry.dataset}`,
    entry.machine ? `measured on ${entry.machine}` : null,
    entry.preset ? `scored with the preset “${entry.preset}”` : null, timings[entry.timing],
  ];
  return `${parts.filter(Boolean).join("; ")}.`;
}

/** @param {string} title @param {string | null} name @param {Content} lines @param {string} [kind] */
function card(title, name, lines, kind = "") {
  return make("article", {class: `card ${kind}`}, make("h3", {}, title),
    name ? make("p", {class: "name"}, name) : null, lines);
}

/** @param {Entry} entry @param {number} a @returns {([string, Content] | null)[]} */
function scoreFigures(entry, a) {
  const score = entry.score;
  const total = entry.medians.total[a];
  const meanFigure = (/** @type {string | null} */ column) => (column === null ? null
    : /** @type {[string, string]} */ ([sentenceCase(labelOf(column)), shown(meansOf(entry, column)[a])]));
  const precision = firstColumn(entry, ["ref_precision@3", "precision_beyond_chance", "precision"]);
  const truth = firstColumn(entry, ["gt_precision@3"]);
  return [
    ["CUES", `${fixed(score.score[a])} (${fixed(score.score_low[a])} to ${fixed(score.score_high[a])})`],
    ["Rank", rankText(score, a)],
    ["Success", `${percent(score.success_rate[a])} of pairs`],
    meanFigure(precision), meanFigure(truth),
    isKnown(total) ? ["Time per image and pair", duration(total)] : null,
  ];
}

/** @param {Entry} entry */
function bestCard(entry) {
  const best = entry.score.best;
  return card("Best", entry.combinations[best], figuresList([
    ...scoreFigures(entry, best),
    isKnown(entry.score.probability_best[best])
      ? ["First in resamples", percent(entry.score.probability_best[best])] : null,
  ]), "main");
}

const EQUALS_SHOWN = 8;

/** @param {Entry} entry */
function equalsCard(entry) {
  const score = entry.score;
  const equals = score.indistinguishable.filter(a => a !== score.best)
    .sort((a, b) => Number(score.rank[a]) - Number(score.rank[b]));
  if (entry.combinations.length < 2) return null;
  if (!equals.length) {
    const second = withRank(entry, ranked(entry))[1];
    if (second === undefined) return null;
    return card("Runner-up", entry.combinations[second], figuresList([
      ...scoreFigures(entry, second),
      ["p against the best", isKnown(score.p_value[second]) ? shown(score.p_value[second], 2) : "not tested"]]));
  }
  const row = (/** @type {number} */ a) => make("li", {value: score.rank[a]}, make("span", {}, entry.combinations[a]), ` ${fixed(score.score[a])}`);
  return card("Not significantly different", null, [
    make("ol", {class: "equals"}, equals.slice(0, EQUALS_SHOWN).map(row)),
    equals.length > EQUALS_SHOWN
      ? disclosure(`${equals.length - EQUALS_SHOWN} more`,
        make("ol", {class: "equals"}, equals.slice(EQUALS_SHOWN).map(row)))
      : null]);
}

/** @param {Entry} entry @param {string} title @param {number | null} a @param {string} meaning */
function choiceCard(entry, title, a, meaning) {
  if (!isKnown(a)) return null;
  if (a === entry.score.best) {
    return card(title, entry.combinations[a], make("p", {}, `This is also the best one: ${meaning}.`));
  }
  return card(title, entry.combinations[a], [
    make("p", {}, `${sentenceCase(meaning)}${timesAsFast(entry, a)}.`),
    figuresList(scoreFigures(entry, a))]);
}

/** @param {Entry} entry @param {number} a */
function timesAsFast(entry, a) {
  const own = entry.medians.total[a];
  const other = entry.medians.total[entry.score.best];
  if (!own || !other || other / own < 1.05) return "";
  return `; ${shown(other / own, 2)} times as fast as the best`;
}

/** @param {Entry} entry */
function filteredCard(entry) {
  const first = shownIn(entry)[0];
  if (!isFiltered() || first === undefined || first === entry.score.best || !isKnown(entry.score.rank[first])) return null;
  return card("Best that matches the filter", entry.combinations[first],
    figuresList(scoreFigures(entry, first)), "filtered");
}
