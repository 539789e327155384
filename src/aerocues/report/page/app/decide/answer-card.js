/* The answer for a purpose, in words and figures. */

import {disclosure, figuresList, make} from "../basis/elements.js";
import {fixed, percent} from "../basis/numbers.js";
import {currentEntry, state} from "../basis/state.js";
import {explained} from "../basis/words.js";
import {codeOf, commandOf, copyButton} from "./copies.js";
import {openCombination} from "../drawer/combination.js";
import {refreshSliders, weightSliders} from "./own-weights.js";
import {bestForOthers, currentPurpose, purposesOf, rankedForPurpose} from "./purposes.js";
import {countsNote} from "../score/weights.js";
import {certainty, filterWords, reasons, weakness} from "./reasons.js";

const OTHERS = 4;
const EQUALS_SHOWN = 30;
const purposes = make("div", {class: "purposes", role: "group", "aria-label": "Best for"});
const verdict = make("div", {id: "verdict", "aria-live": "polite"});
const sliders = weightSliders();

export function buildAnswer() {
  return make("article", {class: "card main answer"}, purposes, verdict, disclosure("Own weights", sliders));
}

export function updateAnswer() {
  const entry = currentEntry();
  const purpose = currentPurpose();
  const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.purpose : null;
  purposes.replaceChildren(...purposesOf(entry).map(({key, label}) => make("button", {type: "button", class: "chip", "data-purpose": key,
    "aria-pressed": String(key === purpose.key), onclick: () => state.set({"decide.purpose": key === purposesOf(entry)[0].key ? null : key})}, label)));
  /** @type {HTMLElement | null} */
  const again = focused ? purposes.querySelector(`[data-purpose="${focused}"]`) : null;
  again?.focus();
  refreshSliders(sliders);
  verdict.replaceChildren(...answer(entry, purpose));
}

/** @param {Entry} entry @param {Purpose} purpose @returns {HTMLElement[]} */
function answer(entry, purpose) {
  const ranked = rankedForPurpose();
  if (!ranked.length) {
    return [make("p", {class: "lead"}, "No combination qualifies. "), make("p", {}, `${filterWords(entry)} See the table and the failures below.`)];
  }
  const [first] = ranked;
  const weak = weakness(entry, first);
  return [
    make("p", {class: "lead"}, make("span", {class: "take"}, "Take "), make("strong", {}, nameOf(entry, first.name))),
    make("p", {class: "meaning"}, explained([filterWords(entry), `Best for: ${purpose.meaning(entry)}.`].filter(Boolean).join(" "))),
    figuresList(reasons(entry, first, purpose)),
    make("p", {class: "sure"}, explained(certainty(entry, purpose, ranked))),
    ...(purpose.key === "overall" ? equals(entry) : []),
    ...(isGeneral(purpose) ? remarks(entry, first) : []),
    ...(weak ? [make("p", {class: "weak"}, weak)] : []),
    make("p", {class: "copies"}, copyButton("Copy command", commandOf(entry, first.name)), copyButton("Copy code", codeOf(entry, first.name)),
      make("button", {type: "button", class: "quiet", onclick: () => openCombination(first.name)}, "Details")),
    make("code", {class: "command", tabindex: "0"}, commandOf(entry, first.name)),
    others(entry, ranked),
  ];
}

/** Whether a score over everything decides, which may hide who is best in one thing.
 * @param {Purpose} purpose */
function isGeneral({key}) {
  return key === "overall" || key === "race";
}

/** @param {Entry} entry @param {Candidate} first */
function remarks(entry, first) {
  return [bestForOthers(entry, first.name), countsNote(entry)].filter(Boolean).map(text => make("p", {class: "sure"}, text));
}

/** @param {Entry} entry @param {string} name */
export function nameOf({models}, name) {
  return name === models?.baseline ? "COLMAP’s default" : name;
}

/** The best few, with bars.
 * @param {Entry} entry @param {Candidate[]} ranked */
function others(entry, ranked) {
  const most = Math.max(...ranked.slice(0, OTHERS).map(each => each.value), 1e-9);
  return make("ol", {class: "candidates", "aria-label": "The best for this purpose"}, ranked.slice(0, OTHERS).map(each => {
    const bar = make("span", {class: "bar-of-value", "aria-hidden": "true"});
    bar.style.setProperty("--share", String(Math.max(0, each.value / most)));
    return make("li", {}, make("button", {type: "button", onclick: () => openCombination(each.name)}, nameOf(entry, each.name)), bar,
      make("span", {class: "value"}, each.text));
  }));
}

/** Those that are not significantly different from the best.
 * @param {Entry} entry */
function equals(entry) {
  const {score} = entry;
  const alike = score.indistinguishable.filter(a => a !== score.best);
  if (!alike.length) return [];
  const more = alike.length > EQUALS_SHOWN ? [make("li", {}, `and ${alike.length - EQUALS_SHOWN} more`)] : [];
  return [disclosure(`Not significantly different (${alike.length})`, make("ul", {class: "equals"},
    alike.slice(0, EQUALS_SHOWN).map(a => make("li", {}, `${entry.combinations[a]} ${fixed(score.score[a])}`)), more))];
}

/** @param {Entry} entry */
export function factsSentence(entry) {
  /** @type {Record<string, string>} */
  const timings = {
    exclusive: "each time was measured on a core of its own",
    sampled: "some pairs were timed on a core of their own, and the times of the others were scaled to match",
    scaled: "times were scaled to match pairs that were timed on a core of their own",
    estimated: "times were measured beside other measurements, and brute force was timed on a sample",
    shared: "times were measured beside other measurements and are somewhat too long",
    mixed: "some times were measured beside other measurements",
  };
  const pairs = entry.pairs.length;
  const rows = Object.values(entry.counts).reduce((sum, count) => sum + count, 0);
  const share = rows / (pairs * entry.combinations.length);
  const parts = [
    `${entry.combinations.length.toLocaleString("en")} combinations on ${pairs.toLocaleString("en")} pairs of ${entry.dataset}`,
    share < 1 ? `${percent(share)} of these measured` : null,
    entry.machine ? `on ${entry.machine}` : null,
    entry.preset ? `scored with the preset “${entry.preset}”` : null, timings[entry.timing],
  ];
  return `${parts.filter(Boolean).join("; ")}.`;
}

