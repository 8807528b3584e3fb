const kLevelWords = { good: "Good", warn: "Warning", bad: "Bad", neutral: "" };
const kLevelPaths = {
  good: '<path d="M5.5 10.5l3 3 6-7"/>',
  warn: '<path d="M10 5v6.2"/><path d="M10 14.4v.2"/>',
  bad: '<path d="M6.5 6.5l7 7M13.5 6.5l-7 7"/>',
  neutral: '<path d="M10 9v5.2"/><path d="M10 5.6v.2"/>',
};

/** Text that a narrow column does not break: units, single words. */
const kShortText = 12;

function levelSymbol(level) {
  const holder = element("span", {});
  holder.innerHTML =
    '<svg class="symbol" viewBox="0 0 20 20" fill="none" stroke="currentColor" ' +
    `stroke-width="1.8" stroke-linecap="round" stroke-linejoin="round" aria-hidden="true">` +
    `<circle cx="10" cy="10" r="8.6" stroke-width="1.5"/>${kLevelPaths[level]}</svg>`;
  return holder.firstChild;
}

function hiddenText(text) {
  return text === "" ? "" : element("span", { class: "hidden-text" }, `${text}: `);
}

function paragraphs(text) {
  const parts = text.split(/\n\s*\n/).filter((part) => part.trim() !== "");
  return parts.map((part) => element("p", {}, ...withCode(part)));
}

/** What stands between two backticks is for a terminal. */
function withCode(text) {
  const parts = text.split("`");
  if (parts.length % 2 === 0) return [text];
  return parts.map((part, index) => (index % 2 === 1 ? element("code", {}, part) : part)).filter((part) => part !== "");
}

/** The table alone; it scrolls by itself where the window is narrower: see watchWidths(). */
function scrollingTable(table) {
  const text = (index) => table.rows.some((row) => typeof row[index] === "string");
  const head = element("tr");
  table.columns.forEach((column, index) => {
    const cell = element("th", { scope: "col", class: text(index) ? "" : "number" }, column.name);
    if (column.unit !== "") {
      cell.append(" ", element("span", { class: "unit" }, unitInBrackets(column.unit)));
    }
    head.append(cell);
  });
  const body = element("tbody");
  for (const row of table.rows) body.append(tableRow(row, table.columns));
  const caption = element("caption", {}, element("span", {}, table.caption));
  const grid = element("table", {}, caption, element("thead", {}, head), body);
  const hint = element("p", { class: "scroll-hint", hidden: "" }, "Wider than shown: scroll \u2192");
  return element("div", {}, hint, element("div", { class: "scroll" }, grid));
}

function tableElement(table, place) {
  const root = element("div", { class: "card", "data-block": place }, scrollingTable(table));
  if (table.note !== "") root.append(element("p", { class: "remark" }, table.note));
  return root;
}

function tableRow(row, columns) {
  const line = element("tr");
  row.forEach((value, index) => {
    const isText = typeof value === "string";
    const shown = isText ? value : formatNumber(value, columns[index].format);
    const named = index === 0 && isText;
    const kind = isText ? (value.length <= kShortText ? "short" : "") : "number";
    const attributes = { class: kind, ...(named ? { scope: "row" } : {}) };
    line.append(element(named ? "th" : "td", attributes, shown));
  });
  return line;
}

/** A table wider than its place says so, and takes the focus so that the arrow keys scroll it. */
function watchWidths() {
  const observer = new ResizeObserver((entries) => {
    for (const { target } of entries) markWidth(target);
  });
  for (const scroll of document.querySelectorAll(".scroll")) observer.observe(scroll);
}

function markWidth(scroll) {
  const wide = scroll.scrollWidth > scroll.clientWidth + 1;
  if (wide === scroll.hasAttribute("tabindex")) return;
  const name = `${scroll.querySelector("caption").textContent}, scrolls sideways`;
  for (const [key, value] of Object.entries({ tabindex: "0", role: "region", "aria-label": name })) {
    if (wide) scroll.setAttribute(key, value);
    else scroll.removeAttribute(key);
  }
  scroll.previousElementSibling.hidden = !wide;
}

function keyFiguresElement(block, place) {
  const list = element("dl", { class: "figures", "data-block": place });
  for (const figure of block.figures) {
    const isText = typeof figure.value === "string";
    const shown = isText ? figure.value : formatNumber(figure.value, figure.format);
    const value = element("dd", { class: "value" }, hiddenText(kLevelWords[figure.level]), shown);
    if (withUnit("", figure.unit) !== "" && shown !== "–") {
      const space = figure.unit === "%" ? "\u202f" : "\u00a0";
      value.append(element("span", { class: "unit" }, space + figure.unit));
    }
    if (figure.level !== "neutral") value.append(levelSymbol(figure.level));
    const item = element("div", { class: figure.level }, element("dt", {}, figure.label), value);
    if (figure.note !== "") item.append(element("dd", { class: "remark" }, figure.note));
    list.append(item);
  }
  return list;
}

