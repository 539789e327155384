/* Turning the clouds. */

import {clamped} from "../basis/statistics.js";
import {FRONT} from "./cloud-space.js";
import {cloudView, drawClouds} from "./cloud-view.js";

const DEGREES_A_SECOND = 14;
/** @type {Record<string, Partial<Turn>>} */
const STEPS = {ArrowLeft: {yaw: 8}, ArrowRight: {yaw: -8}, ArrowUp: {pitch: 6}, ArrowDown: {pitch: -6}, "+": {zoom: 1.25}, "=": {zoom: 1.25}, "-": {zoom: 0.8}};

/** @param {string} key */
export function turnBy(key) {
  const step = STEPS[key];
  const {turn} = cloudView;
  if (step.yaw) turn.yaw += step.yaw;
  if (step.pitch) turn.pitch = clamped(turn.pitch + step.pitch, 0, 90);
  if (step.zoom) turn.zoom = clamped(turn.zoom * step.zoom, 0.4, 12);
  drawClouds();
}

/** @param {HTMLCanvasElement} canvas */
export function listenToTurns(canvas) {
  /** @type {Map<number, PointerEvent>} */
  const held = new Map();
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, event);
    setPlaying(false);
  });
  canvas.addEventListener("pointermove", event => {
    const before = held.get(event.pointerId);
    if (!before) return;
    const spread = held.size === 2 ? spreadOf(held) : null;
    held.set(event.pointerId, event);
    if (spread) cloudView.turn.zoom = clamped(cloudView.turn.zoom * spreadOf(held) / spread, 0.4, 12);
    else turnByDragging(event.clientX - before.clientX, event.clientY - before.clientY, event.pointerType === "touch");
    drawClouds();
  });
  canvas.addEventListener("pointerup", event => held.delete(event.pointerId));
  canvas.addEventListener("pointercancel", event => held.delete(event.pointerId));
  canvas.addEventListener("wheel", event => {
    // The wheel scrolls the page, unless the cloud has the focus.
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    cloudView.turn.zoom = clamped(cloudView.turn.zoom * Math.exp(-event.deltaY / 500), 0.4, 12);
    drawClouds();
  }, {passive: false});
  canvas.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Home") Object.assign(cloudView.turn, FRONT);
    else if (!STEPS[event.key]) return;
    event.preventDefault();
    setPlaying(false);
    if (event.key === "Home") drawClouds();
    else turnBy(event.key);
  });
}

/** @param {Map<number, PointerEvent>} held */
function spreadOf(held) {
  const [first, second] = [...held.values()];
  return Math.hypot(first.clientX - second.clientX, first.clientY - second.clientY) || 1;
}

/** On touch screens vertical movement scrolls the page.
 * @param {number} x @param {number} y @param {boolean} byTouch */
function turnByDragging(x, y, byTouch) {
  const {turn} = cloudView;
  turn.yaw -= x * 0.4;
  if (!byTouch) turn.pitch = clamped(turn.pitch + y * 0.3, 0, 90);
}

/** Starts or stops the animation, which never starts by itself.
 * @param {boolean} wanted */
export function setPlaying(wanted) {
  if (cloudView.playing === wanted) return;
  cloudView.playing = wanted;
  cloudView.play.textContent = wanted ? "Stop" : "Turn";
  cloudView.play.setAttribute("aria-pressed", String(wanted));
  if (wanted) requestAnimationFrame(time => keepTurning(time, time));
}

/** @param {number} time @param {number} before */
function keepTurning(time, before) {
  if (!cloudView.playing) return;
  cloudView.turn.yaw += DEGREES_A_SECOND * Math.min(time - before, 100) / 1000;
  drawClouds();
  requestAnimationFrame(next => keepTurning(next, time));
}
