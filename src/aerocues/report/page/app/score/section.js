/* Section 2: the score itself. */

import {COMPONENTS} from "./components.js";
import {HEAT_MAP} from "./heat-map.js";
import {SCORE_DOTS} from "./score-dots.js";
import {WEIGHTS} from "./weights.js";
import {addFigure} from "../shell/figure.js";

/** @type {SectionSpec} */
export const SCORE_SECTION = {
  id: "score",
  title: "CUES",
  read: "Where good scores come from: which detector suits which descriptor, how much the best differ, "
    + "and the weights of the criteria.",
  build(body) {
    for (const spec of [HEAT_MAP, SCORE_DOTS, WEIGHTS, COMPONENTS]) addFigure(body, spec);
  },
};
