/* Correlations of criteria, and of rankings under other settings. */

import {fixed, labelOf, listed} from "../basis/numbers.js";
import {lowEnd, lowestOf, matrixFigure} from "../shell/matrix.js";

/** @type {FigureSpec} */
export const CRITERIA_MATRIX = {
  id: "criteria", title: "Correlation of the criteria", ignoresFilter: true,
  read: "Pearson’s correlation of the normalised values (higher is better in all) over all combinations. Two criteria near 1 carry the same information "
    + "and count double; near -1, one improves at the cost of the other.",
  available: entry => (entry.validation.criteria_correlation.names.length ? true : "There are no criteria to correlate."),
  draw({entry, theme, narrow}) {
    const {names: criteria, correlation} = entry.validation.criteria_correlation;
    const labels = criteria.map(labelOf);
    return matrixFigure({x: labels, y: labels, z: correlation, theme, narrow, what: "Pearson"});
  },
};

/** @type {{key: "criterion_left_out" | "alpha" | "aggregation", label: string}[]} */
const VARIANTS = [
  {key: "criterion_left_out", label: "leave one criterion out"},
  {key: "alpha", label: "alpha"},
  {key: "aggregation", label: "aggregation of the weights"},
];

/** @type {FigureSpec} */
export const SENSITIVITY = {
  id: "sensitivity", title: "Sensitivity to the settings", ignoresFilter: true,
  read: "Spearman’s correlation between the rankings under different settings. Near 1, the setting hardly matters.",
  controls: [{name: "of", label: "Setting", fallback: () => "criterion_left_out",
    options: () => VARIANTS}],
  draw({entry, option, theme, narrow}) {
    const choice = VARIANTS.find(({key}) => key === option("of")) ?? VARIANTS[0];
    return variantsFigure(entry, entry.validation[choice.key], theme, narrow);
  },
};

/** @type {FigureSpec} */
export const AGREEMENT = {
  id: "agreement", title: "Other decision methods", ignoresFilter: true,
  read: "The same values and weights, ranked by other established methods. Near 1, the ranking does not depend on CUES.",
  draw({entry, theme, narrow}) {
    const found = entry.validation.agreement;
    return found.unavailable === undefined ? variantsFigure(entry, found, theme, narrow) : {empty: found.unavailable};
  },
};

/** @param {Entry} entry @param {Variants} found @param {Theme} theme @param {boolean} narrow @returns {PlotDrawn} */
function variantsFigure(entry, {names: variants, correlation, best}, theme, narrow) {
  const words = variants.map(variantLabel);
  const figure = matrixFigure({x: words, y: words, z: correlation, theme, narrow, what: "Spearman", low: lowEnd(correlation)});
  const winner = entry.combinations[entry.score.best];
  const others = [...new Set(best)].filter(name => name !== winner);
  const choices = (/** @type {string} */ name) => listed(words.filter((_, i) => best[i] === name));
  const note = others.length
    ? `Other winners: ${others.map(name => `${choices(name)}: ${name}`).join("; ")}.`
    : `${winner} is the best in all of them. The lowest correlation is ${fixed(lowestOf(correlation), 2)}.`;
  return {...figure, note};
}

/** @param {string} name */
function variantLabel(name) {
  return name.startsWith("without ") ? `without ${labelOf(name.slice(8))}` : name;
}
