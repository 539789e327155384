/* Starts the page: tables at once, figures as soon as Plotly, which comes last, is there. */

function start() {
  state.read();
  applyTheme();
  buildMasthead();
  buildSections();
  const toolbar = buildToolbar();
  const update = changed => {
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
  document.addEventListener("DOMContentLoaded", drawStale);
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

/* Paper is light and narrow, and shows every figure, seen or not. */
function drawForPrint() {
  document.documentElement.classList.add("printing");
  applyTheme();
  refreshClouds();
  for (const figure of figures) drawFigure(figure);
}

start();
