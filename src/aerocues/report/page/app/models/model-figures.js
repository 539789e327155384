/* Figures of the models: distances between clouds, and correlations with measurements of pairs. */

import {seriesStyle, THEMES} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {CODES} from "../basis/entries.js";
import {currentFilter} from "../basis/filter.js";
import {counted, fixed, isKnown, labelOf, sentenceCase, span} from "../basis/numbers.js";
import {spearman} from "../basis/statistics.js";
import {modelColumn, modelsOf, shownModels} from "./models-table.js";
import {categoryAxis, logAxis} from "../shell/axes.js";
import {colourControl, scaleControl, topControl} from "../shell/controls.js";
import {matrixFigure} from "../shell/matrix.js";
import {scatterFrame} from "../shell/points.js";

const C2C_STATISTICS = [["median", "circle"], ["rms", "diamond"], ["p95", "line-ns-open"]];

/** @type {FigureSpec} */
export const CLOUD_DISTANCES = {
  id: "c2c", title: "Distances between clouds",
  read: "Distance from each point to the nearest point of the reference cloud, and in reverse (C2C, as in CloudCompare). Short distances to the "
    + "reference with long reverse distances mean that the points are correct but many are missing.",
  controls: [topControl([10, 20, 40], 20), scaleControl("log")],
  available: entry => (entry.models?.values.cloud_distance_rms ? true : "Distances between clouds were not measured."),
  draw({entry, option, theme, narrow}) {
    const models = modelsOf(entry);
    const known = shownModels(entry).filter(m => isKnown(models.values.cloud_distance_rms[m]) && models.combinations[m] !== models.reference);
    const rows = known.slice(0, Number(option("top")));
    if (!rows.length) return {empty: "None of these combinations has a distance to the reference."};
    const names = rows.map(m => safe(models.combinations[m]));
    const data = ["cloud", "reference"].flatMap((way, i) => C2C_STATISTICS.map(([statistic, symbol]) => ({
      type: "scatter", mode: "markers", y: names,
      name: `${way === "cloud" ? "to the reference" : "reverse"}, ${statistic === "p95" ? "95th percentile" : statistic === "rms" ? "RMS" : "median"}`,
      x: rows.map(m => models.values[`${way}_distance_${statistic}`][m]),
      marker: {symbol, size: 9, color: THEMES[theme].series[i], line: {color: THEMES[theme].series[i], width: 2}},
      hovertemplate: "%{y}<br>%{x:.3g}<extra>%{fullData.name}</extra>",
    })));
    const values = data.flatMap(trace => trace.x).filter(value => Number(value) > 0);
    return {
      data, height: 26 * rows.length + (narrow ? 190 : 130),
      layout: {
        xaxis: {title: modelLabelWithUnit(entry), ...(option("scale") === "log" ? logAxis(values) : {rangemode: "tozero"})},
        yaxis: {...categoryAxis(names), tickfont: {size: narrow ? 9 : 10.5}},
      },
      note: `To the cloud of ${models.reference}, ${counted(rows.length, "model")} of ${known.length}.`,
    };
  },
};

/** @param {Entry} entry */
function modelLabelWithUnit(entry) {
  const unit = modelColumn(entry, "cloud_distance_rms")?.unit;
  return `distance in ${unit === "m" ? "metres" : "units of the reference’s model"}`;
}

/** @param {Entry} entry @returns {true | string} */
function hasRelations(entry) {
  const found = entry.models?.relations;
  if (!found) return "This dataset has no models.";
  return found.unavailable ? sentenceCase(`${found.unavailable}.`) : true;
}

/** @type {ControlSpec} */
const MEASURE_OF_RELATION = {name: "measure", label: "Correlation", fallback: () => "spearman",
  options: () => [{key: "spearman", label: "Spearman’s (of ranks)"}, {key: "pearson", label: "Pearson’s (of values)"}]};

