/* Figures: drawn when they come into view, redrawn when the state changes, saved on request. */

import {isPrinting, themeName, THEMES} from "../basis/colours.js";
import {fileStem, saveCsv, saveFile} from "../basis/downloads.js";
import {announce, make, safe, unsafe} from "../basis/elements.js";
import {CODES} from "../basis/entries.js";
import {shownIn} from "../basis/filter.js";
import {LIMITS} from "../basis/limits.js";
import {isKnown} from "../basis/numbers.js";
import {bytesOf} from "../basis/payload.js";
import {currentEntry, state} from "../basis/state.js";
import {explained} from "../basis/words.js";
import {selectControl} from "./controls.js";
import {fullLayout} from "./figure-layout.js";

/** @type {Figure[]} */
export const figures = [];
const NARROW = 480;
/* Two figures with their words fit on a page; rows with names keep room for these. */
const PRINTED_HEIGHT = 340;
const PRINTED_SHARE = 0.7;
const NOT_YET = "This figure is not drawn yet: its program is still being unpacked.";
const CONFIG = {displayModeBar: false, responsive: false, doubleClick: "reset+autosize"};

/** @param {HTMLElement} parent @param {FigureSpec} spec */
export function addFigure(parent, spec) {
  const plot = make("div", {class: "plot", role: spec.isOperated ? "group" : "img", "aria-label": spec.title});
  const note = make("p", {class: "note", hidden: true});
  const {controls: specs = [], ...rest} = spec;
  const controls = specs.map(control => selectControl(spec.id, control));
  const save = (/** @type {string} */ format) => make("button", {
    type: "button", class: "quiet", "aria-label": `Save “${spec.title}” as ${format}`,
    onclick: () => saveFigure(figure, format),
  }, format);
  const element = make("figure", {class: `figure ${spec.wide ? "wide" : ""} ${spec.tall ? "tall" : ""}`, id: `figure-${spec.id}`},
    make("figcaption", {},
      make("h3", {}, spec.title),
      make("p", {class: "read"}, explained(spec.read))),
    make("div", {class: "controls"}, controls.map(control => control.element),
      make("span", {class: "save"}, ["SVG", "PNG", "CSV"].map(save))),
    plot, note);
  /** @type {Figure} */
  const figure = {
    ...rest, element, plot, noteElement: note, stale: true, waits: false, near: false, width: 0,
    controls: Object.fromEntries(controls.map((control, i) => [specs[i].name, control])),
  };
  parent.append(element);
  figures.push(figure);
  whenNear.observe(element);
  onResize.observe(element);
  return figure;
}

/** @param {Figure} figure @param {number} width @param {Theme} theme @returns {FigureContext} */
function figureContext(figure, width, theme) {
  const entry = currentEntry();
  return {
    entry, width, theme, narrow: width < NARROW, colours: THEMES[theme], shown: shownIn(entry),
    option: name => figure.controls[name].value(),
  };
}

/** @param {Figure} figure @param {FigureContext} context @returns {Drawn} */
function describeFigure(figure, context) {
  const reason = figure.available?.(context.entry) ?? true;
  if (reason !== true) return {empty: reason};
  if (!context.shown.length && !figure.ignoresFilter && !figure.acrossEntries) return {empty: "No combination matches the filter."};
  return figure.draw(context);
}

