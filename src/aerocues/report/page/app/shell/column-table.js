/* A table with one row per combination: it can be sorted, its columns chosen, and it can be saved. */

import {fileStem, saveCsv} from "../basis/downloads.js";
import {announce, disclosure, make} from "../basis/elements.js";
import {counted} from "../basis/numbers.js";
import {currentEntry, state} from "../basis/state.js";

const ROWS_AT_FIRST = 15;
/** @type {Span} */
const WHOLE = [0, 1];
/** @type {Map<ColumnTableSpec, ColumnTable>} */
const tables = new Map();

/** @param {HTMLElement} parent @param {ColumnTableSpec} spec */
export function addColumnTable(parent, spec) {
  /** @type {ColumnTable} */
  const table = {...spec, element: make("table", {class: "ranking", id: spec.id}),
    chooser: make("div", {class: "chooser"}), more: make("div", {class: "more"}), words: make("p", {class: "read"})};
  parent.append(
    make("h3", {id: `title-${spec.id}`}, spec.title), table.words,
    make("div", {class: "controls"},
      disclosure("Columns", table.chooser),
      make("span", {class: "save"}, make("button", {type: "button", class: "quiet", id: `save-${spec.id}`,
        "aria-label": `Save the table “${spec.title}” as CSV`, onclick: () => saveColumnTable(table)}, "CSV"))),
    make("div", {class: "scroll", tabindex: "0", role: "region", "aria-labelledby": `title-${spec.id}`}, table.element),
    table.more);
  tables.set(spec, table);
}

/** @param {ColumnTable} table @param {Entry} entry */
function shownColumns(table, entry) {
  const all = table.columns(entry);
  const wanted = state.get(`${table.prefix}columns`).split(",").filter(Boolean);
  const picked = all.filter(column => wanted.includes(column.key));
  return picked.length ? picked : all.filter(column => column.usual);
}

/** @param {ColumnTable} table */
function sortOrder({prefix, natural}) {
  const text = state.get(`${prefix}sort`, natural);
  return text.startsWith("-") ? {key: text.slice(1), down: true} : {key: text, down: false};
}

/** Rows in the chosen order; rows without a value come last.
 * @param {ColumnTable} table @param {Entry} entry */
function sortedRows(table, entry) {
  const {key, down} = sortOrder(table);
  const column = table.columns(entry).find(each => each.key === key);
  const rows = [...table.rows(entry)];
  if (!column || (key === table.natural && !down)) return rows;
  const known = rows.filter(a => column.value(a) !== null);
  const lacking = rows.filter(a => column.value(a) === null);
  /** @type {(a: number, b: number) => number} */
  const compare = column.number
    ? (a, b) => Number(column.value(a)) - Number(column.value(b))
    : (a, b) => compareTexts(String(column.value(a)), String(column.value(b)));
  known.sort((a, b) => (down ? compare(b, a) : compare(a, b)));
  return [...known, ...lacking];
}

/** @param {string} first @param {string} second */
function compareTexts(first, second) {
  const [a, b] = [first.toLowerCase(), second.toLowerCase()];
  return a < b ? -1 : Number(a > b);
}

/** @param {ColumnTableSpec} spec @param {Set<string>} changed */
export function updateColumnTable(spec, changed) {
  const table = tables.get(spec);
  if (!table) return;
  const entry = currentEntry();
  const columns = shownColumns(table, entry);
  const rows = sortedRows(table, entry);
  const asked = state.get(`${table.prefix}rows`, String(ROWS_AT_FIRST));
  const limit = asked === "all" ? rows.length : Number(asked);
  if (changed.has("entry") || changed.has(`${table.prefix}columns`)) updateChooser(table, entry, columns);
  table.words.textContent = table.read(entry);
  const drawn = rows.slice(0, limit);
  const span = table.span?.(entry, drawn) ?? WHOLE;
  table.element.replaceChildren(
    make("thead", {}, make("tr", {}, columns.map(column => headCell(table, column)))),
    make("tbody", {}, drawn.map(a => make("tr", {class: rowClass(table, entry, a)},
      rowCells(columns, a, span)))));
  if (!rows.length) {
    table.element.append(make("tbody", {}, make("tr", {}, make("td", {colspan: columns.length},
      "No combination matches the filter."))));
  }
  updateMore(table, rows.length, limit);
}

