/* All combinations with their scores, to sort, filter and save. */

import {elementOf, make} from "../basis/elements.js";
import {currentEntry} from "../basis/state.js";
import {factsSentence} from "../decide/answer-card.js";
import {addColumnTable, updateColumnTable} from "../shell/column-table.js";
import {RANKING} from "./ranking-table.js";

/** @type {SectionSpec} */
export const TABLE_SECTION = {
  id: "table",
  title: "Table",
  level: "Explore",
  read: "Every combination that was measured. Click a name for its details.",
  build(body) {
    const all = make("div", {id: "all"});
    body.append(make("p", {class: "facts", id: "facts"}), all);
    addColumnTable(all, RANKING);
  },
  update(_, changed) {
    if ([...changed].every(key => (key.includes(".") && key !== "decide.pick") || key === "theme")) return;
    if (changed.has("entry")) elementOf("facts").textContent = factsSentence(currentEntry());
    updateColumnTable(RANKING, changed);
  },
};
