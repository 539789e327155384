/* Colours: first those of Okabe and Ito, which are distinct for every kind of colour vision, and cividis. */

import {isKnown} from "./numbers.js";
import {state} from "./state.js";

/** @type {Record<Theme, Colours>} */
export const THEMES = {
  light: {
    ink: "#1b2430", muted: "#5b6675", grid: "#e4e8ed", line: "#9aa5b1", surface: "#ffffff",
    series: ["#0072b2", "#d98a00", "#009e73", "#d55e00", "#5b5fc7", "#b8578f", "#3a9bd9",
      "#7a5c00", "#6b8e23", "#a3123f", "#4d4d4d", "#00868b", "#8e4ec6", "#e0629a"],
    faint: "#c9d1da", hatch: "#a3adb8",
  },
  dark: {
    ink: "#e6eaf0", muted: "#a4afbd", grid: "#2c3540", line: "#66717f", surface: "#171c23",
    series: ["#56b4e9", "#e69f00", "#2fc79a", "#ff8a4c", "#a3a6ff", "#e59ac4", "#f0e442",
      "#c9a26b", "#b5d33d", "#ff6b81", "#c0c6cf", "#3fd0d4", "#d08bff", "#ffd0b5"],
    faint: "#3f4a57", hatch: "#56616e",
  },
};
export const SYMBOLS = ["circle", "diamond", "square", "triangle-up"];
const OUTLINES = ["circle-open", "diamond-open", "square-open", "triangle-up-open"];
/** The symbols as outlines around 0, as large as those of Plotly with the size 8.
 * @type {Record<string, string>} */
const SYMBOL_PATHS = {
  circle: "M4,0A4,4 0 1,1 0,-4A4,4 0 0,1 4,0Z", diamond: "M5.2,0L0,5.2L-5.2,0L0,-5.2Z", square: "M4,4H-4V-4H4Z",
  "triangle-up": "M-4.6,2.6H4.6L0,-5.2Z",
  star: "M0,-12L2.8,-3.9L11.4,-3.7L4.5,1.5L7.1,9.7L0,4.8L-7.1,9.7L-4.5,1.5L-11.4,-3.7L-2.8,-3.9Z",
};
export const SCALE = "Cividis";
export const CIVIDIS = [[0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115], [138, 134, 120],
  [165, 156, 116], [195, 179, 105], [225, 204, 85], [254, 232, 56]];
/* From -1 over 0 to 1: blue, the colour of the surface, orange. */
export const DIVERGING = {
  light: [[0, "#0072b2"], [0.5, "#f7f7f5"], [1, "#d98a00"]],
  dark: [[0, "#56b4e9"], [0.5, "#20262e"], [1, "#e69f00"]],
};

export const darkWanted = window.matchMedia("(prefers-color-scheme: dark)");

export function isPrinting() {
  return document.documentElement.classList.contains("printing");
}

/** @returns {Theme} */
export function themeName() {
  if (isPrinting()) return "light";
  const chosen = state.get("theme");
  return chosen === "light" || chosen === "dark" ? chosen : (darkWanted.matches ? "dark" : "light");
}

export function applyTheme() {
  document.documentElement.dataset.theme = themeName();
}

/** The colour at a share from 0 to 1.
 * @param {number} share */
export function onCividis(share) {
  const place = Math.min(Math.max(share, 0), 1) * (CIVIDIS.length - 1);
  const [low, rest] = [Math.floor(place), place % 1];
  const high = Math.min(low + 1, CIVIDIS.length - 1);
  return `rgb(${CIVIDIS[low].map((value, i) => Math.round(value + rest * (CIVIDIS[high][i] - value))).join(" ")})`;
}

/** Whether a colour is bright enough for black text: on cividis from 0 to 1, on the diverging scale from -1 to 1.
 * @param {number} share */
export function isBrightOnScale(share) {
  return share > 0.47;
}

/** @param {Theme} theme @param {number} value */
export function isBrightOnDiverging(theme, value) {
  return theme === "dark" ? Math.abs(value) > 0.55 : value > -0.7;
}

/** Numbers in the cells of a heat map: black on bright cells, white on dark ones. `texts` are rows of rows.
 * @param {{x: string[], y: string[], z: Matrix, texts: string[][], isBright(value: number): boolean, size: number}} cells
 * @returns {Trace[]} */
export function cellTexts({x, y, z, texts, isBright, size}) {
  const noCells = () => ({x: /** @type {string[]} */ ([]), y: /** @type {string[]} */ ([]), text: /** @type {string[]} */ ([])});
  const [bright, dark] = [noCells(), noCells()];
  z.forEach((row, i) => row.forEach((value, j) => {
    if (!isKnown(value)) return;
    const group = isBright(value) ? bright : dark;
    group.x.push(x[j]);
    group.y.push(y[i]);
    group.text.push(texts[i][j]);
  }));
  return [bright, dark].map(group => ({type: "scatter", mode: "text", name: "not in the table", showlegend: false,
    ...group, hoverinfo: "skip", textfont: {size, color: group === bright ? "#000000" : "#ffffff"}}));
}

const SAME_SYMBOL = 7;

/** Colour and symbol of the n-th of a series: 14 colours, of which 7 share a symbol.
 * @param {Theme} theme @param {number} position */
export function seriesStyle(theme, position) {
  const colours = THEMES[theme].series;
  return {
    color: colours[position % colours.length],
    symbol: SYMBOLS[Math.floor(position / SAME_SYMBOL) % SYMBOLS.length],
    outline: OUTLINES[Math.floor(position / SAME_SYMBOL) % OUTLINES.length],
  };
}

/** @param {string} symbol */
export function symbolPath(symbol) {
  return SYMBOL_PATHS[symbol];
}
