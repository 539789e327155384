/* The shell of the page: masthead, toolbar with filter, chips and contents, and the sections. */

import {themeName} from "../basis/colours.js";
import {elementOf, make} from "../basis/elements.js";
import {CODES, entries} from "../basis/entries.js";
import {chosenChips, isFiltered, shownIn, unknownWords} from "../basis/filter.js";
import {LIMITS} from "../basis/limits.js";
import {listed} from "../basis/numbers.js";
import {payload} from "../basis/payload.js";
import {currentEntry, state} from "../basis/state.js";
import {explained} from "../basis/words.js";
import {buildLimits, updateLimits} from "./limits-panel.js";

/** @type {Section[]} */
const sections = [];

/** @param {SectionSpec} spec */
export function addSection(spec) {
  const body = make("div", {class: "body"});
  const element = make("section", {id: spec.id, "aria-labelledby": `title-${spec.id}`},
    make("h2", {id: `title-${spec.id}`, tabindex: "-1"}, spec.title),
    make("p", {class: "read"}, explained(spec.read)), body);
  sections.push({...spec, body, element});
}

export function buildMasthead() {
  const {title, made, version} = payload;
  const day = String(made).replace("T", " ").slice(0, 16);
  elementOf("masthead").append(
    make("div", {}, make("h1", {}, title),
      make("p", {class: "byline"}, `Detectors, descriptors and matchers compared by aerocues ${version}, ${day}`)));
  elementOf("colophon").append(
    `Made by aerocues ${version}. This page is a single file. It works offline and sends no data.`);
}

export function buildToolbar() {
  const filter = make("input", {
    type: "search", id: "filter", placeholder: "orb -flann", autocomplete: "off",
    spellcheck: "false", "aria-describedby": "filter-help filter-count",
    oninput: () => state.set({q: filter.value.trim() ? filter.value : null}),
  });
  const clear = make("button", {type: "button", class: "quiet", id: "filter-clear", onclick: () => {
    state.set({q: null, ...Object.fromEntries([...CODES, ...LIMITS].map(key => [key, null]))});
    filter.focus();
  }}, "Clear");
  const themes = make("button", {type: "button", class: "quiet", id: "theme", onclick: () =>
    state.set({theme: themeName() === "dark" ? "light" : "dark"})});
  const limits = buildLimits();
  closeByLeaving(limits);
  elementOf("toolbar").append(
    make("div", {class: "bar"},
      buildEntryChoice(),
      make("label", {class: "filter", for: "filter"}, make("span", {class: "word"}, "Filter"), filter),
      make("output", {id: "filter-count", for: "filter"}),
      clear, buildChips(), limits, themes),
    make("p", {class: "hint", id: "filter-help"}),
    make("nav", {"aria-label": "Sections", id: "contents"}, sections.flatMap(section => [
      section.level === "Explore" ? make("span", {class: "level-name", "aria-hidden": "true"}, "Explore") : "",
      make("a", {href: `#${section.id}`, onclick: (/** @type {Event} */ event) => { event.preventDefault(); goTo(section.id); }},
        section.title)])));
  return {filter, clear, themes};
}

function buildEntryChoice() {
  if (entries.length < 2) return null;
  const select = make("select", {id: "entry", onchange: () =>
    state.set({entry: select.value === entries[0].name ? null : select.value})},
  entries.map(entry => make("option", {value: entry.name}, entry.name)));
  return make("label", {class: "control", for: "entry"}, make("span", {class: "word"}, "Dataset"), select);
}

function buildChips() {
  const groups = CODES.map(code => {
    const names = [...new Set(entries.flatMap(entry => entry[code]))];
    return make("div", {class: "chips", role: "group", "aria-label": code},
      make("span", {class: "chip-title"}, code),
      names.map(name => make("button", {
        type: "button", class: "chip", "data-code": code, "data-name": name, "aria-pressed": "false",
        onclick: () => toggleChip(code, name),
      }, name)));
  });
  const panel = make("details", {class: "methods", id: "methods"},
    make("summary", {id: "methods-summary"}, "Methods"),
    make("div", {class: "panel"}, groups));
  closeByLeaving(panel);
  return panel;
}

/** Escape or a click outside closes an open panel.
 * @param {HTMLDetailsElement} panel */
