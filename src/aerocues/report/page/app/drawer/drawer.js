/* A drawer at the side of the page with the details of what was clicked. */

import {make, nodesOf} from "../basis/elements.js";

const title = make("h2", {id: "drawer-title", tabindex: "-1"});
const content = make("div", {class: "drawer-content"});
const drawer = make("div", {id: "drawer", role: "dialog", "aria-labelledby": "drawer-title", hidden: true},
  make("div", {class: "panel-title"}, title,
    make("button", {type: "button", class: "quiet", onclick: () => closeDrawer()}, "Close")), content);
/** @type {HTMLElement | SVGElement | null} */
let before = null;

export function buildDrawer() {
  document.body.append(drawer);
  document.addEventListener("keydown", event => { if (event.key === "Escape" && !drawer.hidden) closeDrawer(); });
}

/** @param {string} name @param {Content} parts */
export function showDrawer(name, parts) {
  const active = document.activeElement;
  if (drawer.hidden && (active instanceof HTMLElement || active instanceof SVGElement)) before = active;
  title.textContent = name;
  content.replaceChildren(...nodesOf(parts));
  drawer.hidden = false;
  drawer.scrollTop = 0;
  title.focus({preventScroll: true});
}

export function closeDrawer() {
  drawer.hidden = true;
  before?.focus({preventScroll: true});
}