/** Rows that are marked, and the one that was chosen.
 * @param {ColumnTable} table @param {Entry} entry @param {number} a */
function rowClass(table, entry, a) {
  const name = table.columns(entry).find(column => column.key === "combination")?.text(a);
  return [table.isMarked?.(entry, a) ? "equal" : "", name && name === state.get("decide.pick") ? "picked" : ""].filter(Boolean).join(" ") || null;
}

/** @param {ColumnTable} table @param {Column} column */
function headCell(table, column) {
  const {key, down} = sortOrder(table);
  const sorted = key === column.key ? (down ? "descending" : "ascending") : null;
  const button = make("button", {type: "button", title: column.title, onclick: () => sortBy(table, column)}, column.label);
  return make("th", {scope: "col", class: column.number ? "number" : null, "data-key": column.key,
    "aria-sort": sorted}, button);
}

/** The first click sorts the better values first, the second click the worse ones.
 * @param {ColumnTable} table @param {Column} column */
function sortBy(table, column) {
  const {key, down} = sortOrder(table);
  const next = key === column.key ? !down : table.downFirst(currentEntry(), column);
  state.set({[`${table.prefix}sort`]: column.key === table.natural && !next ? null : `${next ? "-" : ""}${column.key}`});
  /** @type {HTMLElement | null} */
  const heading = table.element.querySelector(`th[data-key="${CSS.escape(column.key)}"] button`);
  heading?.focus();
  announce(`Sorted by ${column.label}, ${next ? "descending" : "ascending"}.`);
}

/** Cells in the order of the columns; the name of the combination is the row heading.
 * @param {Column[]} columns @param {number} a @param {Span} span */
function rowCells(columns, a, span) {
  return columns.map(column => {
    const content = column.cell?.(a, span) ?? column.text(a);
    return column.key === "combination"
      ? make("th", {scope: "row"}, make("button", {type: "button", class: "link", "data-combination": column.text(a)}, content))
      : make("td", {class: column.number ? "number" : column.kind}, content);
  });
}

/** @param {ColumnTable} table @param {number} count @param {number} limit */
function updateMore(table, count, limit) {
  /** @param {string} label @param {string | null} rows */
  const button = (label, rows) => make("button", {type: "button", class: "quiet",
    onclick: () => state.set({[`${table.prefix}rows`]: rows})}, label);
  table.more.replaceChildren(
    `${Math.min(limit, count)} of ${counted(count, "row")} `,
    ...(count > limit ? [
      limit < 50 && count > 50 ? button("Show 50", "50") : "", button(`Show all ${count}`, "all")] : []),
    ...(state.get(`${table.prefix}rows`) ? [button("Show fewer", null)] : []));
}

/** @param {ColumnTable} table @param {Entry} entry @param {Column[]} columns */
function updateChooser(table, entry, columns) {
  const picked = new Set(columns.map(column => column.key));
  table.chooser.replaceChildren(
    ...table.columns(entry).map(column => {
      const box = make("input", {type: "checkbox", checked: picked.has(column.key),
        onchange: () => pickColumn(table, entry, column.key, box.checked)});
      return make("label", {title: column.title}, box, column.label);
    }),
    make("button", {type: "button", class: "quiet",
      onclick: () => state.set({[`${table.prefix}columns`]: null})}, "Default columns"));
}

/** @param {ColumnTable} table @param {Entry} entry @param {string} key @param {boolean} wanted */
function pickColumn(table, entry, key, wanted) {
  const picked = new Set(shownColumns(table, entry).map(column => column.key));
  if (wanted) picked.add(key);
  else picked.delete(key);
  const columns = table.columns(entry).map(column => column.key);
  state.set({[`${table.prefix}columns`]: columns.filter(each => picked.has(each)).join(",")});
  table.chooser.querySelectorAll("input")[columns.indexOf(key)]?.focus();
}

/** @param {ColumnTable} table */
function saveColumnTable(table) {
  const entry = currentEntry();
  const columns = table.columns(entry);
  saveCsv(fileStem(entry.name, table.id), columns.map(column => column.key),
    sortedRows(table, entry).map(a => columns.map(column => column.value(a))));
}
