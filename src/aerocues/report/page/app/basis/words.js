/* Words that are explained where they stand: their meaning is shown under the pointer. */

import {make} from "./elements.js";
import {payload} from "./payload.js";

const MEANINGS = new Map(payload.method.words.map(({word, meaning}) => [word.toLowerCase(), meaning]));
const KNOWN = new RegExp(`\\b(${[...MEANINGS.keys()].join("|")})s?\\b`, "gi");

/** A text whose words are explained, each where it stands first.
 * @param {string} text @returns {Content} */
export function explained(text) {
  if (!MEANINGS.size) return text;
  /** @type {Content[]} */
  const parts = [];
  /** @type {Set<string>} */
  const told = new Set();
  let end = 0;
  for (const found of text.matchAll(KNOWN)) {
    const word = found[1].toLowerCase();
    if (told.has(word)) continue;
    told.add(word);
    parts.push(text.slice(end, found.index), make("abbr", {title: MEANINGS.get(word)}, found[0]));
    end = found.index + found[0].length;
  }
  return [...parts, text.slice(end)];
}
