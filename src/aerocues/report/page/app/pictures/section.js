/* Section 6: pictures of keypoints and matches, two combinations side by side. */

import {fileStem, saveFile} from "../basis/downloads.js";
import {figuresList, make} from "../basis/elements.js";
import {pairLabel, ranked} from "../basis/entries.js";
import {shownIn} from "../basis/filter.js";
import {labelOf, ordinal, sentenceCase, valueText} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {currentEntry} from "../basis/state.js";
import {drawPanel, pictureView} from "./drawn-matches.js";
import {layerControl, selectControl} from "../shell/controls.js";

/** @type {SectionSpec} */
export const PICTURES_SECTION = {
  id: "pictures",
  title: "Pictures",
  read: "The matches of two combinations on the same pair of images. Lines connect matched keypoints. Inliers agree with the "
    + "estimated geometry, outliers do not; some inliers are wrong by the ground truth or the reference of the pair.",
  available: entry => picturesOf(entry).length > 0,
  build(body) {
    buildPictures(body);
  },
  update() {
    if (picturesOf(currentEntry()).length) updatePictures();
  },
};

/** @param {Entry} entry */
function picturesOf(entry) {
  return payload.pictures.filter(picture => picture.entry === entry.name);
}

/** Pictures of combinations that match the filter; all pictures if none does.
 * @param {Entry} entry */
function picturesToShow(entry) {
  const passed = new Set(shownIn(entry).map(a => entry.combinations[a]));
  const found = picturesOf(entry).filter(picture => passed.has(picture.combination));
  return found.length ? found : picturesOf(entry);
}

const LAYERS = [
  {key: "inliers", label: "Inliers", shown: true},
  {key: "wrong", label: "Inliers, but wrong", shown: true},
  {key: "outliers", label: "Outliers", shown: true},
  {key: "keypoints", label: "Keypoints", shown: false},
];

/** @type {ControlSpec} */
const PAIR_CHOICE = {name: "pair", label: "Images", options: entry => {
  const pairs = [...new Set(picturesToShow(entry).map(picture => picture.pair))].sort((a, b) => a - b);
  return pairs.map(pair => ({key: String(pair), label: pairTitle(entry, pair)}));
}, fallback: entry => String(picturesToShow(entry)[0]?.pair)};

/** @param {Entry} entry @param {number} pair */
function pairTitle(entry, pair) {
  const reasons = [...new Set(picturesOf(entry).filter(each => each.pair === pair && each.why).map(each => each.why))];
  return `${pairLabel(entry, pair)}${reasons.length ? ` (${reasons.join("; ")})` : ""}`;
}

/** @param {string} name @param {string} label @param {number} place @returns {ControlSpec} */
function combinationChoice(name, label, place) {
  return {name, label, options: entry => picturedCombinations(entry).map(each => ({key: each, label: each})),
    fallback: entry => picturedCombinations(entry)[place] ?? picturedCombinations(entry)[0]};
}

/** @param {Entry} entry */
function picturedCombinations(entry) {
  const rank = new Map(ranked(entry).map((a, place) => [entry.combinations[a], place]));
  return [...new Set(picturesToShow(entry).map(picture => picture.combination))]
    .sort((a, b) => (rank.get(a) ?? Infinity) - (rank.get(b) ?? Infinity));
}

/** @type {ControlSpec} */
const EVERY = {name: "every", label: "Draw", fallback: () => "auto", options: () => [
  {key: "auto", label: "a legible number of matches"}, {key: "1", label: "every match"},
  ...[2, 5, 10, 20, 50].map(n => ({key: String(n), label: `every ${ordinal(n)} match`}))]};

/** @param {HTMLElement} body */
function buildPictures(body) {
  const controls = {pair: selectControl("picture", PAIR_CHOICE),
    left: selectControl("picture", combinationChoice("left", "First", 0)),
    right: selectControl("picture", combinationChoice("right", "Second", 1)),
    every: selectControl("picture", EVERY)};
  const layers = LAYERS.map(layer => layerControl("picture", layer));
  const panels = ["left", "right"].map(buildPanel);
  Object.assign(pictureView, {controls, panels, layers});
  body.append(make("div", {class: "controls"}, [...Object.values(controls), ...layers].map(control => control.element)),
    make("div", {class: "panels"}, panels.map(panel => panel.element)));
}

/** @param {string} side @returns {PicturePanel} */
function buildPanel(side) {
  const canvas = make("canvas", {role: "img"});
  const [title, words, note] = [make("h3"), make("div", {class: "words"}), make("p", {class: "note"})];
  const save = make("button", {type: "button", class: "quiet", "aria-label": `Save the ${side} picture as PNG`,
    onclick: () => canvas.toBlob(blob => saveFile(`${fileStem(currentEntry().name, "matches", title.textContent ?? "")}.png`, blob, "image/png"))}, "PNG");
  const element = make("article", {class: "panel-of-matches"}, make("div", {class: "panel-title"}, title, save), canvas, note, words);
  /** @type {PicturePanel} */
  const panel = {side, canvas, words, note, title, element, picture: null};
  new ResizeObserver(() => drawPanel(panel)).observe(element);
  return panel;
}

function updatePictures() {
  for (const control of [...Object.values(pictureView.controls), ...pictureView.layers]) control.refresh();
  for (const panel of pictureView.panels) updatePanel(panel);
}

/** @param {PicturePanel} panel */
function updatePanel(panel) {
  const entry = currentEntry();
  const combination = pictureView.controls[panel.side].value();
  const pair = Number(pictureView.controls.pair.value());
  panel.picture = picturesOf(entry).find(each => each.combination === combination && each.pair === pair) ?? null;
  panel.title.textContent = combination;
  panel.words.replaceChildren(...pictureWords(panel.picture));
  drawPanel(panel);
}

/** @param {Picture | null} picture */
function pictureWords(picture) {
  if (!picture) return [];
  const {status, ...figuresOf} = picture.figures;
  const remark = [picture.role, picture.note].flatMap(each => (each ? [sentenceCase(each)] : [])).join(". ");
  /** @type {[string, string][]} */
  const rows = Object.entries(figuresOf).map(([name, value]) =>
    [sentenceCase(labelOf(name)), typeof value === "number" ? valueText(name, value) : value]);
  return [remark ? make("p", {class: "note"}, `${remark}.`) : "", figuresList([status ? ["Status", String(status)] : null, ...rows])];
}
