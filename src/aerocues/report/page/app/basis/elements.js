/* Elements. Text goes in as text nodes only, so nothing in data can become markup. */

export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "class") element.className = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat(Infinity).filter(child => child !== null && child !== undefined));
  return element;
}

/* Text for Plotly, which reads some tags and entities. */
export function safe(text) {
  return String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}

/* An SVG element with text and children. */
export function makeSvg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children.flat(Infinity));
  return element;
}

/* Shows what stands in `data-tip` of the part of a drawing under the pointer. */
export function withTips(svg) {
  const tip = document.getElementById("tip");
  const show = event => {
    const text = event.target.dataset?.tip;
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

export function announce(text) {
  document.getElementById("announcer").textContent = text;
}

/* A table of plain rows. A column: {label, text(row), number: bool, title}. */
export function plainTable(caption, columns, rows) {
  const kind = column => (column.number ? "number" : null);
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

export function disclosure(summary, ...content) {
  return make("details", {class: "disclosure"}, make("summary", {}, summary), ...content);
}

export function figuresList(pairs) {
  return make("dl", {}, pairs.filter(Boolean).map(([term, value]) =>
    make("div", {}, make("dt", {}, term), make("dd", {}, value))));
}
