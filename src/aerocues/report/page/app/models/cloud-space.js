/* Clouds in space: their extent, their projection and their colours. */

import {onCividis, THEMES} from "../basis/colours.js";
import {arrayOf} from "../basis/payload.js";
import {clamped, quantile} from "../basis/statistics.js";

/** @type {Turn} */
export const FRONT = {yaw: -35, pitch: 38, zoom: 1};
export const EYE = 3.2; // of the eye from the centre, in radii

/** @param {ArrayLike<number>} values */
export function sortedKnown(values) {
  return Float32Array.from(values).filter(Number.isFinite).sort();
}

/** The extent of several clouds in one frame, without remote points.
 * @param {Cloud[]} clouds @returns {Stage3D} */
export function stageOf(clouds) {
  const places = clouds.flatMap(cloud => [cloud.points, cloud.centres, cloud.positions].map(arrayOf));
  const bounds = [0, 1, 2].map(axis => {
    const along = sortedKnown(places.flatMap(all => Array.from(all).filter((_, i) => i % 3 === axis)));
    return along.length ? [quantile(along, 0.01), quantile(along, 0.99)] : [0, 0];
  });
  return {
    centre: /** @type {Place} */ (bounds.map(([low, high]) => (low + high) / 2)),
    radius: Math.hypot(...bounds.map(([low, high]) => (high - low) / 2)) || 1,
  };
}

/** A function from a place in space to x, y and distance from the eye on a canvas of some size.
 * @param {Turn} turn @param {Stage3D} stage @param {number} width @param {number} height @returns {Projection} */
export function projection({yaw, pitch, zoom}, {centre, radius}, width, height) {
  const [a, b] = [yaw, pitch].map(degrees => degrees * Math.PI / 180);
  const [ca, sa, cb, sb] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
  const [cx, cy, cz] = centre;
  const eye = EYE * radius;
  const scale = zoom * 0.42 * Math.min(width, height * 1.3) / radius;
  return (x, y, z, out) => {
    const [dx, dy, dz] = [x - cx, y - cy, z - cz];
    const along = sa * dx + ca * dy;
    const depth = eye + cb * along - sb * dz;
    const factor = scale * eye / depth;
    out[0] = width / 2 + factor * (ca * dx - sa * dy);
    out[1] = height / 2 - factor * (sb * along + cb * dz);
    out[2] = depth;
    return depth > 0.05 * eye;
  };
}

/** The first has no values: its colours are stored in the cloud.
 * @type {PointColour[]} */
export const POINT_COLOURS = [
  {key: "image", label: "colours of the images", unit: () => "", values: () => new Float32Array(0), limits: [0, 1]},
  {key: "height", label: "height", unit: unitOf, values: cloud => arrayOf(cloud.points).filter((_, i) => i % 3 === 2), limits: [0.02, 0.98]},
  {key: "distance", label: "distance to the reference (C2C)", unit: unitOf, values: cloud => arrayOf(cloud.distances), limits: [null, 0.95]},
  {key: "error", label: "reprojection error", unit: () => "px", values: cloud => arrayOf(cloud.errors), limits: [null, 0.98]},
  {key: "track", label: "number of images that see the point", unit: () => "images", values: cloud => arrayOf(cloud.track_lengths), limits: [0, 0.98]},
];

/** @param {Cloud} cloud */
export function unitOf(cloud) {
  return cloud.unit === "m" ? "m" : "model units";
}

/** The ends of the colours over some clouds; a limit of null is 0.
 * @param {PointColour} kind @param {Cloud[]} clouds @returns {Span | null} */
export function colourLimits(kind, clouds) {
  const sorted = sortedKnown(clouds.flatMap(cloud => Array.from(kind.values(cloud))));
  if (!sorted.length) return null;
  const [low, high] = kind.limits.map(share => (share === null ? 0 : quantile(sorted, share)));
  return high > low ? [low, high] : [low, low + 1];
}

/** A pixel of a canvas as one number, in the order of its bytes.
 * @param {number[]} colour */
function pixel([red, green, blue]) {
  return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
}

/** @param {string} colour  As "#0072b2". */
export function pixelOf(colour) {
  return pixel([1, 3, 5].map(at => parseInt(colour.slice(at, at + 2), 16)));
}

/* The part of the scale that is visible on the background: not the dark end on dark, nor the bright end on white. */
const VISIBLE = {light: [0, 0.9], dark: [0.3, 1]};
const STEPS_OF_SCALE = 256;

/** @param {Theme} theme */
export function scaleColours(theme) {
  const [low, high] = VISIBLE[theme];
  return Array.from({length: STEPS_OF_SCALE}, (_, i) => onCividis(low + (high - low) * i / (STEPS_OF_SCALE - 1)));
}

/** One pixel per point; points without a value get the colour of lines.
 * @param {Cloud} cloud @param {PointColour} kind @param {Span | null} limits @param {Theme} theme */
export function pointPixels(cloud, kind, limits, theme) {
  const colours = arrayOf(cloud.colours);
  const pixels = new Uint32Array(colours.length / 3);
  if (kind.key === "image") {
    return pixels.map((_, i) => pixel([colours[3 * i], colours[3 * i + 1], colours[3 * i + 2]]));
  }
  const values = kind.values(cloud);
  const unknown = pixelOf(THEMES[theme].line);
  if (!limits) return pixels.fill(unknown);
  const steps = scaleColours(theme).map(colour => pixel((colour.match(/\d+/g) ?? []).map(Number)));
  const [low, high] = limits;
  const stepOf = (/** @type {number} */ value) => Math.round((STEPS_OF_SCALE - 1) * clamped((value - low) / (high - low), 0, 1));
  return pixels.map((_, i) => (Number.isFinite(values[i]) ? steps[stepOf(values[i])] : unknown));
}
