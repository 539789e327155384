/* Section 7: 3D models: their figures, their clouds, and what the matches say of them. */

import {make} from "../basis/elements.js";
import {currentEntry} from "../basis/state.js";
import {cloudsOf} from "./cloud-view.js";
import {buildClouds, refreshClouds} from "./clouds.js";
import {CLOUD_DISTANCES, OUTCOME_MATRIX, OUTCOME_SCATTER} from "./model-figures.js";
import {MODELS} from "./models-table.js";
import {addColumnTable, updateColumnTable} from "../shell/column-table.js";
import {addFigure} from "../shell/figure.js";

const hint = make("div", {class: "figure wide", id: "no-models"}, howToReconstruct());
const frame = make("div", {class: "figure wide", id: "modelled"});
const made = make("p", {class: "note"});
const clouds = make("div", {class: "figure wide", id: "clouds"});
/** @type {Figure[]} */
let figures = [];

/** @type {SectionSpec} */
export const MODELS_SECTION = {
  id: "models",
  title: "3D",
  read: "The scene as each combination reconstructs it, with COLMAP: what became of the models, how they look, how far "
    + "they are from each other, and whether good matches make good models.",
  build(body) {
    addColumnTable(frame, MODELS);
    frame.append(made);
    buildClouds(clouds);
    body.append(hint, frame, clouds);
    figures = [CLOUD_DISTANCES, OUTCOME_SCATTER, OUTCOME_MATRIX].map(spec => addFigure(body, spec));
  },
  update(_, changed) {
    const entry = currentEntry();
    const {models} = entry;
    hint.hidden = models !== null;
    frame.hidden = models === null;
    clouds.hidden = !cloudsOf(entry).length;
    for (const figure of figures) figure.element.hidden = models === null;
    if (!models) return;
    if ([...changed].some(key => !key.includes(".") || key.startsWith("models."))) {
      updateColumnTable(MODELS, changed);
      made.textContent = howMade(models);
    }
    refreshClouds();
  },
};

function howToReconstruct() {
  return [make("h3", {}, "No models yet"),
    make("p", {class: "read"}, "This data set was not reconstructed. This makes a model with each of the best 20 combinations and "
      + "stores what became of them with the results; then make the report anew:"),
    make("pre", {class: "citation", tabindex: "0"}, "aerocues reconstruct DATASET -o MODELS --from RESULTS --top 20")];
}

/** What is the same for all models.
 * @param {Models} models */
function howMade(models) {
  const words = Object.entries(models.made).map(([name, value]) => `${name.replaceAll("_", " ")} ${value}`);
  return [words.length ? `The same for all: ${words.join("; ")}.` : "",
    models.reference ? `C2C: distances of points to the nearest point of the model of ${models.reference}, and back.` : ""].filter(Boolean).join(" ");
}
