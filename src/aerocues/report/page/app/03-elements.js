/* Elements. Text goes in as text nodes only, so nothing in data can become markup. */

function make(tag, attributes = {}, ...children) {
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
function safe(text) {
  return String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}

function announce(text) {
  document.getElementById("announcer").textContent = text;
}

/* A table of plain rows. A column: {label, text(row), number: bool, title}. */
function plainTable(caption, columns, rows) {
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

function disclosure(summary, ...content) {
  return make("details", {class: "disclosure"}, make("summary", {}, summary), ...content);
}
