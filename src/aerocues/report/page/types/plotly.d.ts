/* What the page uses of Plotly, which stands behind the program in the page. */

interface Trace {
  type: string;
  name?: string;
  [attribute: string]: any;
}

interface Layout {
  [attribute: string]: any;
}

interface Axis {
  [attribute: string]: any;
}

interface PlotlyLibrary {
  react(element: HTMLElement, data: Trace[], layout: Layout, config: object): void;
  purge(element: HTMLElement): void;
  toImage(figure: {data: Trace[]; layout: Layout; config: object},
    options: {format: string; width: number; height: number; scale: number}): Promise<string>;
}

/** An element with a figure in it. */
interface PlotlyElement extends HTMLElement {
  on(name: "plotly_click", listener: (event: {points: {data: Trace; pointIndex: number}[]}) => void): void;
}

declare const Plotly: PlotlyLibrary;

interface Window {
  Plotly?: PlotlyLibrary;
}
