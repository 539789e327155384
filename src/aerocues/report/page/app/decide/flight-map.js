/* The flight as a map: images where they were taken, and the pairs between them by their matches. */

import {onCividis} from "../basis/colours.js";
import {makeSvg, withTips} from "../basis/elements.js";
import {firstColumn, pairLabel, pairValues} from "../basis/entries.js";
import {shownIn} from "../basis/filter.js";
import {isKnown, labelOf, shown} from "../basis/numbers.js";
import {arrayOf, payload} from "../basis/payload.js";
import {boundsOf, spanOf} from "../basis/statistics.js";
import {state} from "../basis/state.js";
import {openPair} from "../drawer/pair.js";
import {FONT} from "../shell/figure-layout.js";
import {measuredAs, RIGHT_MATCHES} from "./candidates.js";
import {rankedForPurpose} from "./purposes.js";

/* COLMAP takes a pair with fewer verified matches for a failure. */
const FEWEST_MATCHES = 15;
const WEAK = "#d7263d";
const MARGIN = 34;
const GROUND_MARGIN = 6;
const LEGEND = 22;
/** @typedef {{position: number, from: number, to: number, matches: number | null, failed: boolean}} Edge
 * @typedef {{x: number, y: number}[]} Places */

/** @param {Entry} entry */
export function mapOf(entry) {
  return payload.maps.find(each => each.entry === entry.name) ?? null;
}

/** The combination whose matches are shown: the chosen one, or the answer, or the next best with pairs of its own.
 * @param {Entry} entry @returns {number | null} */
function shownOnMap(entry) {
  const names = [state.get("decide.pick"), ...rankedForPurpose().map(each => each.name)].filter(Boolean);
  return names.map(name => measuredAs(entry, name)).find(a => a !== null) ?? shownIn(entry)[0] ?? null;
}

/** @type {FigureSpec} */
export const FLIGHT_MAP = {
  id: "map", title: "The flight", showsAnswer: true, isOperated: true,
  read: "Images where they were taken, the ground that they show where that is known, and measured pairs, brighter with more matches. Click a pair to see it.",
  available: entry => (mapOf(entry) ? true : "No map: the images are not one flight, or could not be opened again."),
  draw(context) {
    const {entry, width} = context;
    const flight = mapOf(entry);
    const a = shownOnMap(entry);
    const column = firstColumn(entry, RIGHT_MATCHES);
    if (!flight || a === null || column === null) return {empty: "No pairs were measured with this combination."};
    const edges = edgesOf(entry, flight, column, a);
    const height = Math.min(455, Math.max(260, 1.05 * width));
    const weak = edges.filter(isWeak).length;
    return {
      svg: () => withTips(drawing(context, flight, edges, column, height)), height,
      table: [["image_1", "image_2", labelOf(column)], edges.map(edge => [flight.images[edge.from].name, flight.images[edge.to].name, edge.matches])],
      note: `${entry.combinations[a]}: ${edges.length} pairs${weak ? `, ${weak} weak` : ", none weak"}; ${labelOf(column)}`
        + `${flight.known === "order" ? ". Positions are unknown: images in order" : ""}.`,
      summary: `Map of ${flight.images.length} images and ${edges.length} pairs, width ${width}`,
    };
  },
};

/** @param {Edge} edge */
function isWeak({failed, matches}) {
  return failed || (matches !== null && matches < FEWEST_MATCHES);
}

/** @param {Entry} entry @param {FlightMap} flight @param {string} column @param {number} a @returns {Edge[]} */
function edgesOf(entry, flight, column, a) {
  const place = new Map(flight.images.map(({name}, i) => [name, i]));
  const [status, values] = [arrayOf(entry.status), pairValues(entry, column, a)];
  const unknown = entry.statuses.indexOf("not measured");
  const good = entry.statuses.indexOf("ok");
  return entry.pairs.flatMap((pair, position) => {
    const [from, to] = [place.get(pair.image_1), place.get(pair.image_2)];
    const outcome = status[a * entry.pairs.length + position];
    if (from === undefined || to === undefined || outcome === unknown) return [];
    const value = values[position];
    return [{position, from, to, matches: Number.isFinite(value) ? value : null, failed: outcome !== good}];
  });
}

/** From metres to the east and north to the drawing, north up, to one scale.
 * @param {FlightMap} flight @param {number} width @param {number} height @returns {(place: [number, number]) => {x: number, y: number}} */
