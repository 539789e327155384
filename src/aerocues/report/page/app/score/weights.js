/* The weights of the criteria by each method. */

import {seriesStyle, SYMBOLS} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {labelOf, listed, percent} from "../basis/numbers.js";
import {categoryAxis, heightOfRows} from "../shell/axes.js";

/** @type {FigureSpec} */
export const WEIGHTS = {
  id: "weights", title: "Weights of the criteria", ignoresFilter: true,
  read: "The weights come from the data: a criterion that separates the combinations well gets a larger weight. Dots are "
    + "the weighting methods; the bar is their aggregate, which is used for the score.",
  available: entry => (entry.score.weights.methods.length ? true : "No weights were computed."),
  draw({entry, colours, theme}) {
    const {methods, values} = entry.score.weights;
    const criteria = entry.score.criteria.map(each => safe(labelOf(each.name)));
    const aggregate = methods[methods.length - 1];
    const traces = methods.slice(0, -1).map((method, i) => ({
      type: "scatter", mode: "markers", name: safe(methodLabel(method)), x: values[method], y: criteria,
      marker: {color: seriesStyle(theme, i).color, symbol: SYMBOLS[i % SYMBOLS.length], size: 8,
        line: {width: 1, color: colours.surface}},
      hovertemplate: "%{y}<br>%{x:.3f}<extra>%{fullData.name}</extra>",
    }));
    const bar = {type: "bar", orientation: "h", name: "aggregate", x: values[aggregate], y: criteria, width: 0.62,
      marker: {color: colours.faint}, hovertemplate: "%{y}<br>%{x:.3f}<extra>aggregate</extra>"};
    return {
      data: [bar, ...traces], height: heightOfRows(criteria.length * 1.4, 100),
      layout: {xaxis: {title: "weight", rangemode: "tozero"}, yaxis: categoryAxis(criteria), hovermode: "closest"},
      note: [countsNote(entry), entry.score.criteria.some(each => each.reconstruction)
        ? "Some criteria describe the 3D reconstruction, with one value per combination." : ""].filter(Boolean).join(" ") || null,
    };
  },
};

const MOST_FOR_COUNTS = 0.5;

/** A warning where counts have most of the weight: they reward many matches, right or wrong.
 * @param {Entry} entry */
export function countsNote({score}) {
  const {methods, values} = score.weights;
  const aggregate = values[methods[methods.length - 1]] ?? [];
  const counts = score.criteria.map((each, i) => ({...each, weight: Number(aggregate[i] ?? 0)})).filter(each => each.aspect === "quantity");
  const total = counts.reduce((sum, each) => sum + each.weight, 0);
  if (total <= MOST_FOR_COUNTS) return "";
  return `Counts have ${percent(total)} of the weight (${listed(counts.map(each => labelOf(each.name)))}): this ranking favours many matches over right ones.`;
}

/** @type {Record<string, string>} */
const WEIGHT_METHODS = {pca: "PCA", critic: "CRITIC", critic_published: "CRITIC, as published"};

/** @param {string} name */
function methodLabel(name) {
  return WEIGHT_METHODS[name] ?? name.replaceAll("_", " ");
}
