/* Correlations of criteria and of rankings under other choices. */

import {fixed, labelOf, listed} from "../basis/numbers.js";
import {lowEnd, lowestOf, matrixFigure} from "../shell/matrix.js";

export const CRITERIA_MATRIX = {
  id: "criteria", title: "Correlation of the criteria", ignoresFilter: true,
  read: "Pearson’s, over all combinations, of the normalised values (more is better in all of them): two criteria near 1 say the same and count double; "
    + "near -1, one is paid for with the other.",
  available: entry => (entry.validation?.criteria_correlation ? true : "There is nothing to correlate."),
  draw({entry, theme, narrow}) {
    const {names: criteria, correlation} = entry.validation.criteria_correlation;
    const labels = criteria.map(labelOf);
    return matrixFigure({x: labels, y: labels, z: correlation, theme, narrow, what: "Pearson"});
  },
};

const VARIANTS = [
  {key: "criterion_left_out", label: "each criterion left out"},
  {key: "alpha", label: "alpha"},
  {key: "aggregation", label: "aggregation of the weights"},
];

export const SENSITIVITY = {
  id: "sensitivity", title: "Sensitivity to choices", ignoresFilter: true,
  read: "Spearman’s correlation of the whole ranking under other choices: near 1, the choice hardly matters.",
  controls: [{name: "of", label: "Choice of", fallback: () => "criterion_left_out",
    options: entry => VARIANTS.filter(({key}) => entry.validation?.[key]?.names)}],
  available: entry => (VARIANTS.some(({key}) => entry.validation?.[key]?.names) ? true : "There is nothing to vary."),
  draw({entry, option, theme, narrow}) {
    return variantsFigure(entry, entry.validation[option("of")], theme, narrow);
  },
};

export const AGREEMENT = {
  id: "agreement", title: "Other methods of decision", ignoresFilter: true,
  read: "The same values and weights ranked by methods that others use: near 1, the ranking does not hang on CUES.",
  available: entry => {
    const found = entry.validation?.agreement;
    return found?.names ? true : (found?.unavailable ?? "There is nothing to compare.");
  },
  draw({entry, theme, narrow}) {
    return variantsFigure(entry, entry.validation.agreement, theme, narrow);
  },
};

function variantsFigure(entry, {names: variants, correlation, best}, theme, narrow) {
  const words = variants.map(variantLabel);
  const figure = matrixFigure({x: words, y: words, z: correlation, theme, narrow, what: "Spearman", low: lowEnd(correlation)});
  const winners = Map.groupBy ? Map.groupBy(variants, (_, i) => best?.[i]) : new Map();
  const others = [...winners].filter(([name]) => name && name !== entry.combinations[entry.score.best]);
  const note = others.length
    ? `Another one comes first: ${others.map(([name, found]) => `${listed(found.map(variantLabel))}: ${name}`).join("; ")}.`
    : `${entry.combinations[entry.score.best] ?? "The same one"} is the best in all of them. Lowest correlation: ${fixed(lowestOf(correlation), 2)}.`;
  return {...figure, note};
}

function variantLabel(name) {
  return name.startsWith("without ") ? `without ${labelOf(name.slice(8))}` : name;
}
