/* The shape of the payload: everything that the page shows, as report/payload.py writes it. Numbers that are not
   known are null. `combinations` and other lists of one value a combination are in the same order. */

interface Payload {
  title: string;
  made: string;
  version: string;
  entries: Entry[];
  comparison: Comparison | null;
  machines: MachinePair[];
  /** Reasons by combination. */
  incompatible: Record<string, string>;
  /** By the keys that pictures name. */
  images: Record<string, Thumbnail>;
  pictures: Picture[];
  clouds: Cloud[];
  maps: FlightMap[];
  method: MethodFacts;
}

type Better = "higher" | "lower" | null;
type Value = number | null;
/** Rows of rows. */
type Matrix = Value[][];
/** Numbers as base64; `u16` from `low` to `high`, with 65535 for no value. */
type Packed = {f32: string} | {u8: string} | {u16: string; low: number; high: number};
type Numbers = Float32Array | Uint8Array;
type Json = string | number | boolean | null | Json[] | {[name: string]: Json | undefined};
/** Facts, or the reason why there are none. */
type OrReason<Facts> = (Facts & {unavailable?: undefined}) | ({unavailable: string} & {[Name in keyof Facts]?: undefined});

/** The four parts of combinations, one value a combination each. */
interface Methods {
  combinations: string[];
  detector: string[];
  descriptor: string[];
  norm: string[];
  matcher: string[];
}
type Code = "detector" | "descriptor" | "norm" | "matcher";

/** One dataset on one machine. */
interface Entry extends Methods {
  name: string;
  dataset: string;
  machine: string | null;
  preset: string;
  timing: string;
  geometry: string | null;
  pairs: Pair[];
  curves: Curve[];
  statuses: string[];
  /** Positions in `statuses`, combinations by pairs. */
  status: Packed;
  columns: Record<string, PairColumn>;
  score: Score;
  /** Scores by each preset of scoring that the measurements suffice for. */
  preset_scores: Record<string, Value[]>;
  /** Descriptors of one image. */
  megabytes: Value[];
  race: Race | null;
  medians: Record<Stage | "total", Value[]>;
  validation: Validation;
  models: Models | null;
  /** Rows by status. */
  counts: Record<string, number>;
  failures: Failure[];
  failures_left_out: number;
  excluded: Exclusion[];
  /** As in run.json; empty where that is about another dataset. */
  run: {[name: string]: Json};
}
type Stage = "detect" | "describe" | "match" | "verify";

/** What a race found, or that none was finished. */
type Race = {unfinished: true} | RaceAnswer;
interface RaceAnswer {
  unfinished?: undefined;
  dataset: string;
  objective: string;
  title: string;
  best: string;
  leader: string;
  probability: number;
  ended: string;
  seconds: number;
  combinations: number;
  measured: number;
  measurements: number;
  pairs: number;
  candidates: number;
  ranked: {combination: string; score: number; probability: number; pairs: number; succeeded: number}[];
  final: {images: number; of: number; order?: string[]; models: string[]; unfinished: string[]} | null;
}

interface Pair {
  pair: number;
  sequence: string | null;
  image_1: string;
  image_2: string;
  step: Value;
}

/** Pairs along a graded transformation, and how far along it each is. */
interface Curve {
  name: string;
  axis: string;
  pairs: number[];
  x: number[];
}

interface PairColumn {
  unit: string;
  better: Better;
  definition: string;
  /** Combinations by pairs. */
  values: Packed;
}

type Aspect = "accuracy" | "quantity" | "speed" | "other";

interface Criterion {
  name: string;
  better: "higher" | "lower";
  description: string;
  aspect: Aspect;
  reconstruction: boolean;
}

/** A ranking; positions are those of combinations. */
interface Score extends Record<ScoreFigure, Value[]> {
  criteria: Criterion[];
  means: Record<string, Value[]>;
  normalised: Record<string, Value[]>;
  /** The last method is the aggregate. */
  weights: {methods: string[]; values: Record<string, Value[]>};
  settings: ScoreSettings;
  best: number;
  indistinguishable: number[];
  untested: number[];
  units: number;
  fastest_good: number | null;
  best_binary: number | null;
}
type ScoreFigure = "rank" | "rank_low" | "rank_high" | "score" | "score_low" | "score_high" | "probability_best"
  | "probability_top" | "p_value" | "success_rate" | "repeats";

interface ScoreSettings {
  criteria: string[];
  resamples: number;
  resampled: string;
  good: number;
  top_k: number;
  [name: string]: Json;
}

interface Validation {
  alpha: Variants;
  aggregation: Variants;
  criterion_left_out: Variants;
  agreement: OrReason<Variants>;
  criteria_correlation: {names: string[]; correlation: Matrix};
  hierarchies: Record<string, Component[]>;
  pareto: {criteria: string[]; front: number[]};
  rank_reversal: RankReversal | null;
  critical_difference: OrReason<CriticalDifference>;
}

