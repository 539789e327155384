/* A scatter plot that is drawn without Plotly, which takes longer to start than the rest of the page. */

import {symbolPath} from "../basis/colours.js";
import {makeSvg, withTips} from "../basis/elements.js";
import {scaleOf} from "./drawn-axes.js";
import {FONT, widestText} from "./figure-layout.js";

const REACH = 20;
const LEAST_DRAG = 8;
const STILL = 4;
const touched = window.matchMedia("(pointer: coarse)");

/** @param {Scatter} scatter @returns {SVGSVGElement} */
export function scatterDrawing(scatter) {
  const {width, height, colours, zoomed} = scatter;
  const legend = legendOf(scatter);
  const box = boxOf(scatter, legend.height);
  const [rangeX, rangeY] = zoomed ?? [scatter.x.range, scatter.y.range];
  const x = scaleOf(rangeX, [box.left, box.right], 52, scatter.x.words);
  const y = scaleOf(rangeY, [box.bottom, box.top], 26, scatter.y.words);
  const spots = scatter.groups.flatMap(group => group.points.map(point => ({...point, style: group.style, px: x.at(point.x), py: y.at(point.y)})));
  const clip = `inside-${scatter.id}`;
  const frame = {x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top};
  const svg = makeSvg("svg", {class: "main-svg", width, height, viewBox: `0 0 ${width} ${height}`, "font-family": FONT, "font-size": 11, fill: colours.ink},
    makeSvg("defs", {}, makeSvg("clipPath", {id: clip}, makeSvg("rect", frame))),
    makeSvg("rect", {width, height, fill: colours.surface}),
    axesOf(scatter, box, x, y), legend.element,
    makeSvg("g", {"clip-path": `url(#${clip})`},
      makeSvg("polyline", {points: scatter.line.map(point => `${x.at(point.x)},${y.at(point.y)}`).join(" "), fill: "none", stroke: colours.line, "stroke-width": 1.5}),
      makeSvg("g", {class: "points"}, spots.map(({px, py, style, hollow}) => markOf(style, px, py, hollow))),
      scatter.marks.map(mark => marked(mark, x.at(mark.x), y.at(mark.y), colours))),
    scatter.labels.filter(label => isInside(box, x.at(label.x), y.at(label.y))).map(label => labelled(label, x.at(label.x), y.at(label.y), box, colours)));
  const near = (/** @type {MouseEvent} */ event) => nearestTo(svg, spots.filter(spot => isInside(box, spot.px, spot.py)), event);
  openByClicking(svg, event => { const spot = near(event); if (spot) scatter.open(spot.name); });
  svg.addEventListener("pointermove", event => { svg.style.cursor = near(event) ? "pointer" : "default"; });
  if (!touched.matches) {
    const show = (/** @type {AxisRange[] | null} */ ranges) => {
      scatter.keepZoom(ranges);
      svg.replaceWith(scatterDrawing({...scatter, zoomed: ranges}));
    };
    zoomByDragging(svg, box, colours, ([left, bottom], [right, top]) => show([
      {...rangeX, low: x.inverse(left), high: x.inverse(right)}, {...rangeY, low: y.inverse(bottom), high: y.inverse(top)}]));
    svg.addEventListener("dblclick", () => { if (zoomed) show(null); });
  }
  return withTips(svg, event => near(event)?.tip ?? "");
}

/** The part inside the axes. @param {Scatter} scatter @param {number} above @returns {PlotBox} */
function boxOf({width, height, narrow}, above) {
  return narrow ? {left: 54, right: width - 8, top: above + 8, bottom: height - 44}
    : {left: 62, right: width - 104, top: 8, bottom: height - 48};
}

/** @param {PlotBox} box @param {number} px @param {number} py */
function isInside({left, right, top, bottom}, px, py) {
  return px >= left && px <= right && py >= top && py <= bottom;
}

