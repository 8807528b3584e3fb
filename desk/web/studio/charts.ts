/** The figures of the joint that is looked at, by their place; made once, then filled anew. */
const drawn = new Map();

const tableWidths = new ResizeObserver((entries) => {
  for (const { target } of entries) markWidth(target);
});

function watchTables(root) {
  for (const scroll of root.querySelectorAll(".scroll")) tableWidths.observe(scroll);
}

function makeFigure(block, place, host) {
  const root = figureElement(block, place);
  host.append(root);
  watchTables(root);
  const figure = figures.at(-1);
  drawn.set(place, figure);
  return figure;
}

/** Another content in the same picture: what is hidden or zoomed stays so. */
function refill(figure, block) {
  const root = figure.host.closest("figure");
  figure.block = block;
  figure.cursor = null;
  figure.host.style.height = `${figure.kind.height(block)}px`;
  root.querySelector("h3").textContent = block.title;
  // The legend's too: it is drawn anew only when somebody sees it, and is read out before.
  for (const hidden of root.querySelectorAll(".hidden-text")) hidden.textContent = ` of ${block.title}`;
  figure.legend?.setAttribute("aria-label", `Series of ${block.title}`);
  const scale = root.querySelector(".scale");
  if (scale !== null) scale.textContent = scaleWords(block);
  const words = root.querySelector("h3").id.replace(/-title$/, "-words");
  document.getElementById(words).textContent = figure.kind.words(block);
  refillRemark(root, block.note);
  const numbers = root.querySelector("details");
  const open = numbers.open;
  const anew = numbersElement(figure);
  anew.open = open;
  numbers.replaceWith(anew);
  watchTables(anew);
}

function refillRemark(root, note) {
  let remark = root.querySelector(":scope > .remark");
  if (note === "") return remark?.remove();
  if (remark === null) {
    remark = element("p", { class: "remark" });
    root.querySelector("details").before(remark);
  }
  remark.textContent = note;
}

function timeFigures() {
  return [...drawn.values()].filter(({ block }) => block.zoom_group);
}

function chartPixels() {
  const width = timeFigures()[0]?.host.clientWidth || document.documentElement.clientWidth;
  return Math.min(8000, Math.max(100, Math.round(width * (window.devicePixelRatio || 1))));
}

function chartAddress(look, range) {
  const parts = [`joint=${look.joint}`, `recording=${look.recording}`, `pixels=${chartPixels()}`];
  if (look.beside !== null) parts.push(`beside=${look.beside}`);
  if (range) parts.push(`from=${range.from}`, `to=${range.to}`);
  return `charts?${parts.join("&")}`;
}

let isDrawn = false;
/** All figures; from the first time on they follow the window. */
function drawEverything() {
  if (!isDrawn) {
    isDrawn = true;
    drawAll();
    return;
  }
  shareExtents();
  for (const figure of shownFigures()) drawFigure(figure);
}

/** The charts of another model, joint or recording. */
function showCharts(answer, host, fallHost) {
  const first = drawn.size === 0;
  answer.charts.forEach((block, index) => {
    const place = `chart.${index}`;
    if (drawn.has(place)) refill(drawn.get(place), block);
    else makeFigure(block, place, host);
  });
  if (drawn.has("fall.0")) refill(drawn.get("fall.0"), answer.waterfall);
  else makeFigure(answer.waterfall, "fall.0", fallHost);
  if (first) {
    drawEverything();
    for (const figure of timeFigures()) {
      figure.chart.on("datazoom", zoomed);
      followChart(figure);
    }
    return;
  }
  shareExtents();
  drawSoon(answer.charts.map((_, index) => drawn.get(`chart.${index}`)).concat(drawn.get("fall.0")));
}

/** Figures whose content is newer than their drawing: nobody sees them now. */
const stale = new Set();

/** What is in the window at once, the others as soon as there is nothing else to do, one by one. */
function drawSoon(figuresOf) {
  for (const figure of figuresOf) {
    if (isInWindow(figure)) drawNow(figure);
    else stale.add(figure);
  }
  whenIdle();
}

function isInWindow({ host }) {
  const { top, bottom } = host.getBoundingClientRect();
  return bottom > 0 && top < window.innerHeight;
}

function drawNow(figure) {
  stale.delete(figure);
  const { chart, host } = figure;
  if (chart && (chart.getWidth() !== host.clientWidth || chart.getHeight() !== host.clientHeight)) chart.resize();
  drawFigure(figure);
}

let isIdleAsked = false;
function whenIdle() {
  if (isIdleAsked || stale.size === 0) return;
  isIdleAsked = true;
  requestIdleCallback(
    () => {
      isIdleAsked = false;
      const [next] = stale;
      if (next) drawNow(next);
      whenIdle();
    },
    { timeout: 1000 },
  );
}

/** Whoever scrolls there sees what is new. */
window.addEventListener(
  "scroll",
  () => {
    for (const figure of stale) if (isInWindow(figure)) drawNow(figure);
  },
  { passive: true },
);

let zoomTimer = 0;
/** Whom to tell of a zoom; set by studio.js. */
let onZoom = () => {};

/** Once the reader has come to rest. */
function zoomed() {
  clearTimeout(zoomTimer);
  zoomTimer = setTimeout(() => onZoom(zoomRange()), 120);
}

/** What is shown of the time; null: all of it. */
function zoomRange() {
  const figure = timeFigures()[0];
  if (!figure?.chart) return null;
  const { start, end, startValue, endValue } = figure.chart.getOption().dataZoom[0];
  if (start <= 0.01 && end >= 99.99) return null;
  return startValue < endValue ? { from: startValue, to: endValue } : null;
}

/** A picture that no other depends on: made where there is none yet, else filled anew. */
function showAlone(place, block, host) {
  if (drawn.has(place)) refill(drawn.get(place), block);
  else makeFigure(block, place, host);
  shareExtents();
  drawSoon([drawn.get(place)]);
}

/** The same charts: finer over the time that the reader has zoomed, that time marked in the others. */
function showFiner(answer) {
  answer.charts.forEach((block, index) => {
    refill(drawn.get(`chart.${index}`), block);
  });
  const shown = answer.charts.map((_, index) => drawn.get(`chart.${index}`));
  if (answer.waterfall) {
    refill(drawn.get("fall.0"), answer.waterfall);
    shown.push(drawn.get("fall.0"));
  }
  drawSoon(shown);
}

/** Zooms to a part of the time. */
function showTime({ from, to }) {
  const [figure] = timeFigures();
  if (figure?.chart) zoomTo(figure, () => ({ startValue: from, endValue: to }));
}

function showWhole() {
  const [figure] = timeFigures();
  if (figure?.chart && zoomRange() !== null) resetZoom(figure);
}
