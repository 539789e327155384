/* Section 3: quality by pair, by combination, along transformations and against the ground truth. */

import {CURVES} from "./curves.js";
import {DISTRIBUTIONS} from "./distributions.js";
import {TRUTH, TRUTH_MATRIX} from "./ground-truth.js";
import {INLIERS_MATCHES, PRECISION_RECALL} from "./scatter.js";
import {addFigure} from "../shell/figure.js";

/** @type {SectionSpec} */
export const QUALITY_SECTION = {
  id: "quality",
  title: "Quality",
  read: "How good the matches are, how much this varies between pairs, how it decreases with more difficult images, "
    + "and, where available, how it compares with the ground truth.",
  build(body) {
    for (const spec of [DISTRIBUTIONS, PRECISION_RECALL, INLIERS_MATCHES, CURVES, TRUTH, TRUTH_MATRIX]) {
      addFigure(body, spec);
    }
  },
};