/** @type {FigureSpec} */
export const OUTCOME_MATRIX = {
  id: "outcomes", title: "Do good matches make good models?",
  read: "Correlation over the combinations between measurements of image pairs (rows) and properties of the models (columns). Quality and "
    + "registered images are correlated over all models, the other properties over successful ones: broken models have few points and a low error.",
  controls: [MEASURE_OF_RELATION], ignoresFilter: true, wide: true,
  available: hasRelations,
  draw({entry, option, theme, narrow}) {
    const found = relationsOf(entry);
    const spearmans = option("measure") === "spearman";
    const numbers = found.numbers.flat().filter(number => number >= found.fewest);
    return {
      ...matrixFigure({x: found.outcomes.map(labelOf), y: found.features.map(labelOf), z: spearmans ? found.spearman : found.pearson, theme, narrow,
        what: spearmans ? "Spearman" : "Pearson"}),
      note: `Over ${span(numbers)} combinations; the filter does not apply.`,
    };
  },
};

/** @type {FigureSpec} */
export const OUTCOME_SCATTER = {
  id: "outcome", title: "Measurements of pairs against models",
  read: "One dot per combination. Choose a measurement of pairs and a property of the models.",
  controls: [
    {name: "x", label: "Horizontal", options: entry => relationOptions(entry, "features"),
      fallback: entry => preferredOption(relationOptions(entry, "features"), ["links_x_expected_quality", "recall_beyond_chance", "recall", "inliers"])},
    {name: "y", label: "Vertical", options: entry => relationOptions(entry, "outcomes"),
      fallback: entry => preferredOption(relationOptions(entry, "outcomes"), ["model_quality", "points_3d"])},
    colourControl("detector"),
  ],
  available: hasRelations,
  draw: outcomePoints,
};

/** The relations of an entry of which `hasRelations` is true.
 * @param {Entry} entry @returns {Relations} */
function relationsOf(entry) {
  const {relations} = modelsOf(entry);
  if (relations.unavailable !== undefined) throw new Error(relations.unavailable);
  return relations;
}

/** @param {Entry} entry @param {"features" | "outcomes"} kind @returns {Option[]} */
function relationOptions(entry, kind) {
  return (entry.models?.relations[kind] ?? []).map(name => ({key: name, label: labelOf(name)}));
}

/** @param {Option[]} options @param {string[]} wanted */
function preferredOption(options, wanted) {
  const keys = options.map(({key}) => key);
  return wanted.find(key => keys.includes(key)) ?? keys[0];
}

/** @param {FigureContext} context @returns {Drawn} */
function outcomePoints({entry, option, theme, narrow}) {
  const models = modelsOf(entry);
  const {combinations, values, fewest} = relationsOf(entry);
  const [xName, yName] = [option("x"), option("y")];
  const passes = currentFilter();
  const found = combinations.flatMap((name, i) => {
    const m = models.combinations.indexOf(name);
    const [x, y] = [values[xName][i], values[yName][i]];
    return passes(name.split("-")) && isKnown(x) && isKnown(y) ? [{name, m, x, y}] : [];
  });
  if (!found.length) return {empty: "None of these combinations has both values."};
  const code = CODES.findIndex(each => each === option("colour"));
  const groups = [...new Set(found.map(({name}) => name.split("-")[code]))].sort();
  return {
    data: groups.map((group, i) => {
      const own = found.filter(({name}) => name.split("-")[code] === group);
      const {color, symbol} = seriesStyle(theme, i);
      return {type: "scatter", mode: "markers", name: safe(group), x: own.map(each => each.x), y: own.map(each => each.y), ids: own.map(each => each.name),
        text: own.map(({name, m}) => `${safe(name)}<br>${models.status[m].replaceAll("_", " ")}`), hovertemplate: "%{text}<br>%{x:.4g}, %{y:.4g}<extra></extra>",
        marker: {color, symbol, size: 8, opacity: 0.85}};
    }),
    height: narrow ? 440 : 460,
    layout: scatterFrame({title: labelOf(xName), nticks: narrow ? 5 : 8}, {title: labelOf(yName)}, narrow),
    note: found.length < fewest ? `${counted(found.length, "combination")}: too few for a correlation.`
      : `Spearman’s correlation over ${counted(found.length, "combination")}: ${fixed(spearman(found.map(each => each.x), found.map(each => each.y)), 2)}.`,
  };
}
