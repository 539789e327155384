/* Tools of the clouds: full screen, the size of points, a flight to a camera with its photo, and a file. */

import {fileStem, saveFile} from "../basis/downloads.js";
import {make} from "../basis/elements.js";
import {arrayOf, payload} from "../basis/payload.js";
import {currentEntry} from "../basis/state.js";
import {FRONT} from "./cloud-space.js";
import {cloudView, drawClouds} from "./cloud-view.js";

const photo = make("figure", {class: "photo", hidden: true});
const cameras = make("select", {id: "fly-to", onchange: () => flyTo(cameras.value)});

/** @param {HTMLElement} frame  What fills the screen. */
export function buildCloudTools(frame) {
  const full = make("button", {type: "button", class: "quiet", id: "full-screen", onclick: () => {
    if (document.fullscreenElement) document.exitFullscreen();
    else frame.requestFullscreen();
  }}, "Full screen");
  full.hidden = !document.fullscreenEnabled;
  document.addEventListener("fullscreenchange", () => {
    full.textContent = document.fullscreenElement ? "Leave full screen" : "Full screen";
    drawClouds();
  });
  const size = make("input", {type: "range", id: "point-size", min: 0.5, max: 4, step: 0.25, value: 1, oninput: () => {
    cloudView.size = Number(size.value);
    drawClouds();
  }});
  return [make("div", {class: "controls"}, make("label", {class: "control", for: "point-size"}, "Point size", size),
    make("label", {class: "control", for: "fly-to"}, "Fly to", cameras),
    make("span", {class: "save"}, full, ["left", "right"].map((side, i) => make("button", {type: "button", class: "quiet",
      "aria-label": `Save the points of the ${side} cloud as PLY`, onclick: () => savePly(cloudView.panels[i].cloud)}, `PLY, ${side}`)))), photo];
}

/* The cameras of the first cloud. */
export function refreshCloudTools() {
  const names = cloudView.panels[0]?.cloud?.names ?? [];
  const before = cameras.value;
  cameras.replaceChildren(make("option", {value: ""}, "the whole scene"), ...names.map(name => make("option", {value: name}, name)));
  cameras.value = names.includes(before) ? before : "";
}

/** Looks at the scene as a camera does, as far as the view can turn, and shows its photo; "" is the whole scene.
 * @param {string} name */
function flyTo(name) {
  const cloud = cloudView.panels[0]?.cloud;
  const {stage} = cloudView;
  if (!cloud || !stage) return;
  const c = cloud.names.indexOf(name);
  cloudView.flight = null;
  Object.assign(cloudView.turn, FRONT);
  if (c >= 0) {
    const centre = arrayOf(cloud.centres).subarray(3 * c, 3 * c + 3);
    const turned = arrayOf(cloud.rotations).subarray(9 * c, 9 * c + 9);
    const ahead = [turned[2], turned[5], turned[8]];
    const far = distanceAhead(cloud, centre, ahead) || stage.radius;
    cloudView.flight = {radius: stage.radius, centre: /** @type {Place} */ ([0, 1, 2].map(axis => centre[axis] + far * ahead[axis]))};
    const degrees = 180 / Math.PI;
    const pitch = Math.min(90, Math.max(0, Math.asin(Math.min(1, Math.max(-1, -ahead[2]))) * degrees));
    // Seen straight down, the image's own right side says where the view is turned to.
    const yaw = pitch > 75 ? Math.atan2(-turned[3], turned[0]) * degrees : Math.atan2(ahead[0], ahead[1]) * degrees;
    Object.assign(cloudView.turn, {yaw, pitch, zoom: Math.min(12, Math.max(1, 1.2 * stage.radius / far))});
  }
  showPhoto(name);
  drawClouds();
}

/** How far before a camera the points are that it looks at: the median of those near its axis.
 * @param {Cloud} cloud @param {Numbers} centre @param {number[]} ahead */
function distanceAhead(cloud, centre, ahead) {
  const points = arrayOf(cloud.points);
  const found = [];
  for (let i = 0; i < points.length; i += 3) {
    const [x, y, z] = [0, 1, 2].map(axis => points[i + axis] - centre[axis]);
    const along = x * ahead[0] + y * ahead[1] + z * ahead[2];
    if (along > 0 && Math.hypot(x, y, z) < 1.15 * along) found.push(along);
  }
  found.sort((a, b) => a - b);
  return found[found.length >> 1] ?? 0;
}

/** @param {string} name */
function showPhoto(name) {
  const entry = currentEntry();
  const src = payload.images[`${entry.name}/${name}`]?.src
    ?? payload.maps.find(each => each.entry === entry.name)?.images.find(image => image.name === name)?.src;
  photo.hidden = !name;
  photo.replaceChildren(src ? make("img", {src, alt: `Photo ${name}`}) : "No photo of it is in this page.", make("figcaption", {}, name));
}

/** The points that are drawn, with their colours, as text.
 * @param {Cloud | null} cloud */
function savePly(cloud) {
  if (!cloud) return;
  const [points, colours] = [arrayOf(cloud.points), arrayOf(cloud.colours)];
  const rows = Array.from({length: colours.length / 3}, (_, i) => [...points.subarray(3 * i, 3 * i + 3), ...colours.subarray(3 * i, 3 * i + 3)].join(" "));
  const header = ["ply", "format ascii 1.0", `element vertex ${rows.length}`, ...["x", "y", "z"].map(axis => `property float ${axis}`),
    ...["red", "green", "blue"].map(colour => `property uchar ${colour}`), "end_header"];
  saveFile(`${fileStem(currentEntry().name, "cloud", cloud.combination)}.ply`, `${[...header, ...rows].join("\n")}\n`, "text/plain");
}
