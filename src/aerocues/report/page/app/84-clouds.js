/* Two clouds side by side, turned together: by dragging, keys, buttons, or by themselves. */

const stillWanted = window.matchMedia("(prefers-reduced-motion: reduce)");
const cloudView = {turn: {...FRONT}, playing: false};
const CLOUD_LAYERS = [
  {key: "cameras", label: "Cameras", shown: true},
  {key: "truth", label: "True positions", shown: true},
];
const DEGREES_A_SECOND = 14;
const STEPS = {ArrowLeft: {yaw: 8}, ArrowRight: {yaw: -8}, ArrowUp: {pitch: 6}, ArrowDown: {pitch: -6}, "+": {zoom: 1.25}, "=": {zoom: 1.25}, "-": {zoom: 0.8}};
const TURNS = [
  ["◀", "Turn to the left", "ArrowLeft"], ["▶", "Turn to the right", "ArrowRight"], ["▲", "See more from above", "ArrowUp"],
  ["▼", "See more from the side", "ArrowDown"], ["+", "Nearer", "+"], ["−", "Farther", "-"],
];

function cloudsOf(entry) {
  return remember(entry, "clouds", () => (payload.clouds ?? []).filter(cloud => cloud.entry === entry.name));
}

/* Clouds of combinations that pass the filter; all, if none does. */
function cloudsToShow(entry) {
  const passes = currentFilter();
  const found = cloudsOf(entry).filter(cloud => passes(cloud.combination.split("-")));
  return found.length ? found : cloudsOf(entry);
}

function cloudChoice(name, label, place) {
  return {name, label,
    options: entry => cloudsToShow(entry).map(({combination, why}) => ({key: combination, label: `${combination} (${why})`})),
    fallback: entry => (cloudsToShow(entry)[place] ?? cloudsToShow(entry)[0])?.combination};
}

const CLOUD_COLOURS = {name: "colour", label: "Colours", fallback: () => "image",
  options: entry => POINT_COLOURS.filter(kind => kind.key === "image" || cloudsOf(entry).some(cloud => sortedKnown(kind.values(cloud)).length))
    .map(({key, label}) => ({key, label}))};

function buildClouds(parent) {
  const controls = {left: selectControl("cloud", cloudChoice("left", "First", 0)),
    right: selectControl("cloud", cloudChoice("right", "Second", 1)), colour: selectControl("cloud", CLOUD_COLOURS)};
  const layers = CLOUD_LAYERS.map(layer => layerControl("cloud", layer));
  const play = make("button", {type: "button", class: "quiet", id: "turn-clouds", "aria-pressed": "false", hidden: stillWanted.matches, onclick: () => setPlaying(!cloudView.playing)}, "Turn");
  const buttons = TURNS.map(([sign, label, key]) => make("button", {type: "button", class: "quiet", "aria-label": label, title: label, onclick: () => turnBy(key)}, sign));
  const panels = ["left", "right"].map(side => buildCloudPanel(side));
  const legend = make("div", {class: "cloud-legend"});
  Object.assign(cloudView, {controls, layers, panels, play, legend});
  parent.append(
    make("h3", {}, "Clouds"),
    make("p", {class: "read"}, "Both are seen from the same place. Drag to turn, or use the arrow keys; + and − come nearer and go away, Home "
      + "turns back. A ring marks where a camera truly was, and a line leads to it from where the model has it: long lines, a bent model."),
    make("div", {class: "controls"}, [...Object.values(controls), ...layers].map(control => control.element), make("span", {class: "save"}, play, buttons)),
    legend, make("div", {class: "panels"}, panels.map(panel => panel.element)));
}

function buildCloudPanel(side) {
  const canvas = make("canvas", {role: "img", tabindex: "0", "data-side": side});
  const panel = {side, canvas, title: make("h4"), note: make("p", {class: "note"}), words: make("div", {class: "words"})};
  const save = make("button", {type: "button", class: "quiet", "aria-label": `Save the ${side} cloud as PNG`,
    onclick: () => canvas.toBlob(blob => saveFile(`${fileStem(currentEntry().name, "cloud", panel.title.textContent)}.png`, blob))}, "PNG");
  panel.element = make("article", {class: "panel-of-cloud"}, make("div", {class: "panel-title"}, panel.title, save), canvas, panel.note, panel.words);
  listenToTurns(canvas);
  new ResizeObserver(() => drawClouds()).observe(panel.element);
  return panel;
}

