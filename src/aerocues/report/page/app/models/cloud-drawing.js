/* Draws a cloud on a canvas: points with a depth buffer, then cameras and their true positions. WebGL would not be
   faster for a few thousand points, and it is not available on some phones and for printing. */

import {make} from "../basis/elements.js";
import {shown} from "../basis/numbers.js";
import {arrayOf} from "../basis/payload.js";
import {EYE, projection, unitOf} from "./cloud-space.js";
import {FONT} from "../shell/figure-layout.js";

/** @typedef {{width: number, height: number, pen: CanvasRenderingContext2D, image: ImageData, pixels: Uint32Array, depth: Float32Array}} Buffers */
/** @type {Buffers | null} */
let buffers = null;

/** Memory for the pixels of a canvas. All canvases share it, because they are drawn one after the other.
 * @param {number} width @param {number} height */
function buffersFor(width, height) {
  if (buffers?.width !== width || buffers.height !== height) {
    const pen = make("canvas", {width, height}).getContext("2d");
    if (!pen) throw new Error("this browser draws nothing on a canvas");
    const image = pen.createImageData(width, height);
    buffers = {width, height, pen, image, pixels: new Uint32Array(image.data.buffer), depth: new Float32Array(width * height)};
  }
  return buffers;
}

/** @param {CanvasRenderingContext2D} pen @param {CloudDrawing} view @param {number} width @param {number} height @param {number} density */
export function drawCloud(pen, view, width, height, density) {
  const project = projection(view.turn, view.stage, width, height);
  drawPoints(pen, view, project, width, height, density);
  const [centres, rotations, positions] = [view.cloud.centres, view.cloud.rotations, view.cloud.positions].map(arrayOf);
  pen.lineWidth = density;
  if (view.truth) drawTruth(pen, view, project, centres, positions, density);
  if (view.cameras) drawCameras(pen, view, project, centres, rotations);
  drawMeasure(pen, view, width, height, density);
}

/** @param {CanvasRenderingContext2D} pen @param {CloudDrawing} view @param {Projection} project @param {number} width @param {number} height @param {number} density */
function drawPoints(pen, {cloud, pixels: colours, turn, stage, size: wanted, ground}, project, width, height, density) {
  const {pen: hidden, image, pixels, depth} = buffersFor(width, height);
  pixels.fill(ground);
  depth.fill(Infinity);
  const points = arrayOf(cloud.points);
  const spot = [0, 0, 0];
  const size = wanted * density * (1.1 + 0.5 * Math.sqrt(turn.zoom)) * Math.min(1.6, Math.max(0.8, width / density / 480));
  for (let i = 0; i < colours.length; i += 1) {
    if (!project(points[3 * i], points[3 * i + 1], points[3 * i + 2], spot)) continue;
    const side = Math.max(1, Math.round(size * EYE * stage.radius / spot[2]));
    const [left, top] = [Math.round(spot[0] - side / 2), Math.round(spot[1] - side / 2)];
    if (left < 0 || top < 0 || left + side > width || top + side > height) continue;
    for (let y = top; y < top + side; y += 1) {
      for (let at = y * width + left; at < y * width + left + side; at += 1) {
        if (spot[2] < depth[at]) {
          depth[at] = spot[2];
          pixels[at] = colours[i];
        }
      }
    }
  }
  // By way of another canvas: printing leaves out what is put into the pixels of one on the page.
  hidden.putImageData(image, 0, 0);
  pen.drawImage(hidden.canvas, 0, 0);
}

const CORNERS = [[-1, -1], [1, -1], [1, 1], [-1, 1]];

/** Small pyramids that open in the viewing direction.
 * @param {CanvasRenderingContext2D} pen @param {CloudDrawing} view @param {Projection} project @param {Numbers} centres @param {Numbers} rotations */
function drawCameras(pen, {cloud, stage, colours}, project, centres, rotations) {
  const [focal, wide, tall] = cloud.view;
  const count = centres.length / 3;
  const size = stage.radius * Math.min(0.07, 0.5 / Math.sqrt(count || 1));
  const corners = CORNERS.map(([x, y]) => [x * size * wide / 2 / focal, y * size * tall / 2 / focal, size]);
  pen.strokeStyle = colours.series[3];
  pen.beginPath();
  for (let c = 0; c < count; c += 1) {
    const apex = placeAt(centres, c);
    const turned = rotations.subarray(9 * c, 9 * c + 9);
    const base = corners.map(corner => /** @type {Place} */ ([0, 1, 2].map(row => apex[row]
      + turned[3 * row] * corner[0] + turned[3 * row + 1] * corner[1] + turned[3 * row + 2] * corner[2])));
    traceLine(pen, project, [...base, base[0]]);
    for (const corner of base) traceLine(pen, project, [apex, corner]);
  }
  pen.stroke();
}

