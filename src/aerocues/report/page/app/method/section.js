/* Section 8: how everything was measured, what failed, definitions, citation. */

import {disclosure, elementOf, make, nodesOf, plainTable} from "../basis/elements.js";
import {counted, labelOf, NONE, percent, shown} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {currentEntry} from "../basis/state.js";

/** @type {SectionSpec} */
export const METHOD_SECTION = {
  id: "method",
  title: "Method",
  level: "Method",
  read: "How everything was measured and scored, what failed and why, the definition of every column, and how to cite this.",
  build(body) {
    body.append(make("div", {id: "method-entry"}), make("div", {id: "method-words"}, ...methodWords()));
  },
  update(_, changed) {
    if (changed.has("entry")) elementOf("method-entry").replaceChildren(...methodOfEntry(currentEntry()));
  },
};

/** @param {Entry} entry */
function methodOfEntry(entry) {
  const parts = entry.run;
  return nodesOf([
    make("div", {class: "columns"},
      block("Measured", {dataset: parts.dataset, machine: parts.machine ?? entry.machine, times: entry.timing,
        imported: parts.imported}),
      block("Settings", {preset: parts.preset, protocol: parts.protocol}),
      block("Scored", {preset: entry.preset, ...entry.score.settings, criteria: entry.score.settings.criteria.map(labelOf)}),
      block("Versions", {...(/** @type {Record<string, Json>} */ (parts.versions))})),
    outcomes(entry), failures(entry), excluded(entry)]);
}

/** Nested values as nested lists of terms; null if there are none.
 * @param {string} title @param {{[name: string]: Json | undefined}} values */
function block(title, values) {
  const known = Object.entries(values).filter(([, value]) => !isNothing(value));
  if (!known.length) return null;
  return make("div", {class: "block"}, make("h3", {}, title), nested(Object.fromEntries(known)));
}

/** @param {Json | undefined} value */
function isNothing(value) {
  return value === null || value === undefined || value === ""
    || (typeof value === "object" && !Object.keys(value).length);
}

/** @param {Json | undefined} value @returns {Content} */
function nested(value) {
  if (Array.isArray(value)) {
    return value.every(each => typeof each !== "object") ? value.join(", ") : make("ul", {}, value.map(each => make("li", {}, nested(each))));
  }
  if (value && typeof value === "object") {
    return make("dl", {class: "nested"}, Object.entries(value).filter(([, each]) => !isNothing(each)).map(([name, each]) =>
      make("div", {}, make("dt", {}, name.replaceAll("_", " ")), make("dd", {}, name === "memory_bytes" ? `${shown(Number(each) / 1e9)} GB` : nested(each)))));
  }
  return typeof value === "boolean" ? (value ? "yes" : "no") : String(value);
}

/** @param {Entry} entry */
function outcomes(entry) {
  const rows = Object.entries(entry.counts).sort((a, b) => b[1] - a[1]);
  const total = rows.reduce((sum, [, count]) => sum + count, 0);
  return plainTable("Outcomes of the measurements", [
    {label: "Status", text: ([status]) => status},
    {label: "Meaning", text: ([status]) => meaningOf(status)},
    {label: "Rows", number: true, text: ([, count]) => count.toLocaleString("en")},
    {label: "Share", number: true, text: ([, count]) => percent(count / total)}], rows);
}

/** @param {string} status */
function meaningOf(status) {
  return payload.method.statuses.find(each => each.name === status)?.meaning ?? "";
}

/** @param {Entry} entry */
function failures(entry) {
  if (!entry.failures.length) return make("p", {class: "nothing"}, "No measurement failed.");
  const left = entry.failures_left_out ? `; ${entry.failures_left_out} more kinds are not listed` : "";
  return disclosure(`Failures by reason (${entry.failures.length}${left})`, plainTable("Failures by reason", [
    {label: "Status", text: row => row.status}, {label: "Detector", text: row => row.detector},
    {label: "Descriptor", text: row => row.descriptor}, {label: "Rows", number: true, text: row => row.rows.toLocaleString("en")},
    {label: "Message", text: row => row.message ?? NONE}], entry.failures));
}

/** @param {Entry} entry */
function excluded(entry) {
  if (!entry.excluded.length) return null;
  return disclosure(`Never run (${counted(entry.excluded.length, "reason")})`, plainTable("Never run, by reason", [
    {label: "Reason", text: row => row.reason}, {label: "Combinations", number: true, text: row => row.combinations.length.toLocaleString("en")},
    {label: "Pairs", number: true, text: row => shown(row.pairs)}], entry.excluded));
}

function methodWords() {
  const {columns, notes, citation, words} = payload.method;
  return [
    notes.length ? make("div", {class: "block"}, make("h3", {}, "Notes"), make("ul", {}, notes.map(note => make("li", {}, note)))) : null,
    columns.length ? disclosure(`Every column (${columns.length})`, plainTable("Definitions of the columns", [
      {label: "Column", text: row => row.name}, {label: "Unit", text: row => row.unit || NONE},
      {label: "Better", text: row => row.better ?? NONE}, {label: "Definition", text: row => row.definition}], columns)) : null,
    words.length ? disclosure(`Words (${words.length})`, plainTable("Words and their meaning", [
      {label: "Word", text: row => row.word}, {label: "Meaning", text: row => row.meaning}], words)) : null,
    citation ? make("div", {class: "block"}, make("h3", {}, "Citation"), make("pre", {class: "citation", tabindex: "0"}, citation)) : null,
  ].filter(Boolean);
}
