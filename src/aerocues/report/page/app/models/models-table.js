/* The table of all reconstructions with their outcome; failed ones have a reason. */

import {make} from "../basis/elements.js";
import {CODES, remember} from "../basis/entries.js";
import {currentFilter} from "../basis/filter.js";
import {duration, isKnown, labelOf, NONE, sentenceCase, shown} from "../basis/numbers.js";

/** The models of an entry that has some.
 * @param {Entry} entry */
export function modelsOf(entry) {
  if (!entry.models) throw new Error(`${entry.name} has no models`);
  return entry.models;
}

/** @type {ColumnTableSpec} */
export const MODELS = {
  id: "reconstructions", title: "All reconstructions", prefix: "models.", natural: "place",
  columns: modelColumns, rows: shownModels,
  read: entry => `Sorted by success, then model quality${byTruth(entry)}. Do not judge by the reprojection error alone: broken models have the lowest. `
    + "A dot marks a success; values of failed reconstructions describe the incomplete model." + aboutBaseline(modelsOf(entry)),
  downFirst: (entry, {key}) => modelColumn(entry, key)?.better === "higher",
  isMarked: (entry, m) => modelsOf(entry).status[m] === "ok",
};

/** Which error the quality is by: model_quality.py takes the true one where poses are known.
 * @param {Entry} entry */
function byTruth(entry) {
  const {made, values} = modelsOf(entry);
  const error = made.truth !== "poses" ? "reprojection error" : (values.surface_error ? "distance from the true surface" : "distance of cameras from their true positions");
  return `: share of the images in place × √(points in 3 images / ${error})`;
}

/** @param {Models} models */
function aboutBaseline({baseline, combinations, status}) {
  if (!baseline) return "";
  return combinations[0] === baseline && status[0] === "ok" ? ` No combination beats COLMAP's default (${baseline}): take that.`
    : ` ${baseline} is COLMAP's default: its own SIFT and matcher, and a camera that it refines.`;
}

/** Positions `m` of the reconstructions that match the filter, the best first: their order in the data.
 * @param {Entry} entry */
export function shownModels(entry) {
  const models = modelsOf(entry);
  const passes = currentFilter();
  return models.combinations.map((_, m) => m).filter(m => passes(CODES.map(code => models[code][m])));
}

/** @param {Entry} entry @param {string} key */
export function modelColumn(entry, key) {
  return modelsOf(entry).columns.find(column => column.name === key) ?? null;
}

/** A value with its unit, unless the text already contains it.
 * @param {ModelColumn} column @param {Value} value */
function modelText({name, unit}, value) {
  if (/seconds/.test(name)) return duration(value);
  if (!isKnown(value)) return NONE;
  return ["px", "m", "degree"].includes(unit) ? `${shown(value)} ${unit === "degree" ? "°" : unit}` : shown(value);
}

/** @param {ModelColumn} column */
function modelLabel({name, unit}) {
  return unit === "model units" ? `${labelOf(name)}, model units` : labelOf(name);
}

const USUAL_OF_MODELS = ["registered_images", "points_3d", "points_in_3_images", "model_quality", "mean_track_length", "reprojection_error", "position_rmse",
  "cloud_distance_rms", "reconstruction_seconds"];

/** @param {Entry} entry @returns {Column[]} */
export function modelColumns(entry) {
  return remember(entry, "model columns", () => {
    const models = modelsOf(entry);
    const ranks = new Map(entry.combinations.map((name, a) => [name, entry.score.rank[a]]));
    const rank = (/** @type {number} */ m) => ranks.get(models.combinations[m]) ?? null;
    /** @type {Column} */
    const reason = {key: "message", label: "Reason", usual: true, kind: "reason", title: "Why it failed, or what is unusual",
      value: m => models.message[m], text: m => models.message[m] ?? ""};
    /** @type {Column[]} */
    const columns = [
      {key: "place", label: "Rank", number: true, usual: true, title: "By success, then model quality",
        value: m => m + 1, text: m => shown(m + 1)},
      {key: "combination", label: "Combination", usual: true, title: "Detector-descriptor-norm-matcher",
        value: m => models.combinations[m], text: m => models.combinations[m]},
      {key: "rank", label: "Rank by CUES", number: true, usual: models.combinations.some((_, m) => rank(m) !== null),
        title: "Rank in the table of all combinations", value: rank, text: m => shown(rank(m))},
      {key: "status", label: "Status", usual: true, title: "How the reconstruction ended",
        value: m => models.status[m], text: m => models.status[m],
        cell: m => make("span", {title: models.statuses[models.status[m]]}, models.status[m].replaceAll("_", " "))},
      ...models.columns.map(column => figureColumn(models, column)),
      ...(models.message.some(Boolean) ? [reason] : []),
    ];
    return columns;
  });
}

/** @param {Models} models @param {ModelColumn} column @returns {Column} */
function figureColumn(models, column) {
  const values = models.values[column.name];
  const images = models.values.images;
  const ofAll = (/** @type {number} */ m) => (column.name === "registered_images" && isKnown(values[m]) && isKnown(images?.[m])
    ? ` of ${shown(images[m])}` : "");
  return {key: column.name, label: sentenceCase(modelLabel(column)), number: true, usual: USUAL_OF_MODELS.includes(column.name),
    title: column.definition, value: m => values[m],
    text: m => modelText(column, values[m]) + ofAll(m)};
}
