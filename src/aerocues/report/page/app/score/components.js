/* The scores of each detector, descriptor, norm or matcher over all its combinations. */

import {safe} from "../basis/elements.js";
import {counted, fixed} from "../basis/numbers.js";
import {categoryAxis, heightOfRows} from "../shell/axes.js";

/** @type {FigureSpec} */
export const COMPONENTS = {
  id: "components", title: "Scores by method", ignoresFilter: true,
  read: "The bar goes from the mean score of all combinations with a method to the best of them. A long bar means "
    + "that the score depends on what the method is combined with. The filter does not apply.",
  controls: [{name: "of", label: "By", options: entry => Object.keys(entry.validation.hierarchies)
    .map(key => ({key, label: key.replaceAll("_", " ").replaceAll("-", " and ")}))}],
  available: entry => (Object.keys(entry.validation.hierarchies).length ? true : "No scores by method were computed."),
  draw({entry, colours, option}) {
    const rows = entry.validation.hierarchies[option("of")].slice(0, 40);
    const labels = rows.map(row => safe(row.name));
    const hover = rows.map(row => `<b>${safe(row.name)}</b><br>mean ${fixed(row.mean)} ± ${fixed(row.standard_deviation)}`
      + `<br>best ${fixed(row.max)}: ${safe(row.best)}<br>${counted(row.evaluations, "measurement")}`);
    const common = {y: labels, hovertext: hover, hoverinfo: "text"};
    return {
      data: [
        {...common, type: "bar", orientation: "h", name: "not in the table", showlegend: false, base: rows.map(row => row.mean),
          x: rows.map(row => row.max - row.mean), marker: {color: colours.faint}, width: 0.35},
        {...common, type: "scatter", mode: "markers", name: "mean", x: rows.map(row => row.mean),
          marker: {color: colours.series[0], size: 9, symbol: "circle"}},
        {...common, type: "scatter", mode: "markers", name: "best", x: rows.map(row => row.max),
          marker: {color: colours.series[1], size: 9, symbol: "diamond"}},
      ],
      height: heightOfRows(rows.length, 100),
      layout: {xaxis: {title: "CUES"}, yaxis: categoryAxis(labels), hovermode: "closest"},
    };
  },
};
