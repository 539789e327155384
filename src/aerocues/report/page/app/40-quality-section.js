/* Section 3: quality, pair by pair, against each other, along transformations, against the truth. */

addSection({
  id: "quality",
  title: "Quality",
  read: "How good the matches are: how much that varies from pair to pair, how it falls with the difficulty "
    + "of the images, and what the ground truth says where there is one.",
  build(body) {
    for (const spec of [DISTRIBUTIONS, PRECISION_RECALL, INLIERS_MATCHES, CURVES, TRUTH, TRUTH_MATRIX]) {
      addFigure(body, spec);
    }
  },
});

/* The first columns of these that an entry has, by pair. */
const QUALITY_COLUMNS = ["precision_beyond_chance", "precision", "f1_score", "inliers"];

function quantitiesOnly(name) {
  return !/seconds/.test(name);
}