/** Rings at the true camera positions, and lines to them from the positions in the model.
 * @param {CanvasRenderingContext2D} pen @param {CloudDrawing} view @param {Projection} project @param {Numbers} centres @param {Numbers} positions @param {number} density */
function drawTruth(pen, {colours}, project, centres, positions, density) {
  const spot = [0, 0, 0];
  pen.strokeStyle = colours.series[0];
  pen.beginPath();
  for (let c = 0; c < positions.length / 3; c += 1) {
    const [model, truth] = [placeAt(centres, c), placeAt(positions, c)];
    if (!truth.every(Number.isFinite) || !project(...truth, spot)) continue;
    pen.moveTo(spot[0] + 3 * density, spot[1]);
    pen.arc(spot[0], spot[1], 3 * density, 0, 2 * Math.PI);
    traceLine(pen, project, [model, truth]);
  }
  pen.stroke();
}

/** @param {CanvasRenderingContext2D} pen @param {Projection} project @param {Place[]} places */
function traceLine(pen, project, places) {
  const spot = [0, 0, 0];
  const spots = places.flatMap(place => (project(...place, spot) ? [[spot[0], spot[1]]] : []));
  if (spots.length < places.length) return;
  spots.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
}

/** @param {Numbers} all @param {number} i @returns {Place} */
function placeAt(all, i) {
  return [all[3 * i], all[3 * i + 1], all[3 * i + 2]];
}

/** A scale bar for the centre of the cloud, and the directions east, north and up.
 * @param {CanvasRenderingContext2D} pen @param {CloudDrawing} view @param {number} width @param {number} height @param {number} density */
function drawMeasure(pen, {cloud, stage, turn, colours}, width, height, density) {
  const project = projection(turn, stage, width, height);
  const [from, to] = [[0, 0, 0], [0, 0, 0]];
  const [cx, cy, cz] = stage.centre;
  const [a, b] = [Math.cos(turn.yaw * Math.PI / 180), Math.sin(turn.yaw * Math.PI / 180)];
  project(cx, cy, cz, from);
  project(cx + a, cy - b, cz, to);
  const long = Math.abs(to[0] - from[0]) || 1; // pixels of a unit across the view
  const length = roundLength(0.22 * width / long);
  const [left, foot] = [10 * density, height - 12 * density];
  Object.assign(pen, {strokeStyle: colours.ink, fillStyle: colours.ink, font: `${11 * density}px ${FONT}`, textAlign: "left"});
  pen.beginPath();
  pen.moveTo(left, foot - 4 * density);
  pen.lineTo(left, foot);
  pen.lineTo(left + length * long, foot);
  pen.lineTo(left + length * long, foot - 4 * density);
  pen.stroke();
  pen.fillText(`${shown(length)} ${unitOf(cloud)}`, left + 5 * density, foot - 6 * density);
  if (cloud.unit === "m") drawAxes(pen, turn, width, height, density);
}

/** 1, 2 or 5 times a power of ten, no longer than this.
 * @param {number} most */
function roundLength(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return power * ([5, 2].find(step => step * power <= most) ?? 1);
}

/** @type {[name: string, east: number, north: number, up: number][]} */
const AXES = [["E", 1, 0, 0], ["N", 0, 1, 0], ["up", 0, 0, 1]];

/** @param {CanvasRenderingContext2D} pen @param {Turn} turn @param {number} width @param {number} height @param {number} density */
function drawAxes(pen, turn, width, height, density) {
  const project = projection({...turn, zoom: 1}, {centre: [0, 0, 0], radius: 1}, 100, 100);
  const [x, y, reach] = [width - 34 * density, height - 30 * density, 0.62 * density];
  const spot = [0, 0, 0];
  Object.assign(pen, {textAlign: "center"});
  for (const [name, east, north, up] of AXES) {
    project(0.7 * east, 0.7 * north, 0.7 * up, spot);
    const [dx, dy] = [(spot[0] - 50) * reach, (spot[1] - 50) * reach];
    if (Math.hypot(dx, dy) < 6 * density) continue;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + dx, y + dy);
    pen.stroke();
    pen.fillText(name, x + dx * 1.45, y + dy * 1.45 + 4 * density);
  }
}
