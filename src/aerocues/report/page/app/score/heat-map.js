/* Detector x descriptor, one panel per norm and matcher. */

import {CIVIDIS, isBrightOnScale, onCividis} from "../basis/colours.js";
import {makeSvg, withTips} from "../basis/elements.js";
import {CODES, measureNamed} from "../basis/entries.js";
import {isKnown, percent, valueText} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {spanOf} from "../basis/statistics.js";
import {measureOptions} from "../shell/controls.js";
import {FONT, widestText} from "../shell/figure-layout.js";

/** @typedef {{measure: Measure, panels: [norm: string, matcher: string][], bounds: Span, detectors: string[],
 *   descriptors: string[], columns: number, at: Map<string, number>}} Heat  `at` has the positions of combinations. */
/** @typedef {ReturnType<typeof heatSize>} HeatSize */
/** @typedef {{x: number, y: number, width: number, height: number}} Box */

/** @type {FigureSpec} */
export const HEAT_MAP = {
  id: "heat", title: "Detector and descriptor", wide: true,
  read: "One panel per norm and matcher; brighter is better. Hatched cells cannot run or are meaningless (hover "
    + "for the reason). Empty cells were not measured or do not match the filter.",
  controls: [{name: "value", label: "Value", options: measureOptions, fallback: () => "score"}],
  draw(context) {
    const {entry, narrow, shown: rows, width} = context;
    const measure = measureNamed(entry, context.option("value"));
    const known = rows.map(a => measure.values[a]).filter(isKnown);
    if (!known.length) return {empty: `None of these combinations has a value for ${measure.label}.`};
    const panels = heatPanels(entry, rows);
    /** @type {Heat} */
    const heat = {
      measure, panels, bounds: spanOf(known), detectors: inOrder(entry.detector, rows),
      descriptors: inOrder(entry.descriptor, rows), columns: narrow || panels.length === 1 ? 1 : 2,
      at: new Map(rows.map(a => [entry.combinations[a], a])),
    };
    const size = heatSize(heat, width, narrow);
    return {svg: () => heatDrawing(context, heat, size), height: size.height,
      table: heatTable(context, heat), summary: heatSummary(entry, rows, measure)};
  },
};

/** @param {string[]} methods @param {number[]} rows */
function inOrder(methods, rows) {
  const present = new Set(rows.map(a => methods[a]));
  return [...new Set(methods)].filter(name => present.has(name));
}

/** @param {Entry} entry @param {number[]} rows @returns {[norm: string, matcher: string][]} */
function heatPanels(entry, rows) {
  const keys = [...new Set(rows.map(a => JSON.stringify([entry.norm[a], entry.matcher[a]])))];
  return keys.map(key => JSON.parse(key)).sort((a, b) => b[0].localeCompare(a[0]) || a[1].localeCompare(b[1]));
}

const HEAT_LABEL = 11;

/** Sizes in pixels of a cell, of the labels and of a panel with its title and labels.
 * @param {Heat} heat @param {number} width @param {boolean} narrow */
function heatSize({detectors, descriptors, panels, columns}, width, narrow) {
  const left = widestText(detectors, HEAT_LABEL) + 8;
  const below = Math.ceil(widestText(descriptors, HEAT_LABEL) * 0.85) + 14;
  const panelWidth = Math.floor((width - (columns - 1) * 24) / columns);
  const cell = {width: Math.min(64, (panelWidth - left) / descriptors.length), height: narrow ? 18 : 23};
  const panelHeight = 24 + detectors.length * cell.height + below;
  const top = 48;
  return {width, left, top, cell, panelWidth, panelHeight, titled: 24,
    height: top + Math.ceil(panels.length / columns) * panelHeight};
}

/** @param {Heat} heat @param {number} value */
function heatShare({measure, bounds: [low, high]}, value) {
  const share = (value - low) / (high - low);
  return measure.better === "lower" ? 1 - share : share;
}

/** @param {FigureContext} context @param {Heat} heat @param {HeatSize} size */
function heatDrawing(context, heat, size) {
  const {colours} = context;
  const svg = makeSvg("svg", {class: "main-svg", width: size.width, height: size.height,
    viewBox: `0 0 ${size.width} ${size.height}`, "font-family": FONT, "font-size": HEAT_LABEL, fill: colours.ink},
  makeSvg("defs", {},
    makeSvg("pattern", {id: "hatch", width: 7, height: 7, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)"},
      makeSvg("line", {y2: 7, stroke: colours.hatch, "stroke-width": 2})),
    makeSvg("linearGradient", {id: "scale"}, CIVIDIS.map((_, i) => makeSvg("stop", {
      offset: i / (CIVIDIS.length - 1), "stop-color": onCividis(i / (CIVIDIS.length - 1))})))),
  makeSvg("rect", {width: size.width, height: size.height, fill: colours.surface}),
  scaleBar(heat, size, colours),
  heat.panels.map((panel, i) => heatPanel(context, heat, size, panel, i)));
  return withTips(svg);
}

/** The colour scale with the values at its ends and middle; the better end is on the right.
 * @param {Heat} heat @param {HeatSize} size @param {Colours} colours */
