/** Every drawn figure: {block, kind, host, place, chart, extent, legend, hidden, cursor, option}. */
const figures = [];

/** A kind with a cursor can be zoomed, too. */
const kKinds = {
  chart: {
    option: chartOption,
    height: chartHeight,
    csv: chartCsv,
    words: chartWords,
    numbers: chartNumbers,
    cursor: chartCursor,
  },
  heatmap: {
    option: heatmapOption,
    height: heatmapHeight,
    csv: heatmapCsv,
    words: heatmapWords,
    numbers: heatmapNumbers,
    cursor: heatmapCursor,
  },
  waterfall: {
    option: waterfallOption,
    height: waterfallHeight,
    csv: waterfallCsv,
    words: waterfallWords,
    numbers: waterfallNumbers,
    cursor: null,
  },
};

function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

/** A figure with its title, tools, legend and note; drawn later by drawFigure(). */
function figureElement(block, place) {
  const kind = kKinds[block.type];
  const id = `figure-${place.replace(".", "-")}`;
  const host = element("div", {
    class: "drawing",
    role: "img",
    "aria-labelledby": `${id}-title`,
    "aria-describedby": `${id}-words`,
    style: `height:${kind.height(block)}px`,
  });
  const figure = { block, kind, host, place, chart: null, extent: null, legend: null };
  figure.hidden = new Set();
  figure.cursor = null;
  figure.option = null;
  const title = element("h3", { id: `${id}-title` }, block.title);
  const root = element("figure", {
    class: `card ${block.width === "half" ? "half" : ""}`.trim(),
    "data-block": place,
  });
  root.append(element("div", { class: "figure-head" }, title, toolButtons(figure)));
  if (block.type === "heatmap") {
    root.append(element("p", { class: "scale" }, scaleWords(block)));
  }
  if (block.type === "chart") {
    figure.legend = element("ul", { class: "legend", "aria-label": `Series of ${block.title}` });
    root.append(figure.legend);
  }
  // Only a reader of the description hears what is hidden; it is not read a second time.
  root.append(host, element("p", { id: `${id}-words`, hidden: "" }, kind.words(block)));
  if (kind.cursor !== null) root.append(takeKeys(figure));
  if (block.note !== "") root.append(element("p", { class: "remark" }, block.note));
  root.append(numbersElement(figure));
  figures.push(figure);
  return root;
}

/** The picture's content for those who do not see it. */
function numbersElement({ block, kind }) {
  const summary = element("summary", {}, "Numbers", ofTitle(block));
  const caption = `Numbers of ${block.title}`;
  return element("details", {}, summary, scrollingTable({ caption, ...kind.numbers(block) }));
}

/** Ends the name of a control that every figure has. */
function ofTitle(block) {
  return element("span", { class: "hidden-text" }, ` of ${block.title}`);
}

function toolButtons(figure) {
  const tools = element("div", { class: "tools" });
  const add = (label, action) => {
    const button = element("button", { type: "button" }, label, ofTitle(figure.block));
    button.addEventListener("click", action);
    tools.append(button);
  };
  if (figure.kind.cursor !== null) add("Reset zoom", () => resetZoom(figure));
  add("Save picture", () => savePicture(figure));
  add("Save CSV", () => {
    const blob = new Blob([figure.kind.csv(figure.block)], { type: "text/csv" });
    saveAs(URL.createObjectURL(blob), fileName(figure, "csv"));
  });
  return tools;
}

function fileName(figure, extension) {
  const words = figure.block.title.toLowerCase().replace(/[^a-z0-9]+/g, "-");
  return `${words.replace(/^-|-$/g, "") || "figure"}.${extension}`;
}

