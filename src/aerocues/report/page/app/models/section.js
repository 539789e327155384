/* Section 7: 3D models: their figures, their clouds, and what the matches say of them. */

import {make} from "../basis/elements.js";
import {currentEntry} from "../basis/state.js";
import {cloudsOf} from "./cloud-view.js";
import {buildClouds, refreshClouds} from "./clouds.js";
import {CLOUD_DISTANCES, OUTCOME_MATRIX, OUTCOME_SCATTER} from "./model-figures.js";
import {MODELS, modelsOf} from "./models-table.js";
import {addColumnTable, updateColumnTable} from "../shell/column-table.js";
import {addFigure} from "../shell/figure.js";

const modelParts = {};

export const MODELS_SECTION = {
  id: "models",
  title: "3D",
  read: "The scene as each combination reconstructs it, with COLMAP: what became of the models, how they look, how far "
    + "they are from each other, and whether good matches make good models.",
  build(body) {
    modelParts.hint = make("div", {class: "figure wide", id: "no-models"}, ...howToReconstruct());
    modelParts.frame = make("div", {class: "figure wide", id: "modelled"});
    modelParts.table = addColumnTable(modelParts.frame, MODELS);
    modelParts.made = modelParts.frame.appendChild(make("p", {class: "note"}));
    modelParts.clouds = make("div", {class: "figure wide", id: "clouds"});
    buildClouds(modelParts.clouds);
    body.append(modelParts.hint, modelParts.frame, modelParts.clouds);
    modelParts.figures = [CLOUD_DISTANCES, OUTCOME_SCATTER, OUTCOME_MATRIX].map(spec => addFigure(body, spec));
  },
  update(body, changed) {
    const entry = currentEntry();
    const models = modelsOf(entry);
    modelParts.hint.hidden = models !== null;
    modelParts.frame.hidden = models === null;
    modelParts.clouds.hidden = !cloudsOf(entry).length;
    for (const figure of modelParts.figures) figure.element.hidden = models === null;
    if (!models) return;
    if ([...changed].some(key => !key.includes(".") || key.startsWith("models."))) {
      updateColumnTable(modelParts.table, changed);
      modelParts.made.textContent = howMade(models);
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

/* What is the same for all models. */
function howMade({made, reference}) {
  const words = Object.entries(made ?? {}).map(([name, value]) => `${name.replaceAll("_", " ")} ${value}`);
  return [words.length ? `The same for all: ${words.join("; ")}.` : "",
    reference ? `C2C: distances of points to the nearest point of the model of ${reference}, and back.` : ""].filter(Boolean).join(" ");
}
