/* Draws a pair of images with keypoints and matches on a canvas. */

import {counted, ordinal} from "../basis/numbers.js";
import {arrayOf, payload} from "../basis/payload.js";

/** @type {{controls: Record<string, Control>, layers: Layer[], panels: PicturePanel[]}} */
export const pictureView = {controls: {}, layers: [], panels: []};
const INLIER = "#38c6ff";
const OUTLIER = "#ff8a1f";
const WRONG = "#ff3d9a";
const KEYPOINT = "#ffe04a";
const LEGIBLE_MATCHES = 150;
/** @type {Map<string, Promise<HTMLImageElement>>} */
const loadedImages = new Map();

/** @param {string} key */
function loadImage(key) {
  const known = loadedImages.get(key);
  if (known) return known;
  /** @type {Promise<HTMLImageElement>} */
  const loading = new Promise((resolve, reject) => {
    const image = new Image();
    image.onload = () => resolve(image);
    image.onerror = () => reject(new Error(`the image ${key} cannot be shown`));
    image.src = payload.images[key].src;
  });
  loadedImages.set(key, loading);
  return loading;
}

/* Kinds of matches. */
const [OUTLIERS, RIGHT_INLIER, WRONG_INLIER] = [0, 1, 2];
const COLOURS = [OUTLIER, INLIER, WRONG];

/** The kind of each match; inliers are taken for right where nothing tells.
 * @param {Picture} picture */
function kindsOf(picture) {
  const [inlier, right] = [arrayOf(picture.inlier), picture.right ? arrayOf(picture.right) : null];
  return Array.from(inlier, (isInlier, i) => (isInlier ? (right && !right[i] ? WRONG_INLIER : RIGHT_INLIER) : OUTLIERS));
}

/** @typedef {ReturnType<typeof placement>} Placement */

/** @param {PicturePanel} panel */
export async function drawPanel(panel) {
  const {picture, canvas, element} = panel;
  canvas.hidden = !picture;
  if (!picture) {
    panel.note.textContent = "There is no picture of this combination on this pair.";
    return;
  }
  const width = Math.floor(element.clientWidth);
  if (!width) return;
  const images = await Promise.all([loadImage(picture.image_1), loadImage(picture.image_2)])
    .catch(error => { panel.note.textContent = error.message; return null; });
  if (!images || panel.picture !== picture) return;
  const place = placement(picture, width);
  const density = Math.min(window.devicePixelRatio || 1, 2);
  Object.assign(canvas, {width: Math.round(width * density), height: Math.round(place.height * density)});
  canvas.style.height = `${place.height}px`;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  pen.scale(density, density);
  images.forEach((image, i) => pen.drawImage(image, place.left[i], place.top[i], place.width[i], place.tall[i]));
  const drawn = drawLayers(pen, picture, place);
  panel.note.textContent = drawn;
  canvas.setAttribute("aria-label", `Matches of ${picture.combination}. ${drawn}`);
}

/** Places the images side by side, or one above the other if they are larger that way.
 * @param {Picture} picture @param {number} width */
function placement(picture, width) {
  const [first, second] = [payload.images[picture.image_1], payload.images[picture.image_2]];
  const gap = 4;
  const stacked = width < 420 && first.width >= first.height;
  const factor = stacked
    ? width / Math.max(first.width, second.width)
    : (width - gap) / (first.width + second.width);
  const widths = [first.width * factor, second.width * factor];
  const talls = [first.height * factor, second.height * factor];
  return {
    width: widths, tall: talls,
    left: [0, stacked ? 0 : widths[0] + gap], top: [0, stacked ? talls[0] + gap : 0],
    height: stacked ? talls[0] + gap + talls[1] : Math.max(...talls),
    scale: [first.scale * factor, second.scale * factor],
  };
}

/** The place of a point of an image on the canvas.
 * @param {Placement} place @param {number} image @param {number} x @param {number} y @returns {[number, number]} */
