/* Level 1: which combination to take, how sure that is, and the flight. */

import {make} from "../basis/elements.js";
import {addFigure} from "../shell/figure.js";
import {buildAnswer, updateAnswer} from "./answer-card.js";
import {FLIGHT_MAP, mapOf} from "./flight-map.js";
import {SPEED_QUALITY} from "./speed-quality.js";
import {currentEntry} from "../basis/state.js";

const seen = make("div", {class: "seen"});

/** @type {SectionSpec} */
export const DECIDE_SECTION = {
  id: "answer",
  title: "Decide",
  read: "The best combination for these images and a purpose, and how certain this is.",
  build(body) {
    body.append(buildAnswer(), seen);
    addFigure(seen, SPEED_QUALITY);
    addFigure(seen, FLIGHT_MAP);
  },
  update(_, changed) {
    const own = [...changed].some(key => (!key.includes(".") && !["theme", "sort", "columns", "rows"].includes(key)) || key.startsWith("decide."));
    if (own) updateAnswer();
    seen.classList.toggle("without-map", !mapOf(currentEntry()));
  },
};
