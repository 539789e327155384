/* What the parts of the page hand to each other. A number `a` is the position of a combination, `m` of a model. */

type Theme = "light" | "dark";

interface Colours {
  ink: string;
  muted: string;
  grid: string;
  line: string;
  surface: string;
  series: string[];
  faint: string;
  hatch: string;
}

/** One value a combination, to put on an axis. */
interface Measure {
  key: string;
  label: string;
  better: Better;
  values: Value[];
}

/* Elements and tables */

type Content = Node | string | null | undefined | Content[];

/** A column of a plain table. */
interface PlainColumn<Row> {
  label: string;
  text(row: Row): Content;
  number?: boolean;
  title?: string;
}

/** What a file of comma-separated values holds: the names of its columns, and its rows. */
type Table = [header: string[], rows: unknown[][]];

/** The ends of what a table shows, for bars in its cells. */
type Span = [low: number, high: number];

/** A column of a table of combinations or models, of which `usual` ones are shown at first. */
interface Column {
  key: string;
  label: string;
  title?: string;
  value(a: number): string | Value;
  text(a: number): string;
  /** In place of the text. */
  cell?(a: number, span: Span): Content;
  number?: boolean;
  usual?: boolean;
  /** A class of its cells. */
  kind?: string;
}

/** A table that is sorted by its headings. What is sorted and shown stands in the state under `prefix`. */
interface ColumnTableSpec {
  id: string;
  title: string;
  prefix: string;
  /** The column in whose order `rows` come. */
  natural: string;
  columns(entry: Entry): Column[];
  rows(entry: Entry): number[];
  read(entry: Entry): string;
  downFirst(entry: Entry, column: Column): boolean;
  isMarked?(entry: Entry, a: number): boolean;
  /** Of the rows that are shown. */
  span?(entry: Entry, rows: number[]): Span;
}

interface ColumnTable extends ColumnTableSpec {
  element: HTMLTableElement;
  chooser: HTMLElement;
  more: HTMLElement;
  words: HTMLElement;
}

/* The answer */

/** A combination for a purpose; `a` and `m` are null where no pairs were measured, or no model was built. */
interface Candidate {
  name: string;
  a: number | null;
  m: number | null;
  /** Higher is better. */
  value: number;
  text: string;
}

interface Purpose {
  key: string;
  label: string;
  meaning(entry: Entry): string;
  available?(entry: Entry): boolean;
  /** Of the combinations that match the filter, the best first. */
  rank(entry: Entry, rows: number[]): Candidate[];
}

/* Controls */

interface Option {
  key: string;
  label: string;
  group?: string;
}

/** A choice; its key in the state is `figure.name`. */
interface ControlSpec {
  name: string;
  label: string;
  options(entry: Entry): Option[];
  fallback?(entry: Entry): string | null | undefined;
}

interface Control {
  element: HTMLElement;
  refresh(): void;
  value(): string;
}

/** A box to tick; its key in the state is `figure.key`, a class of the same name its colour. */
interface LayerSpec {
  key: string;
  label: string;
  shown: boolean;
}

interface Layer {
  element: HTMLElement;
  refresh(): void;
  value(): boolean;
}

/* Figures */

interface FigureContext {
  entry: Entry;
  /** Combinations that pass the filter, the best first. */
  shown: number[];
  width: number;
  narrow: boolean;
  theme: Theme;
  colours: Colours;
  /** The value of a control. */
  option(name: string): string;
}

/** A figure: for Plotly, as a drawing, or the reason why there is none. */
type Drawn = PlotDrawn | SvgDrawn | EmptyDrawn;

interface PlotDrawn {
  data: Trace[];
  layout: Layout;
  height: number;
  /** A line below the figure. */
  note?: string | null;
  /** What it says, for those who do not see it; the note by default. */
  summary?: string;
  svg?: undefined;
  empty?: undefined;
}

interface SvgDrawn {
  svg(): SVGSVGElement;
  height: number;
  table: Table;
  note?: string | null;
  summary?: string;
  empty?: undefined;
}

interface EmptyDrawn {
  empty: string;
  note?: undefined;
  summary?: undefined;
  svg?: undefined;
}

interface FigureSpec {
  id: string;
  title: string;
  /** How to read it. */
  read: string;
  controls?: ControlSpec[];
  /** True, or the reason why there is nothing. */
  available?(entry: Entry): true | string;
  draw(context: FigureContext): Drawn;
  wide?: boolean;
  tall?: boolean;
  /** Whether it shows all combinations, whatever the filter. */
  ignoresFilter?: boolean;
  /** Whether it shows combinations of all entries. */
  acrossEntries?: boolean;
  /** Whether parts of it are buttons. */
  isOperated?: boolean;
  /** Whether it shows the answer, or what was chosen. */
  showsAnswer?: boolean;
}

