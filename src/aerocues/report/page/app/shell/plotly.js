/* Plotly, by far the largest part of the page: it comes packed, and is unpacked when the first screen is painted. */

import {elementOf, make} from "../basis/elements.js";
import {bytesOf} from "../basis/payload.js";

const TOO_OLD = "This browser is too old to draw this figure.";

/** Unpacks it after the next paint; tells when it is there, or why it is not.
 * @param {(reason: string | null) => void} tell */
export function unpackPlotly(tell) {
  requestAnimationFrame(() => setTimeout(() => unpack().then(() => tell(null), () => tell(TOO_OLD))));
}

async function unpack() {
  const packed = new Blob([bytesOf(elementOf("plotly").textContent ?? "")]);
  const text = await new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).text();
  // As the text of a script, which the page's policy allows, and no request.
  document.head.append(make("script", {}, text));
}
