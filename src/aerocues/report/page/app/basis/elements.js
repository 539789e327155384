/* Elements. Text is added as text nodes only, so that no data can become markup. */

/** The element with an id that the page has from the start.
 * @param {string} id */
export function elementOf(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element ${id}`);
  return element;
}

/** An element with attributes, listeners (`onclick`) and children.
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag @param {Record<string, any>} [attributes] @param {...Content} children */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "class") element.className = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...nodesOf(children));
  return element;
}

/** The nodes and texts in nested lists, without missing ones.
 * @param {Content} content @returns {(Node | string)[]} */
export function nodesOf(content) {
  if (Array.isArray(content)) return content.flatMap(nodesOf);
  return content === null || content === undefined ? [] : [content];
}

/** Text for Plotly, which reads some tags and entities.
 * @param {string} text */
export function safe(text) {
  return String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}

/** The text that `safe` made safe.
 * @param {string} text */
export function unsafe(text) {
  return text.replaceAll("&lt;", "<").replaceAll("&gt;", ">").replaceAll("&amp;", "&");
}

/** An SVG element with text and children.
 * @template {keyof SVGElementTagNameMap} Tag
 * @param {Tag} tag @param {Record<string, any>} [attributes] @param {...Content} children */
export function makeSvg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...nodesOf(children));
  return element;
}

/** @param {Event} event */
function tipOf({target}) {
  return target instanceof SVGElement ? target.dataset.tip ?? "" : "";
}

/** Shows a text beside the pointer: `data-tip` of the element under it, if nothing else is given.
 * @param {SVGSVGElement} svg @param {(event: PointerEvent) => string} [textAt] */
export function withTips(svg, textAt = tipOf) {
  const tip = elementOf("tip");
  /** @param {PointerEvent} event */
  const show = event => {
    const text = textAt(event);
    tip.hidden = !text;
    if (!text) return;
    tip.textContent = text;
    const {width, height} = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(4, Math.min(event.clientX + 12, window.innerWidth - width - 8))}px`;
    tip.style.top = `${event.clientY + 16 + height > window.innerHeight ? event.clientY - height - 10 : event.clientY + 16}px`;
  };
  svg.addEventListener("pointermove", show);
  svg.addEventListener("pointerdown", show);
  svg.addEventListener("pointerleave", () => { tip.hidden = true; });
  return svg;
}

/** @param {string} text */
export function announce(text) {
  elementOf("announcer").textContent = text;
}

/** A table of plain rows.
 * @template Row
 * @param {string} caption @param {PlainColumn<Row>[]} columns @param {Row[]} rows */
export function plainTable(caption, columns, rows) {
  const kind = (/** @type {PlainColumn<Row>} */ column) => (column.number ? "number" : null);
  return make("div", {class: "scroll", tabindex: "0", role: "region", "aria-label": caption},
    make("table", {class: "plain"},
      make("caption", {}, caption),
      make("thead", {}, make("tr", {}, columns.map(column =>
        make("th", {scope: "col", class: kind(column), title: column.title}, column.label)))),
      make("tbody", {}, rows.map(row => make("tr", {}, columns.map((column, position) => {
        const content = column.text(row);
        return position === 0
          ? make("th", {scope: "row", class: kind(column)}, content)
          : make("td", {class: kind(column)}, content);
      }))))));
}

/** @param {string} summary @param {...Content} content */
export function disclosure(summary, ...content) {
  return make("details", {class: "disclosure"}, make("summary", {}, summary), ...content);
}

/** A list of terms with their values, without missing ones.
 * @param {([string, Content] | null)[]} pairs */
export function figuresList(pairs) {
  return make("dl", {}, pairs.map(pair =>
    pair && make("div", {}, make("dt", {}, pair[0]), make("dd", {}, pair[1]))));
}