function closeByLeaving(panel) {
  document.addEventListener("click", event => {
    if (event.target instanceof Node && !panel.contains(event.target)) panel.open = false;
  });
  panel.addEventListener("keydown", event => {
    if (event.key !== "Escape" || !panel.open) return;
    panel.open = false;
    panel.querySelector("summary")?.focus();
  });
}

/** @param {Code} code @param {string} name */
function toggleChip(code, name) {
  const chips = chosenChips(code);
  if (!chips.delete(name)) chips.add(name);
  state.set({[code]: [...chips].join(",")});
}

export function buildSections() {
  const main = elementOf("sections");
  for (const section of sections) {
    if (section.level) main.append(make("p", {class: "level"}, section.level));
    main.append(section.element);
    section.build(section.body);
  }
}

/** @param {string} id */
export function goTo(id) {
  const element = document.getElementById(id);
  if (!element) return;
  // Without smooth scrolling: figures on the way would be drawn, grow and shift the target.
  element.scrollIntoView({behavior: "instant", block: "start"});
  element.querySelector("h2")?.focus({preventScroll: true});
}

/** @param {ReturnType<typeof buildToolbar>} toolbar */
export function updateToolbar({filter, clear, themes}) {
  const entry = currentEntry();
  const shownNow = shownIn(entry).length;
  const unknown = unknownWords();
  if (document.activeElement !== filter || filter.value.trim() !== state.get("q").trim()) {
    filter.value = state.get("q");
  }
  const select = document.getElementById("entry");
  if (select instanceof HTMLSelectElement) select.value = entry.name;
  clear.hidden = !isFiltered();
  elementOf("filter-count").textContent =
    `${shownNow} of ${entry.combinations.length}`;
  elementOf("filter-help").textContent = unknown.length
    ? `No method of any combination begins with ${listed(unknown.map(word => `“${word}”`), "or")}.`
    : "“orb -flann”: with ORB, without FLANN. “or sift daisy”: with SIFT or DAISY. “not l2”: without L2. The filter applies to everything below.";
  elementOf("filter-help").classList.toggle("warning", unknown.length > 0);
  themes.textContent = themeName() === "dark" ? "Light" : "Dark";
  themes.setAttribute("aria-label", `Show in ${themeName() === "dark" ? "light" : "dark"} colours`);
  updateChips(entry);
  updateLimits();
}

/** @param {Entry} entry */
function updateChips(entry) {
  let count = 0;
  /** @type {NodeListOf<HTMLElement>} */
  const chips = document.querySelectorAll(".chip[data-code]");
  for (const chip of chips) {
    const [code, name] = [/** @type {Code} */ (chip.dataset.code), chip.dataset.name ?? ""];
    const pressed = chosenChips(code).has(name);
    count += pressed ? 1 : 0;
    chip.setAttribute("aria-pressed", String(pressed));
    chip.classList.toggle("absent", !entry[code].includes(name));
  }
  elementOf("methods-summary").textContent = count ? `Methods (${count})` : "Methods";
}

/** @param {Set<string>} changed */
export function updateSections(changed) {
  const entry = currentEntry();
  for (const section of sections) {
    const available = section.available?.(entry) ?? true;
    section.element.hidden = !available;
    linkTo(section.id).hidden = !available;
    if (available) section.update?.(section.body, changed);
  }
}

/** The link to a section in the contents.
 * @param {string} id @returns {HTMLElement} */
function linkTo(id) {
  const link = document.querySelector(`#contents a[href="#${id}"]`);
  if (!(link instanceof HTMLElement)) throw new Error(`the contents have no link to ${id}`);
  return link;
}

/** Scrolls the contents sideways, on narrow screens, so that a link is in the middle.
 * @param {HTMLElement} link */
function bringIntoView(link) {
  const contents = elementOf("contents");
  contents.scrollLeft = link.offsetLeft - (contents.clientWidth - link.offsetWidth) / 2;
}

/* Marks the visible section in the contents. */
export function followScrolling() {
  const observer = new IntersectionObserver(seen => {
    for (const {target, isIntersecting} of seen) {
      const link = linkTo(target.id);
      if (isIntersecting) {
        link.setAttribute("aria-current", "true");
        bringIntoView(link);
      }
      else link.removeAttribute("aria-current");
    }
  }, {rootMargin: "-35% 0px -60% 0px"});
  for (const section of sections) observer.observe(section.element);
}
