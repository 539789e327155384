/* Plotly, by far the largest part of the page: it comes packed, is unpacked at once, and starts when the first screen is painted. */

import {elementOf, make} from "../basis/elements.js";
import {bytesOf} from "../basis/payload.js";

const TOO_OLD = "This browser is too old to draw this figure.";

/** The program between its unpacking and its start.
 * @type {string | null} */
let unpacked = null;

/** Unpacks Plotly and starts it after the next paint; tells when it is there, or why it is not.
 * @param {(reason: string | null) => void} tell */
export function unpackPlotly(tell) {
  const painted = new Promise(done => { requestAnimationFrame(() => setTimeout(done)); });
  unpack().then(() => painted).then(startPlotly)
    .then(() => tell(window.Plotly ? null : damaged("it does not start")), error => tell(reasonOf(error)));
}

/** Starts Plotly if it is unpacked and has not been started: paper does not wait for the first paint. */
export function startPlotly() {
  if (unpacked === null) return;
  // As the text of a script, which the page's policy allows, and no request.
  document.head.append(make("script", {}, unpacked));
  unpacked = null;
}

async function unpack() {
  const packed = new Blob([bytesOf(elementOf("plotly").textContent ?? "")]);
  unpacked = await new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

/** @param {unknown} error */
function reasonOf(error) {
  return "DecompressionStream" in window ? damaged(error instanceof Error ? error.message : String(error)) : TOO_OLD;
}

/** @param {string} why */
function damaged(why) {
  return `This figure cannot be drawn, because Plotly in this file is damaged (${why}); write the report again.`;
}