/** Rankings under several choices: their correlations, and what is best in each. */
interface Variants {
  names: string[];
  correlation: Matrix;
  best: string[];
}

interface Component {
  name: string;
  mean: number;
  max: number;
  standard_deviation: Value;
  /** Combinations with it, and measurements of them. */
  alternatives: number;
  evaluations: number;
  best: string;
}

interface RankReversal {
  share: number;
  rounds: number;
  mean_shift: number;
  largest_shift: number;
  spearman_mean: Value;
  spearman_lowest: Value;
  best_kept: number;
}

interface CriticalDifference {
  alternatives: string[];
  mean_ranks: number[];
  critical_difference: number;
  /** First and last of each group without significant difference. */
  groups: [number, number][];
  units: number;
  chi_square: Value;
  p_value: number;
  f_statistic: Value;
  f_p_value: Value;
}

interface Failure {
  status: string;
  detector: string;
  descriptor: string;
  rows: number;
  message: string | null;
}

interface Exclusion {
  reason: string;
  combinations: string[];
  pairs: number;
}

/** Reconstructions, with one value a reconstruction in each list. */
interface Models extends Methods {
  status: string[];
  message: (string | null)[];
  columns: ModelColumn[];
  values: Record<string, Value[]>;
  /** The combination whose model distances are measured to. */
  reference: string | null;
  /** Meanings by status. */
  statuses: Record<string, string>;
  made: Record<string, string | number>;
  /** COLMAP's default, where it is one of them. */
  baseline: string | null;
  relations: OrReason<Relations>;
}

interface ModelColumn {
  name: string;
  unit: string;
  better: Better;
  definition: string;
}

/** Correlations of what was measured of pairs with what became of the models, features by outcomes. */
interface Relations {
  combinations: string[];
  features: string[];
  outcomes: string[];
  /** Of the combinations, by feature and by outcome. */
  values: Record<string, Value[]>;
  pearson: Matrix;
  spearman: Matrix;
  /** Combinations behind each correlation. */
  numbers: number[][];
  fewest: number;
}

/** Several entries side by side. */
interface Comparison {
  names: string[];
  spearman: Matrix;
  kendall: Matrix;
  /** Combinations that two entries share. */
  shared: number[][];
  versatility: Versatility[];
}

interface Versatility {
  alternative: string;
  mean: Value;
  min: Value;
  spread: Value;
  mean_rank: Value;
  worst_rank: Value;
  rankings: number;
  scores: Value[];
  ranks: Value[];
}

/** The same dataset on two machines. */
interface MachinePair {
  first: string;
  second: string;
  spearman: Value;
  kendall: Value;
  times: StageTimes[] | {unavailable: string};
}

interface StageTimes {
  stage: string;
  rows: number;
  first_seconds: number;
  second_seconds: number;
  ratio: number;
  ratio_low: number;
  ratio_high: number;
  rank_correlation: Value;
}

/** Where images were taken: `x` to the east, `y` to the north; metres, unless only their order is known. `ground` has the
 * corners of what an image shows, from its top left one clockwise, where that is known. */
interface FlightMap {
  entry: string;
  known: "truth" | "gps" | "order";
  images: {name: string; x: number; y: number; src: string | null; ground: [number, number][] | null}[];
}

interface Thumbnail {
  src: string;
  width: number;
  height: number;
  /** Pixels of the picture for one of the image. */
  scale: number;
}

/** Keypoints and matches of one combination on one pair. */
interface Picture {
  entry: string;
  combination: string;
  pair: number;
  image_1: string;
  image_2: string;
  /** x and y of each. */
  keypoints_1: Packed;
  keypoints_2: Packed;
  keypoints_every: number;
  /** x and y in both images of each. */
  matches: Packed;
  /** 1 for an inlier. */
  inlier: Packed;
  /** 1 for a match that is right within 3 px by the judge; null where nothing tells. */
  right: Packed | null;
  judge: string | null;
  matches_every: number;
  why: string;
  role: string | null;
  note: string | null;
  figures: Record<string, string | number>;
}

/** Points and cameras of one model. */
interface Cloud {
  entry: string;
  combination: string;
  why: string;
  unit: string;
  all_points: number;
  strays: number;
  /** x, y and z of each; likewise `centres` and `positions`, the true centres. */
  points: Packed | null;
  colours: Packed;
  errors: Packed | null;
  track_lengths: Packed;
  distances: Packed | null;
  centres: Packed;
  /** Nine numbers a camera, by rows. */
  rotations: Packed;
  positions: Packed;
  /** Of the images of the cameras. */
  names: string[];
  /** Focal length, width and height of the camera in pixels. */
  view: [number, number, number];
}

interface MethodFacts {
  columns: {name: string; unit: string; definition: string; better: Better}[];
  criteria: Criterion[];
  statuses: {name: string; meaning: string}[];
  words: {word: string; meaning: string}[];
  citation: string;
  notes: string[];
}
