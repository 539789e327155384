/* Section 1: the answer, in words and a few figures, then the table of all. */

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
    + "(0 is the worst seen in everything, 1 the best), and how sure that is.",
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
    return [make("p", {class: "lead"}, "No combination has a score: see the table and the failures below.")];
  }
  return [
    make("p", {class: "lead"}, ...leadSentence(entry)),
    make("div", {class: "cards"},
      bestCard(entry), equalsCard(entry),
      choiceCard(entry, "Fastest good one", score.fastest_good,
        `the quickest with ${percent(score.settings.good)} of the best score and success rate`),
      choiceCard(entry, "Best with binary descriptors", score.best_binary,
        "small descriptors, compared by Hamming distance"),
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
  if (units === 1) return [name, measured, " A single pair (or scene) says nothing of how sure that is."];
  const sure = isKnown(probability[best])
    ? ` It comes first in ${inWords(percent(probability[best]))} of ${resamples(entry)}`
    : " How sure that is cannot be told";
  const rest = others ? `; ${counted(others, "other")} cannot be told from it`
    : (untested.length ? "" : "; every other one is significantly worse");
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
    exclusive: "times were taken with a core to themselves",
    sampled: "times of some pairs were taken with a core to themselves, and scale those of the others",
    scaled: "times are scaled by those of other pairs, taken with a core to themselves",
    estimated: "times were taken while other measurements ran beside, and brute force was timed on a part",
    shared: "times were taken while other measurements ran beside, so they are somewhat too long",
    mixed: "some times were taken while other measurements ran beside",
  };
  const parts = [
    `${counted(entry.combinations.length, "combination")} on ${pairCount(entry)} of ${entry.dataset}`,
    entry.machine ? `measured on ${entry.machine}` : null,
    entry.preset ? `scored by the preset “${entry.preset}”` : null, timings[entry.timing],
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
  const precision = firstColumn(entry, ["precision_beyond_chance", "precision"]);
  const truth = firstColumn(entry, ["gt_precision@3"]);
  return [
    ["CUES", `${fixed(score.score[a])} (${fixed(score.score_low[a])} to ${fixed(score.score_high[a])})`],
    ["Rank", rankText(score, a)],
    ["Succeeds on", `${percent(score.success_rate[a])} of pairs`],
    meanFigure(precision), meanFigure(truth),
    isKnown(total) ? ["Time, an image and a pair", duration(total)] : null,
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
      ["Differs from the best", isKnown(score.p_value[second])
        ? `p = ${shown(score.p_value[second], 2)}` : "not tested"]]));
  }
  const row = (/** @type {number} */ a) => make("li", {value: score.rank[a]}, make("span", {}, entry.combinations[a]), ` ${fixed(score.score[a])}`);
  return card("Cannot be told from it", null, [
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
    return card(title, entry.combinations[a], make("p", {}, `The best one is this, too: ${meaning}.`));
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
  return card("Best that passes the filter", entry.combinations[first],
    figuresList(scoreFigures(entry, first)), "filtered");
}
