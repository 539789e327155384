/* Controls; each reads and writes one key of the state. */

import {make} from "../basis/elements.js";
import {CODES, measuresOf} from "../basis/entries.js";
import {isGroundTruth, labelOf} from "../basis/numbers.js";
import {currentEntry, state} from "../basis/state.js";

/** The value of a key, or its default if the value is not among the options.
 * @param {string} key @param {Option[]} options @param {string | null} [fallback] */
function chosen(key, options, fallback) {
  const value = state.get(key);
  const keys = options.map(option => option.key);
  if (keys.includes(value)) return value;
  return fallback && keys.includes(fallback) ? fallback : keys[0];
}

let controlCount = 0;

/** A list to choose from.
 * @param {string} figureId @param {ControlSpec} control @returns {Control} */
export function selectControl(figureId, control) {
  const key = `${figureId}.${control.name}`;
  controlCount += 1;
  const select = make("select", {id: `control-${controlCount}`, onchange: () => {
    const fallback = control.fallback?.(currentEntry()) ?? select.options[0].value;
    state.set({[key]: select.value === fallback ? null : select.value});
  }});
  const element = make("label", {class: "control", for: select.id}, `${control.label} `, select);
  let drawnFor = "";
  const refresh = () => {
    const entry = currentEntry();
    const options = control.options(entry);
    const listed = JSON.stringify(options);
    if (listed !== drawnFor) {
      select.replaceChildren(...optionElements(options));
      drawnFor = listed;
    }
    if (options.length) select.value = chosen(key, options, control.fallback?.(entry));
    element.hidden = options.length < 2;
  };
  return {element, refresh, value: () => {
    const entry = currentEntry();
    return chosen(key, control.options(entry), control.fallback?.(entry));
  }};
}

/** A box to tick.
 * @param {string} figureId @param {LayerSpec} layer @returns {Layer} */
export function layerControl(figureId, layer) {
  const key = `${figureId}.${layer.key}`;
  const box = make("input", {type: "checkbox", "data-layer": layer.key, onchange: () =>
    state.set({[key]: box.checked === layer.shown ? null : (box.checked ? "yes" : "no")})});
  const value = () => (state.get(key) ? state.get(key) === "yes" : layer.shown);
  return {
    element: make("label", {class: `control layer ${layer.key}`}, box,
      make("span", {class: "swatch", "aria-hidden": "true"}), layer.label),
    refresh: () => { box.checked = value(); },
    value,
  };
}

/** @param {Option[]} options */
export function optionElements(options) {
  /** @type {Map<string, HTMLOptionElement[]>} */
  const groups = new Map();
  for (const option of options) {
    const name = option.group ?? "";
    groups.set(name, [...(groups.get(name) ?? []), make("option", {value: option.key}, option.label)]);
  }
  return [...groups].flatMap(([name, members]) =>
    (name ? [make("optgroup", {label: name}, members)] : members));
}

/** Numbers of combinations to show.
 * @param {number[]} [sizes] @param {number} [fallback] @returns {ControlSpec} */
export function topControl(sizes = [10, 20, 40], fallback = 20) {
  return {
    name: "top", label: "Combinations",
    options: () => sizes.map(size => ({key: String(size), label: `best ${size}`})),
    fallback: () => String(fallback),
  };
}

/** @param {string} [fallback] @returns {ControlSpec} */
export function scaleControl(fallback = "linear") {
  return {
    name: "scale", label: "Scale",
    options: () => [{key: "linear", label: "linear"}, {key: "log", label: "logarithmic"}],
    fallback: () => fallback,
  };
}

/** @param {string} [fallback] @returns {ControlSpec} */
export function colourControl(fallback = "detector") {
  return {
    name: "colour", label: "Colour by",
    options: () => CODES.map(code => ({key: code, label: code})),
    fallback: () => fallback,
  };
}

/** Columns with a value per pair, in two groups: with and without ground truth.
 * @param {Entry} entry @param {(name: string) => boolean} [wanted] @returns {Option[]} */
export function columnOptions(entry, wanted = () => true) {
  return Object.keys(entry.columns).filter(wanted).map(name => ({
    key: name, label: labelOf(name),
    group: isGroundTruth(name) ? "from ground truth" : "from inliers, counts and times",
  }));
}

/** @param {Entry} entry */
export function measureOptions(entry) {
  return measuresOf(entry).map(({key, label}) => ({
    key, label, group: isGroundTruth(key) ? "from ground truth" : "from inliers, counts and times",
  }));
}
