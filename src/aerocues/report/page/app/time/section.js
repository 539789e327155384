/* Section 4: time. */

import {hasColumn} from "../basis/entries.js";
import {isKnown} from "../basis/numbers.js";
import {addFigure} from "../shell/figure.js";
import {BY_METHOD, MATCHERS} from "./by-method.js";
import {MACHINES} from "./machines.js";
import {PER_THOUSAND} from "./per-thousand.js";
import {STAGES_FIGURE} from "./stages.js";

/** @type {SectionSpec} */
export const TIME_SECTION = {
  id: "time",
  title: "Time",
  read: "The time that a combination needs to detect and describe one image and to match and verify one pair, on one core. "
    + "Medians over the pairs.",
  available: entry => entry.medians?.total?.some(isKnown) || hasColumn(entry, "total_seconds"),
  build(body) {
    for (const spec of [STAGES_FIGURE, PER_THOUSAND, BY_METHOD, MATCHERS, MACHINES]) addFigure(body, spec);
  },
};
