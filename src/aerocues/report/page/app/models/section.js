/* Section 7: 3D models: their quality, their clouds, and how they relate to the matches. */

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
  read: "The scene as COLMAP reconstructs it from the matches of each combination: the outcome of each reconstruction, its cloud, the distances "
    + "between clouds, and whether good matches make good models.",
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
    make("p", {class: "read"}, "This dataset was not reconstructed. The command below makes a model with each of the best 20 combinations and "
      + "stores the outcome with the results. Then make the report again:"),
    make("pre", {class: "citation", tabindex: "0"}, "aerocues reconstruct DATASET -o MODELS --from RESULTS --top 20")];
}

/** Settings that all models share.
 * @param {Models} models */
function howMade(models) {
  const words = Object.entries(models.made).map(([name, value]) => `${name.replaceAll("_", " ")} ${value}`);
  return [words.length ? `Same for all models: ${words.join("; ")}.` : "",
    models.reference ? `C2C: distance from each point to the nearest point of the model of ${models.reference}; reverse: from the reference to the model.` : ""].filter(Boolean).join(" ");
}
