/* The filter. `and orb -flann`: all words, without the excluded one; `or sift daisy`: any of them;
   `not l2`: none of them. Bare words mean `and`. A word is the start of a part of a combination's
   name, or a part exactly where there is one of that name (`gftt` is not GFTT_H). */

import {CODES, entries, ranked, remember} from "./entries.js";
import {hasLimits, LIMITS, withinLimits} from "./limits.js";
import {state} from "./state.js";

const knownParts = new Set(entries.flatMap(entry =>
  CODES.flatMap(code => entry[code].map(part => part.toLowerCase()))));

/** @param {string} text */
function parseFilter(text) {
  /** @type {Record<string, string[]>} */
  const words = {and: [], or: [], not: []};
  let mode = "and";
  for (const token of text.toLowerCase().split(/[\s,]+/).filter(Boolean)) {
    if (Object.hasOwn(words, token)) mode = token;
    else if (token.startsWith("-")) words.not.push(token.slice(1));
    else words[mode].push(token);
  }
  const [and, or, not] = [words.and, words.or, words.not].map(each => each.map(partsOfWord).filter(parts => parts.length));
  return {and, or, not};
}

/** @param {string} word */
function partsOfWord(word) {
  return word.split("-").filter(Boolean);
}

/** @param {string[]} word @param {string[]} parts */
function wordMatches(word, parts) {
  const last = word.length - 1;
  const exact = knownParts.has(word[last]);
  for (let start = 0; start + last < parts.length; start += 1) {
    const fits = word.every((piece, i) => (i === last && !exact
      ? parts[start + i].startsWith(piece)
      : parts[start + i] === piece));
    if (fits) return true;
  }
  return false;
}

/** @param {Entry} entry */
function partsOfNames(entry) {
  return remember(entry, "parts", () => entry.combinations.map((_, a) =>
    CODES.map(code => entry[code][a].toLowerCase())));
}

/** @param {Code} code */
export function chosenChips(code) {
  return new Set(state.get(code).split(",").filter(Boolean));
}

/** The current filter: whether a combination passes the words and the chips, by its four names and
 * optionally the same names in lower case.
 * @returns {(names: string[], parts?: string[]) => boolean} */
export function currentFilter() {
  const words = parseFilter(state.get("q"));
  const chips = CODES.map(chosenChips);
  return (names, parts = names.map(name => name.toLowerCase())) =>
    chips.every((set, i) => !set.size || set.has(names[i]))
    && words.and.every(word => wordMatches(word, parts))
    && (!words.or.length || words.or.some(word => wordMatches(word, parts)))
    && !words.not.some(word => wordMatches(word, parts));
}

/** @param {Entry} entry */
function passing(entry) {
  const passes = currentFilter();
  return partsOfNames(entry).map((parts, a) => passes(CODES.map(code => entry[code][a]), parts));
}

/* Words that match no combination in any entry. */
export function unknownWords() {
  const words = Object.values(parseFilter(state.get("q"))).flat();
  return words
    .filter(word => !entries.some(entry =>
      partsOfNames(entry).some(parts => wordMatches(word, parts))))
    .map(word => word.join("-"));
}

export function isFiltered() {
  return Boolean(state.get("q").trim()) || CODES.some(code => chosenChips(code).size > 0) || hasLimits();
}

const filtered = {key: "", entries: /** @type {Map<Entry, number[]>} */ (new Map())};

/** Positions of the combinations that pass the filter and the limits, by rank.
 * @param {Entry} entry */
export function shownIn(entry) {
  const key = JSON.stringify(["q", ...CODES, ...LIMITS].map(name => state.get(name)));
  if (filtered.key !== key) Object.assign(filtered, {key, entries: new Map()});
  const known = filtered.entries.get(entry);
  if (known) return known;
  const pass = passing(entry);
  const found = withinLimits(entry, ranked(entry).filter(a => pass[a]));
  filtered.entries.set(entry, found);
  return found;
}
