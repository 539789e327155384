/* Section 5: how robust the ranking is, and whether it carries over. */

import {elementOf, figuresList, make} from "../basis/elements.js";
import {fixed, percent, shown} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {currentEntry} from "../basis/state.js";
import {RANKINGS_MATRIX, SLOPES, versatilityTable} from "./across.js";
import {CRITICAL} from "./critical-difference.js";
import {AGREEMENT, CRITERIA_MATRIX, SENSITIVITY} from "./sensitivity.js";
import {addFigure} from "../shell/figure.js";

/** @type {SectionSpec} */
export const RELATIONS_SECTION = {
  id: "relations",
  title: "Relations",
  read: "How robust the ranking is: its sensitivity to the settings of the score, its agreement with other decision methods, "
    + "and whether it carries over to other images and machines.",
  build(body) {
    for (const spec of [CRITERIA_MATRIX, SENSITIVITY, AGREEMENT, CRITICAL, SLOPES, RANKINGS_MATRIX]) addFigure(body, spec);
    body.append(make("div", {id: "reversal", class: "figure"}), make("div", {id: "versatility", class: "figure wide"}));
  },
  update(_, changed) {
    if ([...changed].every(key => key.includes(".") || key === "theme")) return;
    elementOf("reversal").replaceChildren(...reversalWords(currentEntry()));
    elementOf("versatility").replaceChildren(...versatilityTable());
    elementOf("versatility").hidden = !payload.comparison;
  },
};

/** @param {Entry} entry */
function reversalWords(entry) {
  const found = entry.validation.rank_reversal;
  const head = [make("h3", {}, "Rank reversal"),
    make("p", {class: "read"}, "A score depends on which combinations are compared. Here some combinations are removed at random and the others are ranked again.")];
  if (!found) return [...head, make("p", {class: "nothing"}, "This needs more than one combination.")];
  return [...head, figuresList([
    ["Removed each time", percent(found.share)], ["Rounds", shown(found.rounds)],
    ["The best stays first in", percent(found.best_kept)],
    ["Others move by", `${shown(found.mean_shift, 2)} ranks on average, ${shown(found.largest_shift)} at most`],
    ["Correlation with the full ranking", `${fixed(found.spearman_mean, 4)} on average, ${fixed(found.spearman_lowest, 4)} at least`]])];
}
