/* The table of all combinations: sorted, filtered, with columns to choose and a file to save. */

const ROWS_AT_FIRST = 15;
const ranking = {};

function buildRankingTable(parent) {
  ranking.table = make("table", {class: "ranking", id: "ranking"});
  ranking.chooser = make("div", {class: "chooser"});
  ranking.more = make("div", {class: "more"});
  ranking.read = make("p", {class: "read"});
  parent.append(
    make("h3", {id: "title-all"}, "All combinations"), ranking.read,
    make("div", {class: "controls"},
      disclosure("Columns", ranking.chooser),
      make("span", {class: "save"}, make("button", {type: "button", class: "quiet", id: "save-ranking",
        "aria-label": "Save the table as CSV", onclick: saveRanking}, "CSV"))),
    make("div", {class: "scroll", tabindex: "0", role: "region", "aria-labelledby": "title-all"}, ranking.table),
    ranking.more);
}

function shownColumns(entry) {
  const all = rankingColumns(entry);
  const wanted = state.get("columns").split(",").filter(Boolean);
  const picked = all.filter(column => wanted.includes(column.key));
  return picked.length ? picked : all.filter(column => column.usual);
}

function sortOrder() {
  const text = state.get("sort", "rank");
  return text.startsWith("-") ? {key: text.slice(1), down: true} : {key: text, down: false};
}

/* Positions in the order that was asked for; what has no value comes last. */
function sortedRows(entry) {
  const {key, down} = sortOrder();
  const column = rankingColumns(entry).find(each => each.key === key);
  const rows = [...shownIn(entry)];
  if (!column || (key === "rank" && !down)) return rows;
  const known = rows.filter(a => column.value(a) !== null);
  const lacking = rows.filter(a => column.value(a) === null);
  const compare = column.number
    ? (a, b) => column.value(a) - column.value(b)
    : (a, b) => compareTexts(String(column.value(a)), String(column.value(b)));
  known.sort((a, b) => (down ? compare(b, a) : compare(a, b)));
  return [...known, ...lacking];
}

function compareTexts(first, second) {
  const [a, b] = [first.toLowerCase(), second.toLowerCase()];
  return a < b ? -1 : Number(a > b);
}

function updateRankingTable(changed) {
  const entry = currentEntry();
  const columns = shownColumns(entry);
  const rows = sortedRows(entry);
  const limit = state.get("rows") === "all" ? rows.length : Number(state.get("rows", ROWS_AT_FIRST));
  if (changed.has("entry") || changed.has("columns")) updateChooser(entry, columns);
  ranking.read.textContent = readingOfTable(entry);
  const drawn = rows.slice(0, limit);
  const span = scoreSpan(entry.score, drawn);
  ranking.table.replaceChildren(
    make("thead", {}, make("tr", {}, columns.map(column => headCell(column)))),
    make("tbody", {}, drawn.map(a => rankingRow(entry, columns, a, span))));
  if (!rows.length) {
    ranking.table.append(make("tbody", {}, make("tr", {}, make("td", {colspan: columns.length},
      "No combination passes the filter."))));
  }
  updateMore(rows.length, limit);
}

function readingOfTable(entry) {
  const tested = entry.score.p_value?.some(isKnown);
  return "Click a heading to sort; the bar beside CUES is its 95\u00a0% interval, on one scale for all rows shown"
    + `${tested ? "; rows with a dot are the best and those that cannot be told from it" : ""}. Other columns are means over the pairs that did not fail.`;
}

function headCell(column) {
  const {key, down} = sortOrder();
  const sorted = key === column.key ? (down ? "descending" : "ascending") : null;
  const button = make("button", {type: "button", title: column.title, onclick: () => sortBy(column)}, column.label);
  return make("th", {scope: "col", class: column.number ? "number" : null, "data-key": column.key,
    "aria-sort": sorted}, button);
}

/* First click: the better end first; second: the other. */
function sortBy(column) {
  const {key, down} = sortOrder();
  const better = measureOf(currentEntry(), column.key)?.better;
  const downFirst = better === "higher" || ["probability_best", "probability_top", "score_low",
    "score_high", "p_value", "repeats"].includes(column.key);
  const next = key === column.key ? !down : downFirst;
  state.set({sort: column.key === "rank" && !next ? null : `${next ? "-" : ""}${column.key}`});
  document.querySelector(`#ranking th[data-key="${CSS.escape(column.key)}"] button`)?.focus();
  announce(`Sorted by ${column.label}, ${next ? "descending" : "ascending"}.`);
}

/* From the lowest to the highest end of the intervals that are shown. */
function scoreSpan(score, rows) {
  const ends = rows.flatMap(a => [score.score_low?.[a], score.score[a], score.score_high?.[a]]).filter(isKnown);
  return ends.length ? spanOf(ends) : [0, 1];
}

function rankingRow(entry, columns, a, span) {
  const equal = a === entry.score.best || entry.score.indistinguishable.includes(a);
  return make("tr", {class: equal ? "equal" : null}, columns.map(column => {
    const content = column.cell?.(a, span) ?? column.text(a);
    return column.key === "combination"
      ? make("th", {scope: "row"}, content)
      : make("td", {class: column.number ? "number" : null}, content);
  }));
}

function updateMore(count, limit) {
  const button = (label, rows) => make("button", {type: "button", class: "quiet",
    onclick: () => state.set({rows})}, label);
  ranking.more.replaceChildren(
    `${Math.min(limit, count)} of ${counted(count, "row")} `,
    ...(count > limit ? [
      limit < 50 && count > 50 ? button("Show 50", "50") : "", button(`Show all ${count}`, "all")] : []),
    ...(state.get("rows") ? [button("Show fewer", null)] : []));
}

function updateChooser(entry, columns) {
  const picked = new Set(columns.map(column => column.key));
  ranking.chooser.replaceChildren(
    ...rankingColumns(entry).map(column => make("label", {title: column.title},
      make("input", {type: "checkbox", checked: picked.has(column.key),
        onchange: event => pickColumn(entry, column.key, event.target.checked)}), column.label)),
    make("button", {type: "button", class: "quiet", onclick: () => state.set({columns: null})}, "Usual columns"));
}

function pickColumn(entry, key, wanted) {
  const picked = new Set(shownColumns(entry).map(column => column.key));
  if (wanted) picked.add(key);
  else picked.delete(key);
  const columns = rankingColumns(entry).map(column => column.key).filter(each => picked.has(each));
  state.set({columns: columns.join(",")});
  const label = rankingColumns(entry).findIndex(column => column.key === key);
  ranking.chooser.querySelectorAll("input")[label]?.focus();
}

function saveRanking() {
  const entry = currentEntry();
  const columns = rankingColumns(entry);
  saveCsv(fileStem(entry.name, "ranking"), columns.map(column => column.key),
    sortedRows(entry).map(a => columns.map(column => column.value(a))));
}
