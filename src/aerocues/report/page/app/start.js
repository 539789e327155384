/* Starts the page: the first screen at once, figures of Plotly as soon as it is unpacked. */

import {applyTheme, darkWanted} from "./basis/colours.js";
import {state} from "./basis/state.js";
import {refreshClouds} from "./models/clouds.js";
import {DECIDE_SECTION} from "./decide/section.js";
import {buildDrawer} from "./drawer/drawer.js";
import {isHere, openCombination} from "./drawer/combination.js";
import {TABLE_SECTION} from "./table/section.js";
import {SCORE_SECTION} from "./score/section.js";
import {QUALITY_SECTION} from "./quality/section.js";
import {TIME_SECTION} from "./time/section.js";
import {RELATIONS_SECTION} from "./relations/section.js";
import {PICTURES_SECTION} from "./pictures/section.js";
import {MODELS_SECTION} from "./models/section.js";
import {METHOD_SECTION} from "./method/section.js";
import {drawFigure, drawStale, drawWaiting, figures, onChosen, refreshFigures} from "./shell/figure.js";
import {startPlotly, unpackPlotly} from "./shell/plotly.js";
import {addSection, buildMasthead, buildSections, buildToolbar, followScrolling, goTo, updateSections, updateToolbar} from "./shell/shell.js";

/* In the order of the page. */
const SECTIONS = [DECIDE_SECTION, TABLE_SECTION, SCORE_SECTION, QUALITY_SECTION, TIME_SECTION, RELATIONS_SECTION, PICTURES_SECTION,
  MODELS_SECTION, METHOD_SECTION];

function start() {
  for (const section of SECTIONS) addSection(section);
  state.read();
  applyTheme();
  buildMasthead();
  buildSections();
  buildDrawer();
  onChosen(name => { if (isHere(name)) openCombination(name); });
  document.addEventListener("click", event => {
    const chosen = event.target instanceof Element ? event.target.closest("[data-combination]") : null;
    if (chosen instanceof HTMLElement || chosen instanceof SVGElement) openCombination(chosen.dataset.combination ?? "");
  });
  const toolbar = buildToolbar();
  const update = (/** @type {Set<string>} */ changed) => {
    applyTheme();
    updateToolbar(toolbar);
    updateSections(changed);
    refreshFigures(changed);
  };
  update(new Set(["entry"]));
  state.onChange(update);
  window.addEventListener("hashchange", () => {
    const changed = state.read();
    if (changed.size) update(changed);
    else goTo(location.hash.slice(1));
  });
  darkWanted.addEventListener("change", () => update(new Set(["theme"])));
  followScrolling();
  unpackPlotly(drawWaiting);
  window.addEventListener("beforeprint", drawForPrint);
  window.addEventListener("afterprint", () => {
    document.documentElement.classList.remove("printing");
    applyTheme();
    refreshClouds();
    for (const figure of figures) figure.stale = true;
    drawStale();
  });
  if (location.hash && !location.hash.includes("=")) goTo(location.hash.slice(1));
}

/* The printed page is light and narrow, and has every figure, or says that it was not drawn yet. */
function drawForPrint() {
  document.documentElement.classList.add("printing");
  startPlotly();
  applyTheme();
  refreshClouds();
  for (const figure of figures) drawFigure(figure);
}

start();
