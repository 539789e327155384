/* Numbers and names for display. */

export const NONE = "–";

/** @param {unknown} value @returns {value is number} */
export function isKnown(value) {
  return Number.isFinite(value);
}

/* Made once: `toLocaleString` makes one each time, which takes longer than all else that is written in a table. */
const THOUSANDS = new Intl.NumberFormat("en");

/** Three significant digits; whole numbers from 100, with a separator of thousands.
 * @param {Value} value @param {number} [digits] */
export function shown(value, digits = 3) {
  if (!isKnown(value)) return NONE;
  const size = Math.abs(value);
  if (Number.isInteger(value) || size >= 100) return THOUSANDS.format(Math.round(value));
  if (size > 0 && size < 1e-3) return value.toExponential(1);
  return String(Number(value.toPrecision(digits)));
}

/** A score, always with the same number of decimals.
 * @param {Value} value @param {number} [decimals] */
export function fixed(value, decimals = 3) {
  return isKnown(value) ? value.toFixed(decimals) : NONE;
}

/** @param {Value} value */
export function percent(value) {
  if (!isKnown(value)) return NONE;
  if (value > 0 && value < 0.01) return "< 1\u00a0%";
  if (value < 1 && value > 0.99) return "> 99\u00a0%";
  return `${Math.round(100 * value)}\u00a0%`;
}

/** @param {Value} seconds */
export function duration(seconds) {
  if (!isKnown(seconds)) return NONE;
  if (seconds < 1e-3) return `${shown(1e6 * seconds, 2)} µs`;
  if (seconds < 1) return `${shown(1e3 * seconds)} ms`;
  if (seconds < 120) return `${shown(seconds)} s`;
  if (seconds >= 600) return `${THOUSANDS.format(Math.round(seconds / 60))} min`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)} min${whole % 60 ? ` ${whole % 60} s` : ""}`;
}

/** @param {number} number @param {string} noun @param {string} [plural] */
export function counted(number, noun, plural = `${noun}s`) {
  return `${THOUSANDS.format(number)} ${number === 1 ? noun : plural}`;
}

/** 1st, 2nd, 3rd, 4th.
 * @param {number} number */
export function ordinal(number) {
  const teen = Math.floor(number / 10) % 10 === 1;
  return `${number}${teen ? "th" : (["th", "st", "nd", "rd"][number % 10] ?? "th")}`;
}

/** @param {string[]} words @param {string} [last] */
export function listed(words, last = "and") {
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} ${last} ${words[words.length - 1]}`;
}

/** @type {Record<string, string>} */
const LABELS = {
  "ref_matches@3": "right matches", "ref_precision@3": "share of right matches", "ref_matching_score@3": "right matches / keypoints",
  seconds_per_1k_ref_matches: "seconds per 1k right matches", score: "CUES", f1_score: "F1 score", points_3d: "3D points",
  f1_beyond_chance: "F1 beyond chance", total_seconds: "total time", detect_seconds: "detection time",
  describe_seconds: "description time", match_seconds: "matching time", verify_seconds: "verification time",
  position_rmse: "position RMSE", position_error_share: "position error / extent",
  cloud_distance_median: "C2C median", cloud_distance_rms: "C2C RMS", cloud_distance_p95: "C2C 95th percentile",
  reference_distance_median: "C2C reverse, median", reference_distance_rms: "C2C reverse, RMS",
  reference_distance_p95: "C2C reverse, 95th percentile", reconstruction_seconds: "reconstruction time",
  links_x_coverage: "links × coverage", links_x_expected_quality: "links × expected quality", expected_quality: "expected quality", model_quality: "quality of the model",
};

/** A column's name in words: `gt_precision@3` as "true precision at 3 px".
 * @param {string} name */
export function labelOf(name) {
  if (Object.hasOwn(LABELS, name)) return LABELS[name];
  const [stem, threshold] = name.split("@");
  const words = stem.replace(/^gt_/, "true ").replace(/^ref_matches$/, "right matches").replace(/^ref_precision$/, "share of right matches").replace(/auc$/, "AUC").replaceAll("_", " ");
  if (!threshold) return words;
  return `${words} at ${threshold}${stem.startsWith("pose") ? "°" : " px"}`;
}

/** Seconds as durations, shares with three decimals, counts as numbers.
 * @param {string} name @param {Value} value */
export function valueText(name, value) {
  if (/seconds/.test(name)) return duration(value);
  return isShare(name) ? fixed(value) : shown(value);
}

/** @param {string} name */
export function isShare(name) {
  return /precision|recall|repeatability|^f1_|_auc@|matching_score|^score$|success_rate/.test(name);
}

/** @param {string} name */
export function isGroundTruth(name) {
  return /^gt_|_auc@|^homography_error$|^pose_/.test(name);
}

/** @param {string} text */
export function sentenceCase(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/**
 * The least and the greatest of some numbers: "3 to 7", or "5" where they are equal.
 * @param {number[]} numbers
 */
export function span(numbers) {
  const [low, high] = [Math.min(...numbers), Math.max(...numbers)];
  return low === high ? `${low}` : `${low} to ${high}`;
}
