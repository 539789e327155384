/* Matrices of correlations. */

import {cellTexts, DIVERGING, isBrightOnDiverging, isBrightOnScale, SCALE} from "../basis/colours.js";
import {safe} from "../basis/elements.js";
import {isKnown} from "../basis/numbers.js";
import {categoryAxis} from "./axes.js";

/** A matrix of correlations with its numbers in the cells.
 * @param {{x: string[], y: string[], z: Matrix, theme: Theme, narrow: boolean, what: string, low?: number}} matrix
 * @returns {PlotDrawn} */
export function matrixFigure({x, y, z, theme, narrow, what, low = -1}) {
  const numbered = narrow && x.length > 4 && x.length === y.length;
  const labels = numbered
    ? {x: x.map((_, i) => `${i + 1} `), y: y.map((name, i) => `${safe(name)} ${i + 1}`)}
    : {x: x.map(safe), y: y.map(safe)};
  const roomy = x.length <= (narrow ? 6 : 12);
  const size = narrow || x.length > 6 ? 9 : 10.5;
  return {
    data: [{
      type: "heatmap", name: what, ...labels, z, zmin: low, zmax: 1, xgap: 1, ygap: 1, hoverongaps: false,
      colorscale: low < 0 ? DIVERGING[theme] : SCALE,
      colorbar: {thickness: 10, outlinewidth: 0, len: 0.8, tickfont: {size: 10}},
      hovertemplate: "%{y}<br>%{x}<br>%{z:.3f}<extra></extra>",
    }, ...(roomy ? cellTexts({...labels, z, texts: z.map(row => row.map(correlationText)), size,
      isBright: value => (low < 0 ? isBrightOnDiverging(theme, value) : isBrightOnScale((value - low) / (1 - low)))}) : [])],
    height: y.length * (y.length > 6 ? 26 : 38) + (numbered ? 60 : (y.length > 6 ? 150 : 100)),
    layout: {xaxis: {...categoryAxis(labels.x), autorange: true, tickangle: !numbered && x.some(each => each.length > 8) ? -40 : 0, tickfont: {size: narrow ? 9 : 10.5}},
      yaxis: {...categoryAxis(labels.y), tickfont: {size: narrow ? 9 : 10.5}}},
  };
}

/** As short as possible: ".92".
 * @param {Value} value */
function correlationText(value) {
  return isKnown(value) ? value.toFixed(2).replace(/^(-?)0\./, "$1.").replace("1.00", "1") : "";
}

/** @param {Matrix} matrix */
export function lowestOf(matrix) {
  const known = matrix.flat().filter(isKnown);
  return known.length ? Math.min(...known) : 0;
}

/** Correlations of rankings are rarely negative: the colours start at the lowest value.
 * @param {Matrix} matrix */
export function lowEnd(matrix) {
  const low = lowestOf(matrix);
  return low < 0 ? -1 : Math.min(0.9, Math.floor(low * 10) / 10);
}
