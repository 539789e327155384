/* Section 5: how far the ranking can be trusted, and how it carries over. */

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
  read: "How far the ranking can be trusted: what depends on choices made in the scoring, what other methods of "
    + "decision make of the same numbers, and whether it carries over to other images and machines.",
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
  const head = [make("h3", {}, "When some are left out"),
    make("p", {class: "read"}, "Scores belong to what is compared: a part of the combinations is left out at random, and the rest is ranked again.")];
  if (!found) return [...head, make("p", {class: "nothing"}, "A single combination cannot be ranked again.")];
  return [...head, figuresList([
    ["Left out each time", percent(found.share)], ["Rounds", shown(found.rounds)],
    ["The best stays the best in", percent(found.best_kept)],
    ["Others move by", `${shown(found.mean_shift, 2)} places on average, ${shown(found.largest_shift)} at most`],
    ["Correlation with the whole", `${fixed(found.spearman_mean, 4)} on average, ${fixed(found.spearman_lowest, 4)} at least`]])];
}