function placing({images}, width, height) {
  const all = images.flatMap(({x, y, ground}) => [[x, y], ...(ground ?? [])]);
  const [xs, ys] = [spanOf(all.map(([x]) => x)), spanOf(all.map(([, y]) => y))];
  const margin = images.some(({ground}) => ground) ? GROUND_MARGIN : MARGIN;
  const scale = Math.min((width - 2 * margin) / (xs[1] - xs[0]), (height - 2 * margin - LEGEND) / (ys[1] - ys[0]));
  const [cx, cy] = [(xs[0] + xs[1]) / 2, (ys[0] + ys[1]) / 2];
  return ([x, y]) => ({x: width / 2 + (x - cx) * scale, y: (height - LEGEND) / 2 - (y - cy) * scale});
}

/** What the images show of the ground: darker where more of them do.
 * @param {FlightMap} flight @param {(place: [number, number]) => {x: number, y: number}} at @param {Colours} colours */
function footprints({images}, at, colours) {
  return makeSvg("g", {class: "footprints"}, images.filter(({ground}) => ground).map(({ground, name}) => makeSvg("polygon", {
    points: (ground ?? []).map(at).map(({x, y}) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" "), "data-tip": name,
    fill: colours.ink, "fill-opacity": 0.05, stroke: colours.line, "stroke-width": 0.7})));
}

/** @param {FigureContext} context @param {FlightMap} flight @param {Edge[]} edges @param {string} column @param {number} height */
function drawing({entry, width, colours}, flight, edges, column, height) {
  const at = placing(flight, width, height);
  const places = flight.images.map(({x, y}) => at([x, y]));
  const [, most] = boundsOf(edges.map(edge => edge.matches ?? 0));
  const side = Math.min(44, Math.max(8, 0.8 * nearest(places)));
  const lines = [...edges].sort((e, f) => Number(isWeak(e)) - Number(isWeak(f))).map(edge => {
    const [from, to] = [places[edge.from], places[edge.to]];
    const told = `${pairLabel(entry, edge.position)}: ${edge.failed ? "failed" : `${shown(edge.matches)} ${labelOf(column)}`}`;
    const ends = {x1: from.x, y1: from.y, x2: to.x, y2: to.y, "data-tip": told};
    const open = () => openPair(edge.position);
    const hit = makeSvg("line", {...ends, stroke: "transparent", "stroke-width": 12, class: "edge", role: "button", tabindex: 0, "aria-label": told});
    hit.addEventListener("click", open);
    hit.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); open(); } });
    // A rim, for one end of the colours is as dark as the dark page, the other as light as the light one.
    const rim = makeSvg("line", {...ends, stroke: colours.ink, "stroke-opacity": 0.4, "stroke-width": 4.5});
    return [isWeak(edge) ? [] : rim, makeSvg("line", {...ends, stroke: isWeak(edge) ? WEAK : onCividis((edge.matches ?? 0) / (most || 1)),
      "stroke-width": isWeak(edge) ? 3 : 2.5, "stroke-dasharray": edge.failed ? "5 4" : "none"}), hit];
  });
  const tip = (/** @type {number} */ i) => flight.images[i].name;
  const spots = places.map(({x, y}, i) => {
    const {src} = flight.images[i];
    return src && side > 14
      ? makeSvg("image", {href: src, x: x - side / 2, y: y - side / 2, width: side, height: side, "data-tip": tip(i)})
      : makeSvg("circle", {cx: x, cy: y, r: 3.5, fill: colours.ink, "data-tip": tip(i)});
  });
  return makeSvg("svg", {class: "main-svg", width, height, viewBox: `0 0 ${width} ${height}`, "font-family": FONT, "font-size": 11, fill: colours.ink},
    makeSvg("rect", {width, height, fill: colours.surface}), footprints(flight, at, colours), lines, spots, legend(colours, most, height));
}

/** The smallest usual distance between neighbours: pictures must not cover each other.
 * @param {Places} places */
function nearest(places) {
  const distances = places.map((p, i) => Math.min(...places.filter((_, j) => j !== i).map(q => Math.max(Math.abs(p.x - q.x), Math.abs(p.y - q.y)))));
  return distances.sort((a, b) => a - b)[Math.floor(distances.length / 4)];
}

/** @param {Colours} colours @param {number} most @param {number} height */
function legend(colours, most, height) {
  const stops = Array.from({length: 24}, (_, i) => makeSvg("rect", {x: 8 + i * 4, y: height - 12, width: 4, height: 6, fill: onCividis(i / 23)}));
  return makeSvg("g", {}, stops,
    makeSvg("text", {x: 8, y: height - 17, fill: colours.muted}, "0"),
    makeSvg("text", {x: 104, y: height - 17, fill: colours.muted, "text-anchor": "end"}, isKnown(most) ? shown(most, 2) : ""),
    makeSvg("line", {x1: 122, x2: 142, y1: height - 9, y2: height - 9, stroke: WEAK, "stroke-width": 3}),
    makeSvg("text", {x: 147, y: height - 5, fill: colours.muted}, `failed, or fewer than ${FEWEST_MATCHES}`));
}
