/* Section 3: quality, pair by pair, against each other, along transformations, against the truth. */

import {CURVES} from "./curves.js";
import {DISTRIBUTIONS} from "./distributions.js";
import {TRUTH, TRUTH_MATRIX} from "./ground-truth.js";
import {INLIERS_MATCHES, PRECISION_RECALL} from "./scatter.js";
import {addFigure} from "../shell/figure.js";

/** @type {SectionSpec} */
export const QUALITY_SECTION = {
  id: "quality",
  title: "Quality",
  read: "How good the matches are: how much that varies from pair to pair, how it falls with the difficulty "
    + "of the images, and what the ground truth says where there is one.",
  build(body) {
    for (const spec of [DISTRIBUTIONS, PRECISION_RECALL, INLIERS_MATCHES, CURVES, TRUTH, TRUTH_MATRIX]) {
      addFigure(body, spec);
    }
  },
};
