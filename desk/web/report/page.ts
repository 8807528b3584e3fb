import { blockElement } from "./blocks";
import type { Block, Page, Section } from "./document";
import { drawAll, redrawAll } from "./drawing";
import { byId, element, within } from "./element";
import { watchTables } from "./tables";
import { hiddenText, kLevelWords, levelSymbol, paragraphs } from "./words";

/** Charts that zoom together are of one recording. */
function ofRecording(block: Block, recording: string) {
  if (recording === "" || block.type !== "chart" || block.zoom_group === "") return block;
  return { ...block, zoom_group: `${block.zoom_group} of ${recording}` };
}

function sectionElement(section: Section, index: number) {
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

function headerElement(data: Page) {
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

function contentsElement(sections: Section[]) {
  const list = element("ol");
  sections.forEach((section, index) => {
    const link = element("a", { href: `#section-${index + 1}` }, section.heading);
    const item = element("li", {}, link);
    if (section.recording !== "") item.dataset.recording = section.recording;
    list.append(item);
  });
  return element("nav", { class: "contents", "aria-label": "Contents" }, list);
}

function footerElement(data: Page) {
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
function recordingChoice(sections: Section[]) {
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
function showRecording(name: string) {
  for (const node of document.querySelectorAll<HTMLElement>("[data-recording]")) {
    node.hidden = node.dataset.recording !== name;
  }
}

export function buildPage() {
  const data = JSON.parse(byId("data").textContent ?? "") as Page;
  const main = element("main");
  const choice = recordingChoice(data.sections);
  data.sections.forEach((section, index) => {
    if (section.recording !== "" && choice?.parentNode === null) main.append(choice);
    main.append(sectionElement(section, index));
  });
  byId("page").append(headerElement(data), main, footerElement(data));
  if (choice !== null) showRecording(within<HTMLSelectElement>(choice, "select").value);
  drawAll();
  watchTables(document);
}
