/* The view of the clouds: the two that were chosen, turned together. */

import {themeName, THEMES} from "../basis/colours.js";
import {make} from "../basis/elements.js";
import {remember} from "../basis/entries.js";
import {counted, sentenceCase, shown} from "../basis/numbers.js";
import {arrayOf, payload} from "../basis/payload.js";
import {currentEntry} from "../basis/state.js";
import {drawCloud} from "./cloud-drawing.js";
import {FRONT, pixelOf} from "./cloud-space.js";

/** `flight` is the ball around what a camera sees, while one was flown to; `size` of the points is relative.
 * @type {{turn: Turn, playing: boolean, stage: Stage3D | null, flight: Stage3D | null, size: number, controls: Record<string, Control>, layers: Layer[],
 *   panels: CloudPanel[], play: HTMLElement, legend: HTMLElement}} */
export const cloudView = {turn: {...FRONT}, playing: false, stage: null, flight: null, size: 1, controls: {}, layers: [], panels: [],
  play: make("button", {type: "button", class: "quiet", id: "turn-clouds", "aria-pressed": "false"}, "Turn"),
  legend: make("div", {class: "cloud-legend"})};

/** @param {Entry} entry */
export function cloudsOf(entry) {
  return remember(entry, "clouds", () => payload.clouds.filter(cloud => cloud.entry === entry.name));
}

export function drawClouds() {
  const entry = currentEntry();
  if (!cloudsOf(entry).length || !cloudView.stage) return;
  const colours = THEMES[themeName()];
  const [cameras, truth] = cloudView.layers.map(layer => layer.value());
  for (const {canvas, cloud, pixels, element} of cloudView.panels) {
    const width = Math.floor(element.clientWidth) - 2 * parseFloat(getComputedStyle(element).paddingLeft);
    canvas.hidden = !cloud;
    if (!cloud || !pixels || width <= 0) continue;
    const height = document.fullscreenElement ? Math.max(240, window.innerHeight - 230) : Math.round(Math.min(460, Math.max(280, width * 0.72)));
    const density = Math.min(window.devicePixelRatio || 1, 2);
    const [wide, tall] = [width, height].map(size => Math.round(size * density));
    if (canvas.width !== wide || canvas.height !== tall) Object.assign(canvas, {width: wide, height: tall});
    canvas.style.height = `${height}px`;
    const view = {cloud, pixels, turn: cloudView.turn, stage: cloudView.flight ?? cloudView.stage, size: cloudView.size, cameras, truth, colours, ground: pixelOf(colours.surface)};
    const pen = canvas.getContext("2d", {willReadFrequently: true});
    if (pen) drawCloud(pen, view, wide, tall, density);
    canvas.setAttribute("aria-label", `Cloud of ${cloud.combination}. ${cloudNote(cloud)}`);
  }
}

/** What is drawn, and what is not.
 * @param {Cloud | null} cloud */
export function cloudNote(cloud) {
  if (!cloud) return "This combination has no cloud.";
  const drawn = arrayOf(cloud.colours).length / 3;
  const left = cloud.all_points - cloud.strays - drawn;
  return [sentenceCase(cloud.why), left > 0 ? `${shown(drawn)} of ${counted(cloud.all_points, "point")} are drawn, sampled at random`
    : `${counted(drawn, "point")} are drawn`, cloud.strays ? `${counted(cloud.strays, "point")} far away are not shown` : null].filter(Boolean).join("; ") + ".";
}