interface Figure extends Omit<FigureSpec, "controls"> {
  element: HTMLElement;
  plot: HTMLElement;
  noteElement: HTMLElement;
  controls: Record<string, Control>;
  /** Whether it is out of date. */
  stale: boolean;
  /** Whether it waits for Plotly. */
  waits: boolean;
  /** Whether it is in the window or close to it. */
  near: boolean;
  /** Of the latest drawing. */
  width: number;
}

/* Scatter plots that are drawn without Plotly */

/** Limits of an axis; of a logarithmic one as powers of 10. */
interface AxisRange {
  isLog: boolean;
  low: number;
  high: number;
}

interface Tick {
  at: number;
  text: string;
}

/** Values as pixels; the inverse gives limits as a range has them. */
interface Scale {
  at(value: number): number;
  inverse(pixel: number): number;
  ticks: Tick[];
}

interface ScatterAxis {
  title: string;
  words(value: number): string;
  range: AxisRange;
}

interface SeriesStyle {
  color: string;
  symbol: string;
}

interface ScatterPoint {
  x: number;
  y: number;
  name: string;
  hollow: boolean;
  tip: string;
}

/** A point where it is drawn, in pixels. */
interface Spot extends ScatterPoint {
  px: number;
  py: number;
}

interface ScatterMark {
  x: number;
  y: number;
  symbol: "star" | "ring";
}

interface ScatterLabel {
  x: number;
  y: number;
  text: string;
  bold: boolean;
  dx: number;
  dy: number;
}

/** Edges of the part inside the axes. */
interface PlotBox {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

interface Scatter {
  id: string;
  width: number;
  height: number;
  narrow: boolean;
  colours: Colours;
  x: ScatterAxis;
  y: ScatterAxis;
  groups: {name: string; style: SeriesStyle; points: ScatterPoint[]}[];
  line: {x: number; y: number}[];
  marks: ScatterMark[];
  labels: ScatterLabel[];
  open(name: string): void;
  /** Of x and y, in place of all values. */
  zoomed: AxisRange[] | null;
  /** Remembers what is shown larger for the next drawing; null: all. */
  keepZoom(ranges: AxisRange[] | null): void;
}

/* Sections */

interface SectionSpec {
  id: string;
  title: string;
  read: string;
  /** The level that begins with it. */
  level?: string;
  build(body: HTMLElement): void;
  /** Whether there is anything to show; by default there is. */
  available?(entry: Entry): boolean;
  /** Called with the keys of the state that changed; "entry" is among them at first. */
  update?(body: HTMLElement, changed: Set<string>): void;
}

interface Section extends SectionSpec {
  body: HTMLElement;
  element: HTMLElement;
}

/* Pictures and clouds */

interface PicturePanel {
  side: string;
  canvas: HTMLCanvasElement;
  title: HTMLElement;
  note: HTMLElement;
  words: HTMLElement;
  element: HTMLElement;
  picture: Picture | null;
}

interface CloudPanel {
  side: string;
  canvas: HTMLCanvasElement;
  title: HTMLElement;
  note: HTMLElement;
  words: HTMLElement;
  element: HTMLElement;
  cloud: Cloud | null;
  /** One colour a point, as `cloud-space` packs it. */
  pixels: Uint32Array | null;
}

/** Degrees about the vertical and above the horizon, and how near the eye is. */
interface Turn {
  yaw: number;
  pitch: number;
  zoom: number;
}

type Place = [x: number, y: number, z: number];

/** The ball that is in view at zoom 1. */
interface Stage3D {
  centre: Place;
  radius: number;
}

/** Writes x, y and distance from the eye on a canvas; whether the place is before the eye. */
type Projection = (x: number, y: number, z: number, out: number[]) => boolean;

/** What points can be coloured by; `limits` are shares of the sorted values at which the colours end, so that a few
 * outliers do not take them all, or null for 0. */
interface PointColour {
  key: string;
  label: string;
  unit(cloud: Cloud): string;
  values(cloud: Cloud): Numbers;
  limits: [low: number | null, high: number];
}

/** All that a drawing of a cloud needs; sizes are in pixels of the canvas. */
interface CloudDrawing {
  cloud: Cloud;
  pixels: Uint32Array;
  turn: Turn;
  stage: Stage3D;
  /** Of the points, 1 by default. */
  size: number;
  /** Whether cameras and their true places are drawn. */
  cameras: boolean;
  truth: boolean;
  colours: Colours;
  ground: number;
}