function noteElement(block, place) {
  const root = element("div", { class: `note ${block.level}`, role: "note", "data-block": place });
  root.append(...paragraphs(block.text));
  root.firstChild.prepend(levelSymbol(block.level), hiddenText(kLevelWords[block.level]));
  return root;
}

function blockElement(block, place) {
  if (block.type === "table") return tableElement(block, place);
  if (block.type === "key_figures") return keyFiguresElement(block, place);
  if (block.type === "note") return noteElement(block, place);
  return figureElement(block, place);
}

/** Charts that zoom together are of one recording. */
function ofRecording(block, recording) {
  if (recording === "" || !block.zoom_group) return block;
  return { ...block, zoom_group: `${block.zoom_group} of ${recording}` };
}

function sectionElement(section, index) {
  const id = `section-${index + 1}`;
  const root = element("section", { id, "aria-labelledby": `${id}-heading` });
  if (section.recording !== "") root.dataset.recording = section.recording;
  root.append(element("h2", { id: `${id}-heading` }, section.heading));
  root.append(...paragraphs(section.text));
  const blocks = element("div", { class: "blocks" });
  section.blocks.forEach((block, at) =>
    blocks.append(blockElement(ofRecording(block, section.recording), `${index}.${at}`)),
  );
  if (section.blocks.length > 0) root.append(blocks);
  return root;
}

function headerElement(data) {
  const words = element("p", { id: "verdict-words" }, data.verdict.words);
  const verdict = element("div", { class: `verdict ${data.verdict.level}` });
  const level = hiddenText(kLevelWords[data.verdict.level]);
  verdict.append(levelSymbol(data.verdict.level), level, words);
  const header = element("header", {}, element("h1", {}, data.title));
  if (data.subtitle !== "") header.append(element("p", { class: "subtitle" }, data.subtitle));
  header.append(verdict);
  if (data.sections.length >= 3) header.append(contentsElement(data.sections));
  return header;
}

function contentsElement(sections) {
  const list = element("ol");
  sections.forEach((section, index) => {
    const link = element("a", { href: `#section-${index + 1}` }, section.heading);
    const item = element("li", {}, link);
    if (section.recording !== "") item.dataset.recording = section.recording;
    list.append(item);
  });
  return element("nav", { class: "contents", "aria-label": "Contents" }, list);
}

function footerElement(data) {
  const footer = element("footer");
  footer.append(element("p", { id: "spoken", class: "hidden-text", role: "status" }));
  const claim = `offnominal ${data.version}, diagnostic aid, claims no SIL/PL`;
  footer.append(element("p", {}, claim));
  if (data.command_line !== "") {
    footer.append(element("p", {}, "Made by ", element("code", {}, data.command_line)));
  }
  footer.append(
    element(
      "p",
      { class: "hint" },
      "Charts: drag to zoom, shift-drag to move, ctrl-wheel to zoom, double click to reset; " +
        "click a name in a legend to hide it. A chart that has the focus takes keys: arrows show " +
        "values, + and - zoom, shift and an arrow moves, 0 resets. Drawn with Apache ECharts.",
    ),
  );
  return footer;
}

/** Where the page shows several recordings, the choice of the one that is seen; null where it does not. */
function recordingChoice(sections) {
  const names = [...new Set(sections.map((section) => section.recording))].filter((name) => name !== "");
  if (names.length === 0) return null;
  const choice = element("select", { id: "recording" });
  for (const name of names) choice.append(element("option", { value: name }, name));
  choice.addEventListener("change", () => {
    showRecording(choice.value);
    redrawAll();
  });
  const label = element("label", { for: "recording" }, "Recording");
  return element("div", { class: "choice" }, label, choice);
}

/** Hides all that is of another recording. */
function showRecording(name) {
  for (const node of document.querySelectorAll("[data-recording]")) {
    node.hidden = node.dataset.recording !== name;
  }
}

function buildPage() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const main = element("main");
  const choice = recordingChoice(data.sections);
  data.sections.forEach((section, index) => {
    if (section.recording !== "" && choice.parentNode === null) main.append(choice);
    main.append(sectionElement(section, index));
  });
  document.getElementById("page").append(headerElement(data), main, footerElement(data));
  if (choice !== null) showRecording(choice.querySelector("select").value);
  drawAll();
  watchWidths();
}