function saveAs(address, name) {
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

/** The picture with its title and legend, which the page shows outside the canvas. */
function savePicture(figure) {
  const look = currentLook();
  const ratio = 2;
  const drawing = figure.chart.renderToCanvas({ pixelRatio: ratio, backgroundColor: look.surface });
  const head = 62 * ratio;
  const canvas = element("canvas", { width: drawing.width, height: drawing.height + head });
  const context = canvas.getContext("2d");
  context.fillStyle = look.surface;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(drawing, 0, head);
  context.scale(ratio, ratio);
  context.fillStyle = look.ink;
  context.font = `600 15px ${kFontFamily}`;
  context.fillText(figure.block.title, 8, 24);
  context.font = `13px ${kFontFamily}`;
  if (figure.block.type === "heatmap") {
    context.fillStyle = look.soft;
    context.fillText(scaleWords(figure.block), 8, 46);
  }
  if (figure.block.type === "chart") {
    const colors = seriesColors(figure.block.series, look);
    let x = 8;
    figure.block.series.forEach((series, index) => {
      if (figure.hidden.has(series.name)) return;
      context.fillStyle = colors[index];
      context.fillRect(x, 40, 18, series.kind === "line" || series.kind === "steps" ? 2.5 : 7);
      context.fillStyle = look.ink;
      context.fillText(series.name, x + 24, 46);
      x += 44 + context.measureText(series.name).width;
    });
  }
  saveAs(canvas.toDataURL("image/png"), fileName(figure, "png"));
}

function resetZoom(figure) {
  zoomTo(figure, () => ({ start: 0, end: 100 }));
}

/** Every zoom of the figure to what change({start, end}), in percent, makes of it. */
function zoomTo(figure, change) {
  const batch = figure.chart
    .getOption()
    .dataZoom.map((zoom, dataZoomIndex) => ({ dataZoomIndex, ...change(zoom, dataZoomIndex) }));
  figure.chart.dispatchAction({ type: "dataZoom", batch });
}

function fillLegend(figure, look) {
  const { block, chart, hidden } = figure;
  const colors = seriesColors(block.series, look);
  const items = block.series.map((series, index) => {
    const button = element("button", {
      type: "button",
      "aria-pressed": String(!hidden.has(series.name)),
      "data-series": series.name,
    });
    button.innerHTML = swatch(series, colors[index]);
    button.append(element("span", {}, series.name), ofTitle(block));
    button.addEventListener("click", () =>
      chart.dispatchAction({ type: "legendToggleSelect", name: series.name }),
    );
    return element("li", {}, button);
  });
  figure.legend.replaceChildren(...items);
}

function watchLegend(figure) {
  figure.chart.on("legendselectchanged", ({ selected }) => {
    for (const button of figure.legend.querySelectorAll("button")) {
      const name = button.dataset.series;
      const shown = selected[name] !== false;
      button.setAttribute("aria-pressed", String(shown));
      if (shown) figure.hidden.delete(name);
      else figure.hidden.add(name);
    }
  });
}

/** After a zoom the x axis begins and ends anywhere: see edgeLabels(). */
function watchZoom(figure) {
  const { block, chart } = figure;
  const axes = block.type === "heatmap" ? ["x", "y"] : ["x"];
  const refresh = () => {
    const { dataZoom } = chart.getOption();
    const option = {};
    axes.forEach((name, index) => {
      const { startValue, endValue } = dataZoom[index];
      if (!(startValue < endValue)) return;
      const count = name === "x" && block.type === "chart" ? xLabelCount(block) : 5;
      option[`${name}Axis`] = { axisLabel: edgeLabels(startValue, endValue, count, block[name].log) };
    });
    const text = JSON.stringify(option);
    if (text !== figure.edges) chart.setOption(option);
    figure.edges = text;
  };
  chart.on("datazoom", refresh);
}

/** ECharts takes every turn of the wheel; the page needs those without ctrl to scroll. */
function leaveWheelToPage(host) {
  for (const name of ["wheel", "mousewheel"]) {
    const pass = (event) => event.ctrlKey || event.stopPropagation();
    host.addEventListener(name, pass, { capture: true, passive: true });
  }
}

/** While shift is held a drag moves the zoomed range, else it chooses one. */
function setZoomBrush(figure, active) {
  figure.chart.dispatchAction({
    type: "takeGlobalCursor",
    key: "dataZoomSelect",
    dataZoomSelectActive: active,
  });
}

function watchShift() {
  const zoomed = figures.filter((figure) => figure.kind.cursor !== null);
  const set = (active) =>
    zoomed.filter(({ chart }) => chart !== null).forEach((figure) => setZoomBrush(figure, active));
  window.addEventListener("keydown", ({ key, repeat }) => {
    if (key === "Shift" && !repeat) set(false);
  });
  window.addEventListener("keyup", ({ key }) => {
    if (key === "Shift") set(true);
  });
  window.addEventListener("blur", () => set(true));
}

/** (Re)draws the figure in the present look and size; zoom and hidden series stay. */
function drawFigure(figure) {
  const look = currentLook();
  const { block, kind, host } = figure;
  if (figure.chart === null) {
    figure.chart = echarts.init(host, null, { renderer: "canvas" });
    if (block.zoom_group) {
      figure.chart.group = block.zoom_group;
      echarts.connect(block.zoom_group);
    }
    if (kind.cursor !== null) {
      figure.chart.getZr().on("dblclick", () => resetZoom(figure));
      watchZoom(figure);
      leaveWheelToPage(host);
    }
    if (figure.legend !== null) watchLegend(figure);
  }
  const isShown = (name) => !figure.hidden.has(name);
  const isFirst = figure.option === null;
  figure.option = kind.option(block, look, host.clientWidth, figure.extent, isShown);
  // The tool that zooms, told once: told again it has to be taken up again, which draws all anew.
  const { toolbox, ...others } = figure.option;
  figure.chart.setOption(isFirst ? figure.option : others, { replaceMerge: ["series"] });
  if (figure.legend !== null) fillLegend(figure, look);
  if (kind.cursor !== null && isFirst) setZoomBrush(figure, true);
}

/** Charts of one zoom group share the x range that covers them all. */
function shareExtents() {
  const charts = figures.filter((figure) => figure.block.type === "chart");
  for (const figure of charts) {
    const group = figure.block.zoom_group;
    const members = group ? charts.filter((other) => other.block.zoom_group === group) : [figure];
    figure.extent = xExtent(members.map((member) => member.block));
  }
}

/** Those of the recording that is shown; the others are drawn when they are. */
function shownFigures() {
  return figures.filter(({ host }) => host.closest("[hidden]") === null);
}

function redrawAll() {
  for (const figure of shownFigures()) {
    figure.option = null; // in other colours, its tool too
    figure.chart?.resize();
    drawFigure(figure);
  }
}

function drawAll() {
  shareExtents();
  shownFigures().forEach(drawFigure);
  darkPreference.addEventListener("change", redrawAll);
  let width = window.innerWidth;
  window.addEventListener("resize", () => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    redrawAll();
  });
  watchShift();
  watchPrinting();
}

/** Paper is white and narrower than the window. */
function watchPrinting() {
  const kPaperWidth = 640;
  window.addEventListener("beforeprint", () => {
    document.documentElement.setAttribute("data-print", "");
    for (const figure of shownFigures()) {
      figure.chart?.resize({ width: kPaperWidth });
      drawFigure(figure);
    }
  });
  window.addEventListener("afterprint", () => {
    document.documentElement.removeAttribute("data-print");
    for (const figure of shownFigures()) figure.chart?.resize({ width: "auto" });
    redrawAll();
  });
}
