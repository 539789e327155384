/* The layout that all figures of Plotly share: colours, fonts, and margins without a second drawing. */

import {unsafe} from "../basis/elements.js";

const touched = window.matchMedia("(pointer: coarse)");

/** @param {PlotDrawn} drawn @param {FigureContext} context @returns {Layout} */
export function fullLayout({layout, height}, {width, narrow, colours}) {
  /** @type {Axis} */
  const axis = {
    gridcolor: colours.grid, linecolor: colours.line, zerolinecolor: colours.line, zeroline: false,
    tickcolor: colours.line, automargin: true,
  };
  /** @type {Layout} */
  const base = {
    width, height, autosize: false, paper_bgcolor: colours.surface, plot_bgcolor: colours.surface,
    font: {family: FONT, size: narrow ? 11 : 12, color: colours.ink},
    margin: {l: 8, r: narrow ? 8 : 16, t: 8, b: 8, pad: 2},
    hoverlabel: {bgcolor: colours.surface, bordercolor: colours.line,
      font: {color: colours.ink, size: 12}, align: "left"},
    dragmode: touched.matches ? false : "zoom",
    legend: {orientation: "h", x: 0, y: 1.02, xanchor: "left", yanchor: "bottom",
      font: {size: narrow ? 10.5 : 11.5}, itemsizing: "constant"},
    transition: {duration: 0},
  };
  /** @type {Layout} */
  const merged = {...base, ...layout};
  for (const part of ["margin", "legend", "font", "hoverlabel"]) {
    merged[part] = {...base[part], ...layout[part]};
  }
  for (const name of Object.keys(layout).filter(key => /^[xy]axis\d*$/.test(key))) {
    merged[name] = withAxis(axis, layout[name]);
  }
  return merged.yaxis2 ? merged : withKnownMargins(merged);
}

/** Computes the margins here, because Plotly would draw everything at least twice to find them.
 * @param {Layout} layout */
function withKnownMargins(layout) {
  const {xaxis, yaxis, margin} = layout;
  if (xaxis?.type !== "category" && xaxis?.automargin) {
    Object.assign(margin, {b: xaxis.title?.text ? 46 : 28});
    xaxis.automargin = false;
  }
  if (yaxis?.type === "category" && yaxis.automargin) {
    margin.l = widestText(yaxis.categoryarray.map(unsafe), yaxis.tickfont?.size ?? 12) + 10;
    yaxis.automargin = false;
  }
  return layout;
}

const ruler = /** @type {CanvasRenderingContext2D} */ (document.createElement("canvas").getContext("2d"));
export const FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif";

/** @param {string[]} texts @param {number} size */
export function widestText(texts, size) {
  ruler.font = `${size}px ${FONT}`;
  return Math.ceil(Math.max(0, ...texts.map(text => ruler.measureText(text).width)));
}

/** @param {Axis} axis @param {Axis} own @returns {Axis} */
function withAxis(axis, own) {
  const title = typeof own.title === "string" ? {text: own.title} : own.title;
  return {...axis, ...own, title};
}
