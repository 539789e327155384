/* The panel of limits in the toolbar. */

import {make} from "../basis/elements.js";
import {hasLimits, limitedMeasure} from "../basis/limits.js";
import {currentEntry, state} from "../basis/state.js";
import {measureOptions, optionElements} from "./controls.js";

const summary = make("summary", {id: "limits-summary"}, "Limits");
const measure = make("select", {id: "limit-measure", onchange: () => state.set({measure: measure.value === "score" ? null : measure.value})});
/** @type {[key: string, label: string][]} */
const NUMBERS = [["min", "at least"], ["max", "at most"], ["worst", "only the worst"]];
const inputs = NUMBERS.map(([key]) => {
  const input = make("input", {type: "number", step: "any", id: `limit-${key}`, oninput: () => state.set({[key]: input.value || null})});
  return input;
});

export function buildLimits() {
  return make("details", {class: "methods", id: "limits"}, summary, make("div", {class: "panel"},
    make("label", {class: "limit", for: "limit-measure"}, "Value", measure),
    NUMBERS.map(([key, label], i) => make("label", {class: "limit", for: `limit-${key}`}, label, inputs[i])),
    make("p", {class: "note"}, "Means over the pairs of each combination. Times are in seconds. The worst are those with the worst of this value.")));
}

export function updateLimits() {
  const entry = currentEntry();
  measure.replaceChildren(...optionElements(measureOptions(entry)));
  measure.value = limitedMeasure(entry)?.key ?? "score";
  inputs.forEach((input, i) => { if (input !== document.activeElement) input.value = state.get(NUMBERS[i][0]); });
  summary.textContent = hasLimits() ? "Limits (on)" : "Limits";
}
