/* Measures from the ground truth against measures from the inliers. */

import {firstColumn, meansWithFailures} from "../basis/entries.js";
import {isGroundTruth, isKnown, labelOf} from "../basis/numbers.js";
import {spearman, valuesAt} from "../basis/statistics.js";
import {scatterDraw} from "./scatter.js";
import {colourControl, columnOptions} from "../shell/controls.js";
import {matrixFigure} from "../shell/matrix.js";

/** @param {string} name */
function quantitiesOnly(name) {
  return !/seconds/.test(name);
}

/** @param {Entry} entry */
function truthColumns(entry) {
  return Object.keys(entry.columns).filter(isGroundTruth);
}

/** @param {Entry} entry */
function inlierColumns(entry) {
  return Object.keys(entry.columns).filter(name => !isGroundTruth(name) && quantitiesOnly(name));
}

/** @param {Entry} entry */
function hasTruth(entry) {
  return truthColumns(entry).length ? true : "These images have no ground truth.";
}

/** @type {FigureSpec} */
export const TRUTH = {
  id: "truth", title: "Ground truth against inliers",
  read: "Horizontal: a measure without ground truth. Vertical: the true value. On the dotted line both agree; far below it, "
    + "inliers are misleading. Failed pairs count as 0 in both.",
  controls: [
    {name: "x", label: "Horizontal", options: entry => columnOptions(entry, name => !isGroundTruth(name)),
      fallback: entry => firstColumn(entry, ["ref_precision@3", "precision_beyond_chance", "precision"])},
    {name: "y", label: "Vertical", options: entry => columnOptions(entry, isGroundTruth),
      fallback: entry => firstColumn(entry, ["gt_precision@3"])},
    colourControl("descriptor"),
  ],
  available: hasTruth,
  draw: context => scatterDraw({...context, option: name => (name === "points" ? "means" : context.option(name))},
    context.option("x"), context.option("y"), {log: false, band: sameLine, measure: measureWithFailures}),
};

/** @param {Entry} entry @param {string} key @returns {Measure} */
function measureWithFailures(entry, key) {
  return {key, label: labelOf(key), better: entry.columns[key].better, values: meansWithFailures(entry, key)};
}

/** Only where both are shares.
 * @type {import("./scatter.js").Band} */
function sameLine({colours}, drawn, x, y) {
  const largest = Math.max(...valuesAt(x.values, drawn), ...valuesAt(y.values, drawn));
  if (largest > 1) return [];
  return [{type: "scatter", mode: "lines", name: "not in the table", showlegend: false, x: [0, 1], y: [0, 1],
    hoverinfo: "skip", line: {color: colours.line, width: 1, dash: "dot"}}];
}

/** @type {FigureSpec} */
export const TRUTH_MATRIX = {
  id: "truthmatrix", title: "Which measures agree with the ground truth",
  read: "Spearman’s correlation over the combinations that match the filter. Near 1, a measure without ground truth ranks the "
    + "combinations as the ground truth does. The first rows are scores: CUES as on this page, and by each preset. Failed pairs count as 0.",
  available: hasTruth,
  draw({entry, shown: rows, theme, narrow}) {
    const [truths, others] = [truthColumns(entry), rankingMeasures(entry)];
    if (rows.length < 3) return {empty: "A correlation needs at least three combinations."};
    const z = others.map(({values}) => truths.map(truth => correlationOver(rows, values, meansWithFailures(entry, truth))));
    return matrixFigure({x: truths.map(labelOf), y: others.map(({label}) => label), z, theme, narrow, what: "Spearman"});
  },
};

/** What could rank combinations without ground truth: scores, then single measures.
 * @param {Entry} entry @returns {{label: string, values: Value[]}[]} */
function rankingMeasures(entry) {
  return [{label: "CUES", values: entry.score.score},
    ...Object.entries(entry.preset_scores).map(([name, values]) => ({label: `preset “${name}”`, values})),
    ...inlierColumns(entry).map(name => ({label: labelOf(name), values: meansWithFailures(entry, name)}))];
}

/** @param {number[]} rows @param {Value[]} x @param {Value[]} y */
function correlationOver(rows, x, y) {
  const both = rows.filter(a => isKnown(x[a]) && isKnown(y[a]));
  return spearman(valuesAt(x, both), valuesAt(y, both));
}