function at(place, image, x, y) {
  return [place.left[image] + (x + 0.5) * place.scale[image], place.top[image] + (y + 0.5) * place.scale[image]];
}

/** Draws the selected layers and returns a description of what was drawn.
 * @param {CanvasRenderingContext2D} pen @param {Picture} picture @param {Placement} place */
function drawLayers(pen, picture, place) {
  const words = [];
  const [inliers, wrong, outliers, keypoints] = pictureView.layers.map(layer => layer.value());
  if (keypoints) words.push(drawKeypoints(pen, picture, place));
  const wanted = {[RIGHT_INLIER]: inliers, [OUTLIERS]: outliers, [WRONG_INLIER]: wrong};
  if (Object.values(wanted).includes(true)) words.push(drawMatches(pen, picture, place, wanted));
  return words.join(" ") || "No layer is selected.";
}

/** @param {CanvasRenderingContext2D} pen @param {Picture} picture @param {Placement} place */
function drawKeypoints(pen, picture, place) {
  pen.strokeStyle = KEYPOINT;
  pen.lineWidth = 1;
  pen.beginPath();
  [picture.keypoints_1, picture.keypoints_2].forEach((packed, image) => {
    const points = arrayOf(packed);
    for (let i = 0; i < points.length; i += 2) {
      const [x, y] = at(place, image, points[i], points[i + 1]);
      pen.moveTo(x + 2, y);
      pen.arc(x, y, 2, 0, 2 * Math.PI);
    }
  });
  pen.stroke();
  const every = picture.keypoints_every;
  return every > 1 ? `Every ${ordinal(every)} keypoint is drawn.` : "All keypoints are drawn.";
}

/** @param {CanvasRenderingContext2D} pen @param {Picture} picture @param {Placement} place @param {Record<number, boolean>} wanted */
function drawMatches(pen, picture, place, wanted) {
  const [matches, kinds] = [arrayOf(picture.matches), kindsOf(picture)];
  const indices = [...kinds.keys()].filter(i => wanted[kinds[i]]);
  const every = matchStep(indices.length);
  const drawn = indices.filter((_, i) => i % every === 0);
  for (const kind of [OUTLIERS, RIGHT_INLIER, WRONG_INLIER]) {
    pen.strokeStyle = COLOURS[kind];
    pen.fillStyle = pen.strokeStyle;
    pen.lineWidth = 1;
    pen.globalAlpha = drawn.length > 400 ? 0.5 : 0.8;
    for (const i of drawn.filter(each => kinds[each] === kind)) drawMatch(pen, matches.subarray(4 * i, 4 * i + 4), place);
  }
  pen.globalAlpha = 1;
  const total = every * (picture.matches_every || 1);
  const count = (/** @type {number} */ kind) => drawn.filter(i => kinds[i] === kind).length;
  const wrong = picture.judge ? `, of which ${count(WRONG_INLIER)} are wrong by the ${picture.judge}` : "";
  return `${total > 1 ? `Every ${ordinal(total)} match is drawn` : "Every match is drawn"}: `
    + `${counted(count(RIGHT_INLIER) + count(WRONG_INLIER), "inlier")}${wrong}, ${counted(count(OUTLIERS), "outlier")}.`;
}

/** Every n-th match as chosen; "auto" keeps few enough to see single matches.
 * @param {number} count */
function matchStep(count) {
  const chosenStep = pictureView.controls.every.value();
  if (chosenStep !== "auto") return Number(chosenStep);
  const steps = [1, 2, 5, 10, 20, 50];
  return steps.find(step => count / step <= LEGIBLE_MATCHES) ?? 50;
}

/** @param {CanvasRenderingContext2D} pen @param {Numbers} match @param {Placement} place */
function drawMatch(pen, [x1, y1, x2, y2], place) {
  const [from, to] = [at(place, 0, x1, y1), at(place, 1, x2, y2)];
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(...to);
  pen.stroke();
  for (const end of [from, to]) {
    pen.beginPath();
    pen.arc(...end, 1.8, 0, 2 * Math.PI);
    pen.fill();
  }
}
