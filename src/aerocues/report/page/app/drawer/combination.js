/* A combination in the drawer: its figures, stages, weakest pairs and model; a pinned one beside it. */

import {figuresList, make, plainTable} from "../basis/elements.js";
import {firstColumn, meansOf, pairLabel, pairValues, rankText} from "../basis/entries.js";
import {duration, fixed, isKnown, labelOf, percent, sentenceCase, shown, valueText} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {currentEntry, state} from "../basis/state.js";
import {modelColumns} from "../models/models-table.js";
import {closeDrawer, showDrawer} from "./drawer.js";
import {openPair} from "./pair.js";

const WEAKEST = 5;
/** @type {(Stage)[]} */
const STAGES = ["detect", "describe", "match", "verify"];

/** Opens the drawer with a combination, beside the pinned one if there is one.
 * @param {string} name */
export function openCombination(name) {
  const pinned = state.get("decide.pin");
  state.set({"decide.pick": name});
  const names = pinned && pinned !== name && isHere(pinned) ? [pinned, name] : [name];
  showDrawer(names.join(" and "), make("div", {class: `compared of-${names.length}`}, names.map(each => details(each, name, names.length > 1))));
}

/** @param {string} name */
export function isHere(name) {
  const {combinations, models} = currentEntry();
  return combinations.includes(name) || (models?.combinations.includes(name) ?? false);
}

/** @param {string} name @param {string} latest @param {boolean} named  Whether its name stands above it. */
function details(name, latest, named) {
  const entry = currentEntry();
  const a = entry.combinations.indexOf(name);
  const isPinned = state.get("decide.pin") === name;
  const pin = make("button", {type: "button", class: "quiet", "aria-pressed": String(isPinned), onclick: () => {
    state.set({"decide.pin": isPinned ? null : name});
    openCombination(latest);
  }}, isPinned ? "Unpin" : "Pin to compare");
  return make("article", {class: "details"}, named ? make("h3", {}, name) : null, pin,
    a < 0 ? make("p", {class: "note"}, "Its pairs were not measured one by one.") : figuresList(figuresOf(entry, a)),
    a < 0 ? null : stagesOf(entry, a), a < 0 ? null : weakestPairs(entry, a), modelOf(entry, name), picturesOf(entry, name));
}

/** @param {Entry} entry @param {number} a @returns {([string, Content] | null)[]} */
function figuresOf(entry, a) {
  const {score} = entry;
  return [
    ["Rank by CUES", rankText(score, a)],
    ["CUES", `${fixed(score.score[a])} (${fixed(score.score_low[a])} to ${fixed(score.score_high[a])})`],
    isKnown(score.p_value[a]) ? ["p against the best", shown(score.p_value[a], 2)] : null,
    ["Success", `${percent(score.success_rate[a])} of ${shown(score.repeats[a])} pairs`],
    ...score.criteria.filter(each => !each.reconstruction).map(each => /** @type {[string, Content]} */ ([
      sentenceCase(labelOf(each.name)), valueText(each.name, meansOf(entry, each.name)[a])])),
    isKnown(entry.megabytes[a]) ? ["Descriptors of an image", `${shown(entry.megabytes[a], 2)} MB`] : null,
  ];
}

/** @param {Entry} entry @param {number} a */
function stagesOf({medians}, a) {
  const total = STAGES.reduce((sum, stage) => sum + Number(medians[stage][a] ?? 0), 0);
  if (!total) return null;
  return make("div", {class: "stages"}, make("h3", {}, `Time: ${duration(medians.total[a])}`), STAGES.map(stage => {
    const bar = make("span", {class: "bar-of-value", "aria-hidden": "true"});
    bar.style.setProperty("--share", String(Number(medians[stage][a] ?? 0) / total));
    return make("div", {class: "stage"}, make("span", {}, stage), bar, make("span", {class: "value"}, duration(medians[stage][a])));
  }));
}

/** @param {Entry} entry @param {number} a */
function weakestPairs(entry, a) {
  const column = firstColumn(entry, ["ref_matches@3", "excess_inliers", "inliers"]);
  if (!column) return null;
  const values = pairValues(entry, column, a);
  const known = [...values.keys()].filter(i => Number.isFinite(values[i])).sort((i, j) => values[i] - values[j]).slice(0, WEAKEST);
  return plainTable(`Its weakest pairs, of ${entry.pairs.length}`, [
    {label: "Pair", text: i => make("button", {type: "button", class: "link", onclick: () => openPair(i)}, pairLabel(entry, i))},
    {label: sentenceCase(labelOf(column)), number: true, text: i => shown(values[i])}], known);
}

/** @param {Entry} entry @param {string} name */
function modelOf(entry, name) {
  const m = entry.models?.combinations.indexOf(name) ?? -1;
  if (m < 0) return null;
  const shownOnes = modelColumns(entry).filter(column => column.usual && !["combination", "place", "rank", "message"].includes(column.key));
  const cloud = payload.clouds.some(each => each.entry === entry.name && each.combination === name);
  return make("div", {}, make("h3", {}, "Its model"), figuresList(shownOnes.map(column => [column.label, column.text(m)])),
    cloud ? goButton("Show its cloud", {"cloud.left": name}, "clouds") : null);
}

/** @param {Entry} entry @param {string} name */
function picturesOf(entry, name) {
  const own = payload.pictures.filter(each => each.entry === entry.name && each.combination === name);
  return own.length ? goButton(`Show its matches on ${own.length} pairs`, {"picture.left": name}, "pictures") : null;
}

/** @param {string} label @param {Record<string, string>} changes @param {string} target */
function goButton(label, changes, target) {
  return make("button", {type: "button", class: "quiet", onclick: () => {
    closeDrawer();
    state.set(changes);
    document.getElementById(target)?.scrollIntoView({block: "start"});
  }}, label);
}