function scaleBar({measure, bounds: [low, high]}, {width}, colours) {
  const wide = Math.min(320, width - 60);
  const left = (width - wide) / 2;
  const ends = measure.better === "lower" ? [high, (low + high) / 2, low] : [low, (low + high) / 2, high];
  return makeSvg("g", {},
    makeSvg("text", {x: width / 2, y: 12, "text-anchor": "middle", "font-weight": 600}, measure.label),
    makeSvg("rect", {x: left, y: 17, width: wide, height: 9, fill: "url(#scale)"}),
    ends.map((value, i) => makeSvg("text", {x: left + wide * i / 2, y: 38, "text-anchor": "middle", fill: colours.muted},
      valueText(measure.key, value))));
}

/** @param {FigureContext} context @param {Heat} heat @param {HeatSize} size @param {[string, string]} methods @param {number} i */
function heatPanel(context, heat, size, [norm, matcher], i) {
  const {detectors, descriptors, columns} = heat;
  const {cell, left, titled} = size;
  const x = (i % columns) * (size.panelWidth + 24);
  const y = size.top + Math.floor(i / columns) * size.panelHeight;
  const foot = titled + detectors.length * cell.height;
  return makeSvg("g", {transform: `translate(${x} ${y})`},
    makeSvg("text", {x: left, y: 15, "font-weight": 650, "font-size": 12.5}, `${norm}, ${matcher}`),
    detectors.map((detector, line) => makeSvg("text", {x: left - 6, y: titled + (line + 0.5) * cell.height + 4,
      "text-anchor": "end"}, detector)),
    descriptors.map((descriptor, column) => makeSvg("text", {"text-anchor": "end",
      transform: `translate(${left + (column + 0.5) * cell.width + 4} ${foot + 10}) rotate(-55)`}, descriptor)),
    detectors.flatMap((detector, line) => descriptors.map((descriptor, column) => heatCell(context, heat,
      [detector, descriptor, norm, matcher].join("-"),
      {x: left + column * cell.width, y: titled + line * cell.height, ...cell}))));
}

/** @param {FigureContext} context @param {Heat} heat @param {string} name @param {Box} place */
function heatCell({entry, colours}, heat, name, {x, y, width, height}) {
  const box = {x: x + 0.5, y: y + 0.5, width: width - 1, height: height - 1};
  const a = heat.at.get(name);
  if (a === undefined) {
    const reason = Object.hasOwn(payload.incompatible, name) ? payload.incompatible[name] : null;
    return reason ? makeSvg("rect", {...box, fill: "url(#hatch)", opacity: 0.7, "data-tip": `${name}\nexcluded: ${reason}`}) : [];
  }
  const value = heat.measure.values[a];
  const tip = heatTip(entry, heat.measure, a);
  if (!isKnown(value)) return makeSvg("rect", {...box, fill: "none", stroke: colours.grid, "data-tip": tip});
  const share = heatShare(heat, value);
  const rect = makeSvg("rect", {...box, fill: onCividis(share), "data-tip": tip, "data-combination": name, cursor: "pointer"});
  if (width < 24) return rect;
  return [rect, makeSvg("text", {x: x + width / 2, y: y + height / 2 + 3.5, "text-anchor": "middle", "font-size": 10,
    fill: isBrightOnScale(share) ? "#000000" : "#ffffff", "pointer-events": "none"}, cellText(value))];
}

/** @param {Entry} entry @param {Measure} measure @param {number} a */
function heatTip(entry, measure, a) {
  const rank = isKnown(entry.score.rank[a]) ? `\nrank ${entry.score.rank[a]}` : "";
  return `${entry.combinations[a]}\n${measure.label}: ${valueText(measure.key, measure.values[a])}${rank}`
    + `\nsuccess: ${percent(entry.score.success_rate[a])} of the pairs`;
}

/** At most four characters.
 * @param {number} value */
function cellText(value) {
  if (value >= 10000) return `${Math.round(value / 1000)}k`;
  if (value >= 1000) return `${(value / 1000).toFixed(1)}k`;
  if (value >= 10) return String(Math.round(value));
  return value >= 1 ? value.toFixed(1) : value.toFixed(2).replace(/^0/, "");
}

/** @param {FigureContext} context @param {Heat} heat @returns {Table} */
function heatTable({entry, shown: rows}, {measure}) {
  return [[...CODES, measure.key], rows.filter(a => isKnown(measure.values[a]))
    .map(a => [...CODES.map(code => entry[code][a]), measure.values[a]])];
}

/** @param {Entry} entry @param {number[]} rows @param {Measure} measure */
function heatSummary(entry, rows, measure) {
  const known = rows.filter(a => isKnown(measure.values[a]));
  const good = (/** @type {number} */ a) => (measure.better === "lower" ? -1 : 1) * Number(measure.values[a]);
  const best = known.reduce((a, b) => (good(b) > good(a) ? b : a));
  return `Best by ${measure.label}: ${entry.combinations[best]}, ${valueText(measure.key, measure.values[best])}`;
}