/** @param {Figure} figure */
export function drawFigure(figure) {
  const width = Math.floor(figure.plot.clientWidth);
  if (!width) return;
  Object.assign(figure, {stale: false, width});
  for (const control of Object.values(figure.controls)) control.refresh();
  const context = figureContext(figure, width, themeName());
  const wanted = describeFigure(figure, context);
  const lacks = wanted.empty === undefined && !wanted.svg && !window.Plotly;
  figure.waits = lacks && withoutPlotly === null;
  if (figure.waits && !isPrinting()) return;
  const drawn = lacks ? {empty: withoutPlotly ?? NOT_YET} : wanted;
  figure.element.classList.toggle("empty", Boolean(drawn.empty));
  showNote(figure, drawn);
  if (drawn.empty !== undefined) {
    if (figure.plot.classList.contains("js-plotly-plot")) Plotly.purge(figure.plot);
    figure.plot.replaceChildren(make("p", {class: "nothing"}, drawn.empty));
    figure.plot.style.height = "auto";
    return;
  }
  if (drawn.svg) {
    figure.plot.style.height = `${drawn.height}px`;
    figure.plot.replaceChildren(drawn.svg());
    return;
  }
  const isNew = !figure.plot.classList.contains("js-plotly-plot");
  if (isNew) figure.plot.replaceChildren();
  const height = isPrinting() ? printedHeight(drawn) : drawn.height;
  figure.plot.style.height = `${height}px`;
  const data = [...drawn.data, ...ringsAround(drawn.data, state.get("decide.pick"), context.colours)];
  Plotly.react(figure.plot, data, fullLayout({...drawn, height}, context), CONFIG);
  if (isNew) listenToClicks(figure.plot);
}

/** Who is told the name at a point that was clicked.
 * @type {(name: string) => void} */
let tellChosen = () => {};

/** @param {(name: string) => void} tell */
export function onChosen(tell) {
  tellChosen = tell;
}

/** @param {HTMLElement} plot */
function listenToClicks(plot) {
  /** @type {PlotlyElement} */ (plot).on("plotly_click", ({points: [point]}) => tellChosen(unsafe(nameAt(point.data, point.pointIndex))));
}

/** The combination that a point stands for, if it stands for one.
 * @param {Trace} trace @param {number} i @returns {string} */
function nameAt(trace, i) {
  return String(trace.ids?.[i] ?? trace.y?.[i] ?? "");
}

/** Rings around the points of the combination that was chosen, in every figure.
 * @param {Trace[]} traces @param {string} chosen @param {Colours} colours @returns {Trace[]} */
function ringsAround(traces, chosen, colours) {
  if (!chosen) return [];
  const name = safe(chosen);
  const dots = traces.filter(trace => trace.type === "scatter" && String(trace.mode).includes("markers"));
  const found = dots.flatMap(trace => [...(trace.y ?? [])].flatMap((y, i) => (nameAt(trace, i) === name ? [{x: trace.x[i], y}] : [])));
  if (!found.length) return [];
  return [{type: "scatter", mode: "markers", name: "not in the table", showlegend: false, hoverinfo: "skip", x: found.map(each => each.x),
    y: found.map(each => each.y), marker: {symbol: "circle-open", size: 17, color: colours.ink, line: {width: 2.5, color: colours.ink}}}];
}

/** @param {PlotDrawn} drawn */
function printedHeight({height, layout}) {
  return layout.yaxis?.type === "category" ? PRINTED_SHARE * height : Math.min(height, PRINTED_HEIGHT);
}

/** @param {Figure} figure @param {Drawn} drawn */
function showNote(figure, drawn) {
  figure.noteElement.hidden = !drawn.note;
  figure.noteElement.textContent = drawn.note ?? "";
  figure.plot.setAttribute("aria-label", [figure.title, drawn.summary ?? drawn.note ?? drawn.empty]
    .filter(Boolean).join(". "));
}

/** Saved figures use the light theme.
 * @param {Figure} figure @param {string} format */
async function saveFigure(figure, format) {
  const width = Math.max(figure.width || 0, 900);
  const context = figureContext(figure, width, "light");
  const drawn = describeFigure(figure, context);
  if (drawn.empty !== undefined) return announce(drawn.empty);
  const stem = fileStem(context.entry.name, figure.title);
  if (format === "CSV") return saveCsv(stem, ...(drawn.svg ? drawn.table : tableOfTraces(drawn.data)));
  if (drawn.svg) return saveDrawing(drawn.svg(), stem, format);
  if (!window.Plotly) return announce(withoutPlotly ?? NOT_YET);
  const layout = fullLayout(drawn, context);
  const kind = format.toLowerCase();
  const url = await Plotly.toImage({data: drawn.data, layout, config: CONFIG},
    {format: kind, width, height: drawn.height, scale: kind === "png" ? 2 : 1});
  const content = kind === "svg"
    ? decodeURIComponent(url.slice(url.indexOf(",") + 1))
    : new Blob([bytesOf(url.slice(url.indexOf(",") + 1))], {type: "image/png"});
  return saveFile(`${stem}.${kind}`, content, "image/svg+xml");
}

