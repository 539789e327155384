/* Detector x descriptor, a panel for each norm and matcher. */

const HEAT_MAP = {
  id: "heat", title: "Detector and descriptor", wide: true,
  read: "A panel for each norm and matcher; brighter is better. Hatched cells cannot run (the reason is "
    + "shown on hover); empty ones were not measured or do not pass the filter.",
  controls: [{name: "value", label: "Value", options: measureOptions, fallback: () => "score"}],
  draw(context) {
    const {entry, narrow, shown: rows} = context;
    const measure = measureOf(entry, context.option("value"));
    const panels = heatPanels(entry, rows);
    const detectors = inOrder(entry.detector, rows);
    const descriptors = inOrder(entry.descriptor, rows);
    const columns = narrow || panels.length === 1 ? 1 : 2;
    const lines = Math.ceil(panels.length / columns);
    const cell = narrow ? 18 : 24;
    const panelHeight = detectors.length * cell + 84;
    const [low, high] = boundsOf(rows.map(a => measure.values[a]).filter(isKnown));
    const drawn = panels.map((panel, i) => heatTraces(context, measure, panel, detectors, descriptors, i, [low, high]));
    const layout = {
      margin: {t: 8, r: narrow ? 4 : 16},
      annotations: [],
      coloraxis: {colorscale: SCALE, cmin: low, cmax: high, reversescale: measure.better === "lower",
        colorbar: {orientation: "h", thickness: 10, len: narrow ? 0.9 : 0.4, x: 0.5, y: 1,
          yref: "container", yanchor: "top", ypad: 4, outlinewidth: 0,
          title: {text: safe(measure.label), side: "top"}}},
    };
    const height = lines * panelHeight + 84;
    panels.forEach((panel, i) => placePanel(layout, panel, i, {columns, lines, detectors, descriptors, narrow, cell}));
    Object.assign(layout.margin, {t: 84, b: 0, l: widestText(detectors, narrow ? 9 : 10) + 10});
    return {
      data: drawn.flat(), layout, height,
      summary: heatSummary(entry, rows, measure),
    };
  },
};

function inOrder(methods, rows) {
  const present = new Set(rows.map(a => methods[a]));
  return [...new Set(methods)].filter(name => present.has(name));
}

function heatPanels(entry, rows) {
  const keys = [...new Set(rows.map(a => JSON.stringify([entry.norm[a], entry.matcher[a]])))];
  return keys.map(key => JSON.parse(key)).sort((a, b) => b[0].localeCompare(a[0]) || a[1].localeCompare(b[1]));
}

function heatTraces({entry, shown: rows, colours, width, narrow}, measure, [norm, matcher], detectors, descriptors, i, [low, high]) {
  const at = new Map(rows.map(a => [entry.combinations[a], a]));
  const reasons = payload.incompatible ?? {};
  const [z, text, hover] = [[], [], []];
  const hatched = {x: [], y: [], hover: []};
  for (const detector of detectors) {
    const line = descriptors.map(descriptor => {
      const name = [detector, descriptor, norm, matcher].join("-");
      const a = at.get(name);
      if (a === undefined && Object.hasOwn(reasons, name)) {
        hatched.x.push(safe(descriptor));
        hatched.y.push(safe(detector));
        hatched.hover.push(`<b>${safe(name)}</b><br>cannot run: ${wrapped(reasons[name])}`);
      }
      return a === undefined ? [null, "", ""] : heatCell(entry, measure, a);
    });
    z.push(line.map(each => each[0]));
    text.push(line.map(each => each[1]));
    hover.push(line.map(each => each[2]));
  }
  const axes = {xaxis: `x${i + 1}`, yaxis: `y${i + 1}`};
  const roomy = !narrow && width / 2 / descriptors.length > 30;
  return [
    {type: "heatmap", name: safe(`${norm} ${matcher}`), x: descriptors.map(safe), y: detectors.map(safe), z,
      customdata: hover, hovertemplate: "%{customdata}<extra></extra>", hoverongaps: false,
      coloraxis: "coloraxis", xgap: 1, ygap: 1, ...axes},
    ...(roomy ? cellTexts({x: descriptors.map(safe), y: detectors.map(safe), z, texts: text, size: 9, axes, isBright: value => {
      const share = (value - low) / (high - low || 1);
      return isBrightOnScale(measure.better === "lower" ? 1 - share : share);
    }}) : []),
    {type: "scatter", mode: "markers", name: "not in the table", x: hatched.x, y: hatched.y, hovertext: hatched.hover,
      hoverinfo: "text", showlegend: false, ...axes,
      marker: {symbol: "line-ne-open", size: narrow ? 9 : 11, color: colours.hatch, line: {width: 1.2, color: colours.hatch}}},
  ];
}

function heatCell(entry, measure, a) {
  const value = measure.values[a];
  const rank = isKnown(entry.score.rank[a]) ? `<br>rank ${entry.score.rank[a]}` : "";
  return [value, cellText(value), `<b>${safe(entry.combinations[a])}</b><br>${safe(measure.label)} `
    + `${safe(valueText(measure.key, value))}${rank}<br>succeeds on ${safe(percent(entry.score.success_rate[a]))}`];
}

/* At most four characters. */
function cellText(value) {
  if (!isKnown(value)) return "";
  if (value >= 10000) return `${Math.round(value / 1000)}k`;
  if (value >= 1000) return `${(value / 1000).toFixed(1)}k`;
  if (value >= 10) return String(Math.round(value));
  return value >= 1 ? value.toFixed(1) : value.toFixed(2).replace(/^0/, "");
}

function wrapped(text, length = 60) {
  const lines = [""];
  for (const word of String(text).split(" ")) {
    if (lines[lines.length - 1].length + word.length > length) lines.push("");
    lines[lines.length - 1] += `${word} `;
  }
  return lines.map(line => safe(line.trim())).join("<br>");
}

function placePanel(layout, [norm, matcher], i, {columns, lines, detectors, descriptors, narrow, cell}) {
  const [line, column] = [Math.floor(i / columns), i % columns];
  const gap = columns > 1 ? 0.1 : 0;
  const wide = (1 - gap * (columns - 1)) / columns;
  const tall = 1 / lines;
  const top = 1 - line * tall;
  const bottom = top - tall * (detectors.length * cell / (detectors.length * cell + 84));
  const suffix = i ? String(i + 1) : "";
  const left = column * (wide + gap);
  layout[`xaxis${suffix}`] = {...categoryAxis(descriptors.map(safe)), autorange: true, automargin: false, domain: [left, left + wide],
    anchor: `y${i + 1}`, tickangle: -60, tickfont: {size: narrow ? 9 : 10}};
  layout[`yaxis${suffix}`] = {...categoryAxis(detectors.map(safe)), automargin: false, domain: [Math.max(bottom, 0), top],
    anchor: `x${i + 1}`, tickfont: {size: narrow ? 9 : 10}};
  layout.annotations.push({text: `<b>${safe(`${norm}, ${matcher}`)}</b>`, xref: "paper", yref: "paper", x: left,
    y: top, xanchor: "left", yanchor: "bottom", showarrow: false, font: {size: 12}});
}

function heatSummary(entry, rows, measure) {
  const known = rows.filter(a => isKnown(measure.values[a]));
  if (!known.length) return `No combination has a value of ${measure.label}`;
  const sign = measure.better === "lower" ? -1 : 1;
  const best = known.reduce((a, b) => (sign * measure.values[b] > sign * measure.values[a] ? b : a));
  return `Best by ${measure.label}: ${entry.combinations[best]}, ${valueText(measure.key, measure.values[best])}`;
}
