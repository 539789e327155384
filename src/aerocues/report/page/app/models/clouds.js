/* Two clouds side by side, turned together by dragging, keys, buttons or an animation. */

import {themeName} from "../basis/colours.js";
import {fileStem, saveFile} from "../basis/downloads.js";
import {figuresList, make} from "../basis/elements.js";
import {remember} from "../basis/entries.js";
import {currentFilter} from "../basis/filter.js";
import {sentenceCase, shown} from "../basis/numbers.js";
import {currentEntry} from "../basis/state.js";
import {colourLimits, POINT_COLOURS, pointPixels, scaleColours, sortedKnown, stageOf} from "./cloud-space.js";
import {buildCloudTools, refreshCloudTools} from "./cloud-tools.js";
import {cloudNote, cloudsOf, cloudView, drawClouds} from "./cloud-view.js";
import {modelColumns} from "./models-table.js";
import {listenToTurns, setPlaying, turnBy} from "./turning.js";
import {layerControl, selectControl} from "../shell/controls.js";

const stillWanted = window.matchMedia("(prefers-reduced-motion: reduce)");
const CLOUD_LAYERS = [
  {key: "cameras", label: "Cameras", shown: true},
  {key: "truth", label: "True positions", shown: true},
];
const TURNS = [
  ["◀", "Turn to the left", "ArrowLeft"], ["▶", "Turn to the right", "ArrowRight"], ["▲", "View more from above", "ArrowUp"],
  ["▼", "View more from the side", "ArrowDown"], ["+", "Zoom in", "+"], ["−", "Zoom out", "-"],
];

/** Clouds of combinations that match the filter; all clouds if none does.
 * @param {Entry} entry */
function cloudsToShow(entry) {
  const passes = currentFilter();
  const found = cloudsOf(entry).filter(cloud => passes(cloud.combination.split("-")));
  return found.length ? found : cloudsOf(entry);
}

/** @param {string} name @param {string} label @param {number} place @returns {ControlSpec} */
function cloudChoice(name, label, place) {
  return {name, label,
    options: entry => cloudsToShow(entry).map(({combination, why}) => ({key: combination, label: `${combination} (${why})`})),
    fallback: entry => (cloudsToShow(entry)[place] ?? cloudsToShow(entry)[0])?.combination};
}

/** @type {ControlSpec} */
const CLOUD_COLOURS = {name: "colour", label: "Colours", fallback: () => "image",
  options: entry => POINT_COLOURS.filter(kind => kind.key === "image" || cloudsOf(entry).some(cloud => sortedKnown(kind.values(cloud)).length))
    .map(({key, label}) => ({key, label}))};

/** @param {HTMLElement} parent */
export function buildClouds(parent) {
  const controls = {left: selectControl("cloud", cloudChoice("left", "First", 0)),
    right: selectControl("cloud", cloudChoice("right", "Second", 1)), colour: selectControl("cloud", CLOUD_COLOURS)};
  const layers = CLOUD_LAYERS.map(layer => layerControl("cloud", layer));
  const {play, legend} = cloudView;
  play.hidden = stillWanted.matches;
  play.addEventListener("click", () => setPlaying(!cloudView.playing));
  const buttons = TURNS.map(([sign, label, key]) => make("button", {type: "button", class: "quiet", "aria-label": label, title: label, onclick: () => turnBy(key)}, sign));
  const panels = ["left", "right"].map(buildCloudPanel);
  Object.assign(cloudView, {controls, layers, panels});
  parent.append(
    make("h3", {}, "Clouds"),
    make("p", {class: "read"}, "Both clouds are seen from the same viewpoint. Drag or use the arrow keys to turn, + and − to zoom, Home to reset. "
      + "A ring marks the true position of a camera, and a line connects it with its position in the model: long lines mean a bent model."),
    make("div", {class: "controls"}, [...Object.values(controls), ...layers].map(control => control.element), make("span", {class: "save"}, play, buttons)),
    ...buildCloudTools(parent), legend, make("div", {class: "panels"}, panels.map(panel => panel.element)));
}

/** @param {string} side @returns {CloudPanel} */
function buildCloudPanel(side) {
  const canvas = make("canvas", {role: "img", tabindex: "0", "data-side": side});
  const [title, note, words] = [make("h4"), make("p", {class: "note"}), make("div", {class: "words"})];
  const save = make("button", {type: "button", class: "quiet", "aria-label": `Save the ${side} cloud as PNG`,
    onclick: () => canvas.toBlob(blob => saveFile(`${fileStem(currentEntry().name, "cloud", title.textContent ?? "")}.png`, blob, "image/png"))}, "PNG");
  const element = make("article", {class: "panel-of-cloud"}, make("div", {class: "panel-title"}, title, save), canvas, note, words);
  listenToTurns(canvas);
  new ResizeObserver(() => drawClouds()).observe(element);
  return {side, canvas, title, note, words, element, cloud: null, pixels: null};
}

export function refreshClouds() {
  if (cloudsOf(currentEntry()).length) updateClouds();
}

function updateClouds() {
  for (const control of [...Object.values(cloudView.controls), ...cloudView.layers]) control.refresh();
  const clouds = cloudsOf(currentEntry());
  cloudView.stage = remember(currentEntry(), "stage", () => stageOf(clouds));
  for (const panel of cloudView.panels) {
    const combination = cloudView.controls[panel.side].value();
    panel.cloud = clouds.find(cloud => cloud.combination === combination) ?? null;
    panel.title.textContent = combination;
    panel.words.replaceChildren(...cloudWords(panel.cloud));
    panel.note.textContent = cloudNote(panel.cloud);
  }
  refreshCloudTools();
  colourClouds();
  drawClouds();
}

/* Both clouds share one colour scale. */
function colourClouds() {
  const kind = POINT_COLOURS.find(each => each.key === cloudView.controls.colour.value()) ?? POINT_COLOURS[0];
  const shownClouds = cloudView.panels.flatMap(({cloud}) => (cloud ? [cloud] : []));
  const limits = colourLimits(kind, shownClouds);
  for (const panel of cloudView.panels) panel.pixels = panel.cloud && pointPixels(panel.cloud, kind, limits, themeName());
  cloudView.legend.hidden = !limits;
  if (!limits) return;
  const scale = make("span", {class: "scale", "aria-hidden": "true"});
  scale.style.background = `linear-gradient(to right, ${scaleColours(themeName()).filter((_, i) => i % 15 === 0).join(", ")})`;
  const [low, high] = limits.map(value => shown(value));
  cloudView.legend.replaceChildren(`${sentenceCase(kind.label)}: ${low} `, scale, ` ${high} ${kind.unit(shownClouds[0])} and more`);
}

const FIGURES_OF_CLOUDS = ["registered_images", "placed_images", "points_3d", "mean_track_length", "reprojection_error", "position_rmse",
  "cloud_distance_rms", "reference_distance_rms"];

/** @param {Cloud | null} cloud */
function cloudWords(cloud) {
  const entry = currentEntry();
  const {models} = entry;
  const m = cloud && models ? models.combinations.indexOf(cloud.combination) : -1;
  if (!models || m < 0) return [];
  /** @type {[string, string][]} */
  const rows = modelColumns(entry).filter(({key}) => FIGURES_OF_CLOUDS.includes(key)).map(column => [column.label, column.text(m)]);
  const reason = models.message[m];
  return [reason ? make("p", {class: "note"}, sentenceCase(reason)) : "", figuresList([["Status", models.status[m].replaceAll("_", " ")], ...rows])];
}
