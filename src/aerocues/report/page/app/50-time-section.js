/* Section 4: time. */

addSection({
  id: "time",
  title: "Time",
  read: "What a combination costs: detecting and describing one image, matching and verifying one pair, on one core. "
    + "Medians over the pairs.",
  available: entry => entry.medians?.total?.some(isKnown) || hasColumn(entry, "total_seconds"),
  build(body) {
    for (const spec of [STAGES_FIGURE, PER_THOUSAND, BY_METHOD, MATCHERS, MACHINES]) addFigure(body, spec);
  },
});

const STAGES = ["detect", "describe", "match", "verify"];

function hasStages(entry) {
  return STAGES.some(stage => entry.medians?.[stage]?.some(isKnown))
    ? true : "Only total times are known, not those of the stages.";
}

function stageColour(colours, stage) {
  return {detect: colours.series[0], describe: colours.series[1], match: colours.series[2], verify: colours.series[5]}[stage];
}

function totalMedians(entry) {
  return entry.medians?.total?.some(isKnown) ? entry.medians.total : mediansOf(entry, "total_seconds");
}

const ORDERS = {name: "order", label: "Which", fallback: () => "score", options: () => [
  {key: "score", label: "best by CUES"}, {key: "fast", label: "fastest"}, {key: "slow", label: "slowest"}]};

function inTimeOrder({entry, shown: rows}, order, values) {
  const known = rows.filter(a => isKnown(values[a]));
  if (order === "score") return known;
  return known.sort((a, b) => (order === "fast" ? 1 : -1) * (values[a] - values[b]));
}

/* Ticks of a logarithmic axis of seconds, as durations. */
function secondsAxis(scale, values, title = "time") {
  if (scale !== "log") return {title: `${title}, s`, rangemode: "tozero"};
  return {title, ...logAxis(values, duration)};
}
