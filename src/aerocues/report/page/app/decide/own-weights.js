/* Weights of one's own: four aspects, each from 0 (worst of those shown) to 1 (best). */

import {make} from "../basis/elements.js";
import {isKnown} from "../basis/numbers.js";
import {spanOf, valuesAt} from "../basis/statistics.js";
import {state} from "../basis/state.js";
import {byValue, firstOf, RIGHT_MATCHES, SHARES_RIGHT} from "./candidates.js";

const MOST = 10;
/** @typedef {{key: string, label: string, usual: number, better: 1 | -1, log: boolean, values(entry: Entry): Value[] | undefined}} Aspect4 */
/** @type {Aspect4[]} */
const ASPECTS = [
  {key: "accuracy", label: "Accuracy", usual: 5, better: 1, log: false, values: entry => firstOf(entry, SHARES_RIGHT)?.values},
  {key: "matches", label: "Many matches", usual: 5, better: 1, log: true, values: entry => firstOf(entry, RIGHT_MATCHES)?.values},
  {key: "speed", label: "Speed", usual: 5, better: -1, log: true, values: entry => entry.medians.total},
  {key: "memory", label: "Small memory", usual: 0, better: -1, log: true, values: entry => entry.megabytes},
];

/** @param {Aspect4} aspect */
function weightOf({key, usual}) {
  const text = state.get(`decide.${key}`);
  return text === "" ? usual : Math.min(MOST, Math.max(0, Number(text) || 0));
}

/** Values between 0 and 1 over these rows; 0 where unknown.
 * @param {Aspect4} aspect @param {Entry} entry @param {number[]} rows @returns {(a: number) => number} */
function shareOf({better, log, values}, entry, rows) {
  const all = values(entry) ?? [];
  const scale = (/** @type {number} */ value) => better * (log ? Math.log(Math.max(value, 1e-9)) : value);
  const known = valuesAt(all, rows).filter(isKnown).map(scale);
  if (!known.length) return () => 0;
  const [low, high] = spanOf(known);
  return a => (isKnown(all[a]) ? (scale(Number(all[a])) - low) / (high - low) : 0);
}

/** The weighted mean of the aspects, times the success rate: what fails does not count.
 * @param {Entry} entry @param {number[]} rows */
export function rankByWeights(entry, rows) {
  const parts = ASPECTS.map(aspect => ({weight: weightOf(aspect), share: shareOf(aspect, entry, rows)})).filter(part => part.weight > 0);
  const total = parts.reduce((sum, part) => sum + part.weight, 0) || 1;
  const value = (/** @type {number} */ a) => Number(entry.score.success_rate[a] ?? 0)
    * parts.reduce((sum, part) => sum + part.weight * part.share(a), 0) / total;
  return byValue(entry, rows, value, a => value(a).toFixed(2));
}

export function weightSliders() {
  return make("div", {class: "sliders"}, ASPECTS.map(aspect => {
    const told = make("output", {}, String(weightOf(aspect)));
    const input = make("input", {type: "range", min: 0, max: MOST, step: 1, value: weightOf(aspect), "data-aspect": aspect.key,
      oninput: () => {
        told.textContent = input.value;
        state.set({"decide.purpose": "own", [`decide.${aspect.key}`]: Number(input.value) === aspect.usual ? null : input.value});
      }});
    return make("label", {class: "slider"}, make("span", {}, aspect.label), input, told);
  }));
}

/** Shows the weights of a shared view.
 * @param {HTMLElement} sliders */
export function refreshSliders(sliders) {
  for (const aspect of ASPECTS) {
    const input = sliders.querySelector(`input[data-aspect="${aspect.key}"]`);
    if (!(input instanceof HTMLInputElement) || input === document.activeElement) continue;
    input.value = String(weightOf(aspect));
    if (input.nextElementSibling) input.nextElementSibling.textContent = input.value;
  }
}