function refreshClouds() {
  if (cloudsOf(currentEntry()).length) updateClouds();
}

function updateClouds() {
  for (const control of [...Object.values(cloudView.controls), ...cloudView.layers]) control.refresh();
  const clouds = cloudsOf(currentEntry());
  cloudView.stage = remember(currentEntry(), "stage", () => stageOf(clouds));
  for (const panel of cloudView.panels) {
    const combination = cloudView.controls[panel.side].value();
    panel.cloud = clouds.find(cloud => cloud.combination === combination) ?? null;
    panel.title.textContent = combination ?? "";
    panel.words.replaceChildren(...cloudWords(panel.cloud));
    panel.note.textContent = cloudNote(panel.cloud);
  }
  colourClouds();
  drawClouds();
}

/* The same colours mean the same in both. */
function colourClouds() {
  const kind = POINT_COLOURS.find(each => each.key === cloudView.controls.colour.value());
  const shownClouds = cloudView.panels.map(panel => panel.cloud).filter(Boolean);
  const limits = kind.values ? colourLimits(kind, shownClouds) : null;
  for (const panel of cloudView.panels) panel.pixels = panel.cloud && pointPixels(panel.cloud, kind, limits, themeName());
  cloudView.legend.hidden = !limits;
  if (!limits) return;
  const scale = make("span", {class: "scale", "aria-hidden": "true"});
  scale.style.background = `linear-gradient(to right, ${scaleColours(themeName()).filter((_, i) => i % 15 === 0).join(", ")})`;
  const [low, high] = limits.map(value => shown(value));
  cloudView.legend.replaceChildren(`${sentenceCase(kind.label)}: ${low} `, scale, ` ${high} ${kind.unit(shownClouds[0])} and more`);
}

function drawClouds() {
  const entry = currentEntry();
  if (!cloudsOf(entry).length || !cloudView.stage) return;
  const colours = THEMES[themeName()];
  const [cameras, truth] = cloudView.layers.map(layer => layer.value());
  for (const {canvas, cloud, pixels} of cloudView.panels) {
    const width = Math.floor(canvas.parentElement.clientWidth) - 2 * parseFloat(getComputedStyle(canvas.parentElement).paddingLeft);
    canvas.hidden = !cloud;
    if (!cloud || !pixels || width <= 0) continue;
    const height = Math.round(Math.min(460, Math.max(280, width * 0.72)));
    const density = Math.min(window.devicePixelRatio || 1, 2);
    const [wide, tall] = [width, height].map(size => Math.round(size * density));
    if (canvas.width !== wide || canvas.height !== tall) Object.assign(canvas, {width: wide, height: tall});
    canvas.style.height = `${height}px`;
    const view = {cloud, pixels, turn: cloudView.turn, stage: cloudView.stage, cameras, truth, colours, ground: pixelOf(colours.surface)};
    drawCloud(canvas.getContext("2d", {willReadFrequently: true}), view, wide, tall, density);
    canvas.setAttribute("aria-label", `Cloud of ${cloud.combination}. ${cloudNote(cloud)}`);
  }
}

/* What is drawn, and what is not. */
function cloudNote(cloud) {
  if (!cloud) return "There is no cloud of this combination.";
  const drawn = arrayOf(cloud.colours).length / 3;
  const left = cloud.all_points - cloud.strays - drawn;
  return [sentenceCase(cloud.why), left > 0 ? `${shown(drawn)} of ${counted(cloud.all_points, "point")} are drawn, chosen at random`
    : `${counted(drawn, "point")} are drawn`, cloud.strays ? `${counted(cloud.strays, "point")} far off left out` : null].filter(Boolean).join("; ") + ".";
}

const FIGURES_OF_CLOUDS = ["registered_images", "placed_images", "points_3d", "mean_track_length", "reprojection_error", "position_rmse",
  "cloud_distance_rms", "reference_distance_rms"];

function cloudWords(cloud) {
  const entry = currentEntry();
  const models = modelsOf(entry);
  const m = cloud ? models?.combinations.indexOf(cloud.combination) ?? -1 : -1;
  if (m < 0) return [];
  const rows = modelColumns(entry).filter(({key}) => FIGURES_OF_CLOUDS.includes(key)).map(column => [column.label, column.text(m)]);
  const reason = models.message[m];
  return [reason ? make("p", {class: "note"}, sentenceCase(reason)) : "", figuresList([["Status", models.status[m].replaceAll("_", " ")], ...rows])];
}