/** @param {SVGSVGElement} svg @param {string} stem @param {string} format */
async function saveDrawing(svg, stem, format) {
  const text = new XMLSerializer().serializeToString(svg);
  if (format === "SVG") return saveFile(`${stem}.svg`, text, "image/svg+xml");
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = make("canvas", {width: 2 * image.width, height: 2 * image.height});
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas.toBlob(blob => saveFile(`${stem}.png`, blob, "image/png"));
}

/** The points of a figure as a table.
 * @param {Trace[]} traces @returns {Table} */
function tableOfTraces(traces) {
  const plain = (/** @type {unknown} */ value) => (typeof value === "string" ? unsafe(value) : value);
  /** @type {unknown[][]} */
  const rows = [];
  for (const trace of traces.filter(each => each.name !== "not in the table")) {
    const label = plain(trace.name ?? "");
    if (trace.z) {
      /** @type {Matrix} */ (trace.z).forEach((row, i) => row.forEach((value, j) => {
        if (isKnown(value)) rows.push([label, plain(trace.x[j]), plain(trace.y[i]), value]);
      }));
      continue;
    }
    (trace.y ?? trace.x).forEach((/** @type {unknown} */ _, /** @type {number} */ i) => {
      rows.push([label, plain(trace.x[i]), plain(trace.y[i]), plain(trace.ids?.[i] ?? "")]);
    });
  }
  return [["series", "x", "y", "value_or_name"], rows];
}

/** Marks figures as out of date and draws those near the window, one per frame, visible ones first.
 * @param {Set<string>} changed */
export function refreshFigures(changed) {
  for (const figure of figures) {
    if ([...changed].some(key => concerns(key, figure))) figure.stale = true;
  }
  drawStale();
}

const OF_THE_TABLE = ["sort", "columns", "rows"];

/** Whether a figure depends on a key of the state.
 * @param {string} key @param {Figure} figure */
function concerns(key, figure) {
  if (OF_THE_TABLE.includes(key)) return false;
  if (key === "decide.pick") return true;
  if (key.startsWith("decide.")) return Boolean(figure.showsAnswer);
  if (key === "q" || LIMITS.includes(key) || CODES.some(code => code === key)) return !figure.ignoresFilter;
  return !key.includes(".") || key.startsWith(`${figure.id}.`);
}

/** Why there is no Plotly, once that is known.
 * @type {string | null} */
let withoutPlotly = null;

/** Draws the figures that waited for Plotly; without it, says why they stay empty.
 * @param {string | null} [reason] */
export function drawWaiting(reason = null) {
  withoutPlotly = reason;
  for (const figure of figures.filter(each => each.waits)) Object.assign(figure, {stale: true, waits: false});
  drawStale();
}

let drawing = false;

export function drawStale() {
  if (drawing) return;
  const waiting = figures.filter(figure => figure.stale && figure.near && figure.plot.clientWidth);
  if (!waiting.length) return;
  const next = waiting.find(isInWindow) ?? waiting[0];
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    drawFigure(next);
    drawStale();
  });
}

/** @param {Figure} figure */
function isInWindow({plot}) {
  const {top, bottom} = plot.getBoundingClientRect();
  return bottom > 0 && top < window.innerHeight;
}

const whenNear = new IntersectionObserver(seen => {
  for (const {target, isIntersecting} of seen) {
    const figure = figures.find(each => each.element === target);
    if (figure) figure.near = isIntersecting;
  }
  drawStale();
}, {rootMargin: "0px 0px 400px"});

const onResize = new ResizeObserver(seen => {
  for (const {target} of seen) {
    const figure = figures.find(each => each.element === target);
    if (figure?.width && figure.plot.clientWidth && figure.plot.clientWidth !== figure.width) figure.stale = true;
  }
  drawStale();
});