/** @param {Scatter} scatter @param {PlotBox} box @param {Scale} x @param {Scale} y */
function axesOf({x: across, y: up, colours}, {left, right, top, bottom}, x, y) {
  const title = {"text-anchor": "middle", "font-size": 12};
  return makeSvg("g", {},
    makeSvg("path", {d: `M${left},${top}V${bottom}H${right}`, fill: "none", stroke: colours.line}),
    x.ticks.map(tick => [makeSvg("line", {x1: tick.at, x2: tick.at, y1: top, y2: bottom, stroke: colours.grid}),
      makeSvg("text", {x: tick.at, y: bottom + 16, "text-anchor": "middle"}, tick.text)]),
    y.ticks.map(tick => [makeSvg("line", {x1: left, x2: right, y1: tick.at, y2: tick.at, stroke: colours.grid}),
      makeSvg("text", {x: left - 6, y: tick.at + 4, "text-anchor": "end"}, tick.text)]),
    makeSvg("text", {...title, x: (left + right) / 2, y: bottom + 36}, across.title),
    makeSvg("text", {...title, transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)`}, up.title));
}

/** @param {SeriesStyle} style @param {number} px @param {number} py @param {boolean} hollow */
function markOf({color, symbol}, px, py, hollow) {
  return makeSvg("path", {d: symbolPath(symbol), transform: `translate(${px.toFixed(1)} ${py.toFixed(1)})`,
    fill: hollow ? "none" : color, stroke: hollow ? color : "none", "stroke-width": 1.5, opacity: 0.85});
}

/** A star, or a ring around what was chosen.
 * @param {ScatterMark} mark @param {number} px @param {number} py @param {Colours} colours */
function marked({symbol}, px, py, {ink, surface}) {
  return symbol === "star"
    ? makeSvg("path", {d: symbolPath("star"), transform: `translate(${px} ${py})`, fill: ink, stroke: surface, "stroke-width": 1.5, "pointer-events": "none"})
    : makeSvg("circle", {cx: px, cy: py, r: 8.5, fill: "none", stroke: ink, "stroke-width": 2.5, "pointer-events": "none"});
}

/** A name at some distance from its point, moved so that the drawing does not cut it.
 * @param {ScatterLabel} label @param {number} px @param {number} py @param {PlotBox} box @param {Colours} colours */
function labelled({text, bold, dx, dy}, px, py, {left, right, top, bottom}, colours) {
  const size = bold ? 12 : 10;
  const half = (bold ? 1.08 : 1) * widestText([text], size) / 2 + 2;
  const cx = Math.min(Math.max(px + dx + Math.sign(dx) * (bold ? half : 0), left + half), right - half);
  const cy = Math.min(Math.max(py + dy, top + size), bottom - size / 2);
  return makeSvg("g", {"pointer-events": "none"},
    makeSvg("line", {x1: px, y1: py, x2: cx, y2: cy, stroke: bold ? colours.ink : colours.line}),
    bold ? makeSvg("rect", {x: cx - half, y: cy - 9, width: 2 * half, height: 17, fill: colours.surface}) : [],
    makeSvg("text", {x: cx, y: cy + 4, "text-anchor": "middle", "font-size": size, "font-weight": bold ? 700 : 400, fill: bold ? colours.ink : colours.muted}, text));
}

/** Beside the plot, or in rows above a narrow one.
 * @param {Scatter} scatter */
function legendOf({groups, width, narrow, colours}) {
  let [left, top] = narrow ? [8, 10] : [width - 92, 18];
  const entries = groups.map(({name, style}) => {
    const needed = widestText([name], 11) + 26;
    if (narrow && left + needed > width) [left, top] = [8, top + 17];
    const entry = makeSvg("g", {}, markOf(style, left + 5, top, false),
      makeSvg("text", {x: left + 14, y: top + 4, fill: colours.ink}, name));
    if (narrow) left += needed;
    else top += 18;
    return entry;
  });
  return {element: makeSvg("g", {class: "legend"}, entries), height: narrow ? top + 8 : 0};
}

/** The point under or beside the pointer.
 * @param {SVGSVGElement} svg @param {Spot[]} spots @param {MouseEvent} event */
function nearestTo(svg, spots, event) {
  const {left, top} = svg.getBoundingClientRect();
  const [px, py] = [event.clientX - left, event.clientY - top];
  let [found, least] = [/** @type {Spot | null} */ (null), REACH];
  for (const spot of spots) {
    const distance = Math.hypot(spot.px - px, spot.py - py);
    if (distance <= least) [found, least] = [spot, distance];
  }
  return found;
}

/** A click is no end of a drag: the pointer stayed where it went down.
 * @param {SVGSVGElement} svg @param {(event: MouseEvent) => void} open */
function openByClicking(svg, open) {
  let down = {x: 0, y: 0};
  svg.addEventListener("pointerdown", event => { down = {x: event.clientX, y: event.clientY}; });
  svg.addEventListener("click", event => {
    if (Math.hypot(event.clientX - down.x, event.clientY - down.y) <= STILL) open(event);
  });
}

/** Dragging over a part shows it larger: `zoom` gets its corners in pixels, bottom left and top right.
 * @param {SVGSVGElement} svg @param {PlotBox} box @param {Colours} colours
 * @param {(from: number[], to: number[]) => void} zoom */
function zoomByDragging(svg, box, colours, zoom) {
  /** @type {number[] | null} */
  let from = null;
  const chosen = makeSvg("rect", {fill: colours.ink, "fill-opacity": 0.08, stroke: colours.muted, "pointer-events": "none"});
  const place = (/** @type {PointerEvent} */ event) => {
    const {left, top} = svg.getBoundingClientRect();
    return [Math.min(Math.max(event.clientX - left, box.left), box.right), Math.min(Math.max(event.clientY - top, box.top), box.bottom)];
  };
  const corners = (/** @type {number[]} */ a, /** @type {number[]} */ b) =>
    [[Math.min(a[0], b[0]), Math.max(a[1], b[1])], [Math.max(a[0], b[0]), Math.min(a[1], b[1])]];
  svg.addEventListener("pointerdown", event => { if (event.button === 0) from = place(event); });
  svg.addEventListener("pointermove", event => {
    if (!from) return;
    const [[left, bottom], [right, top]] = corners(from, place(event));
    for (const [name, value] of Object.entries({x: left, y: top, width: right - left, height: bottom - top})) chosen.setAttribute(name, String(value));
    if (!chosen.isConnected) svg.append(chosen);
  });
  svg.addEventListener("pointerleave", () => { from = null; chosen.remove(); });
  svg.addEventListener("pointerup", event => {
    const [one, other] = [from, place(event)];
    from = null;
    chosen.remove();
    if (one && Math.abs(one[0] - other[0]) > LEAST_DRAG && Math.abs(one[1] - other[1]) > LEAST_DRAG) {
      const [low, high] = corners(one, other);
      zoom(low, high);
    }
  });
}
