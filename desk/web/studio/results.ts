import { blockElement } from "../report/blocks";
import { drawAll } from "../report/drawing";
import { element } from "../report/element";
import { watchTables } from "../report/tables";
import type { Figures, Filter, Results, Run, Runs } from "./api";
import { forgetFigures } from "./charts";
import {
  addToNote,
  button,
  effectTitle,
  foldWith,
  holdControls,
  noteWith,
  replaceContent,
  sectionWith,
} from "./parts";
import { place, placeOf } from "./places";
import { ask, mayConfirm, wordsOf } from "./server";
import { showWatched } from "./watched";

/** Results of many runs, of a campaign or of a benchmark: what is looked at of them, and the run that is open. */
export const results: {
  setup: Results | null;
  /** Of every filter what is chosen; empty: all. */
  filter: Partial<Record<Filter["key"], string>>;
  figures: Figures;
  runs: Runs;
  open: number | null;
  busy: boolean;
  asked: number;
  message: string | null;
  /** The run that a second click begins anew with. */
  confirm: number | null;
  onSession: () => Promise<void>;
} = {
  setup: null,
  filter: {},
  figures: { sections: [] },
  runs: { count: 0, from: 0, most: 0, columns: [], runs: [] },
  open: null,
  busy: false,
  asked: 0,
  message: null,
  confirm: null,
  onSession: async () => {},
};

/** The page shows results, and a session below them. */
export function hasResults(): boolean {
  return results.setup !== null;
}

function resultsSetup(): Results {
  if (results.setup === null) throw new Error("there are no results");
  return results.setup;
}

/** "Run 15": the one that is open. */
export function openRunTitle(): string {
  return `${effectTitle(resultsSetup().item)} ${results.open}`;
}

function filterSelect({ key, label, options }: Filter) {
  const id = `results-${key}`;
  const select = element("select", { id });
  for (const { value, words } of options) select.append(element("option", { value }, words));
  select.addEventListener("change", () => {
    results.filter[key] = select.value;
    void showResults();
  });
  return element("div", { class: "choice-row" }, element("label", { for: id }, label), select);
}

/** Those that the figures follow too, or those of the list alone. */
function filtersOf(of: Filter["of"]) {
  return resultsSetup().filters.filter((each) => each.of === of);
}

function filterRow() {
  const row = element("div", { class: "results-filter", role: "group", "aria-label": "What is looked at" });
  row.append(...filtersOf("all").map(filterSelect));
  return row;
}

/** What the filters leave, as a request says it. */
function filterQuery(filters: Filter[]): typeof results.filter {
  const chosen = filters.map(({ key }) => [key, results.filter[key] ?? ""]);
  return Object.fromEntries(chosen.filter(([, value]) => value !== ""));
}

/** Both follow the filter; an answer that comes late is of no use. */
async function showResults() {
  const asked = ++results.asked;
  try {
    const [shown, runs] = await Promise.all([
      ask("GET", "/results/figures", { query: filterQuery(filtersOf("all")) }),
      askRuns(0),
    ]);
    if (asked !== results.asked) return;
    results.figures = shown;
    results.runs = runs;
    results.message = null;
    showFigures();
    showRuns();
  } catch (error) {
    results.message = wordsOf(error);
  }
  showResultsMessage();
  document.body.dataset.results = String(asked);
}

function askRuns(from: number) {
  return ask("GET", "/results/runs", { query: { from, ...filterQuery(resultsSetup().filters) } });
}

/** Tables alone are one click away: what is seen first is drawn. */
function showFigures() {
  forgetFigures("results");
  const content = results.figures.sections.map((section, index) => {
    const blocks = element("div", { class: "blocks" });
    section.blocks.forEach((block, at) => blocks.append(blockElement(block, `results${index}.${at}`)));
    if (section.blocks.every(({ type }) => type === "table")) {
      const fold = foldWith(`results-fold-${index}`, section.heading);
      fold.append(blocks);
      return fold;
    }
    return element("div", {}, element("h3", {}, section.heading), blocks);
  });
  replaceContent(placeOf("resultsFigures"), ...content);
  watchTables(placeOf("resultsFigures"));
  drawAll();
}

function runRow({ run, label, cells }: Run) {
  const row = element("tr", run === results.open ? { class: "open-run", "aria-current": "true" } : {});
  const name = `Open ${resultsSetup().item} ${run}: ${label}`;
  const open = button(`open-run-${run}`, String(run), () => openRun(run, false), { "aria-label": name });
  row.append(element("th", { scope: "row" }, open));
  for (const { words, level } of cells) row.append(element("td", level === "" ? {} : { class: `level-${level}` }, words));
  return row;
}

function runTable({ columns, runs }: Runs) {
  const head = element("tr");
  for (const name of columns) head.append(element("th", { scope: "col" }, name));
  const body = element("tbody");
  for (const run of runs) body.append(runRow(run));
  const words = resultsSetup().list_heading;
  const caption = element("caption", { class: "hidden-text" }, words);
  const grid = element("table", { class: "runs" }, caption, element("thead", {}, head), body);
  return element("div", { class: "run-scroll", tabindex: "0", role: "region", "aria-label": words }, grid);
}

function showRuns() {
  const { count, runs } = results.runs;
  const { item, list_words: listWords } = resultsSetup();
  const words = count === 0 ? `No ${item} is left by this choice.` : `${count} ${count === 1 ? item : `${item}s`}. ${listWords}`;
  const content: HTMLElement[] = [element("p", {}, words)];
  if (count > 0) content.push(runTable(results.runs));
  if (runs.length < count) {
    const more = async () => {
      const next = await askRuns(runs.length).catch(complainOfRuns);
      if (next) results.runs = { ...next, runs: [...runs, ...next.runs] };
      showRuns();
    };
    content.push(button("more-runs", `Show ${Math.min(results.runs.most, count - runs.length)} more`, more));
  }
  replaceContent(placeOf("resultsRuns"), ...content);
}

function complainOfRuns(error: unknown) {
  results.message = wordsOf(error);
  showResultsMessage();
  return null;
}

function showResultsMessage() {
  const { message, confirm } = results;
  if (message === null) return replaceContent(placeOf("resultsMessage"), "");
  const note = noteWith(confirm === null ? "bad" : "warn", message);
  if (confirm !== null) addToNote(note, " ", button("open-anyway", "Begin anew", () => openRun(confirm, true)));
  replaceContent(placeOf("resultsMessage"), note);
  placeOf("resultsMessage").scrollIntoView({ block: "nearest" });
}

/** Runs it once more; it is the recording of the session below from then on. */
async function openRun(run: number, replace: boolean) {
  if (results.busy) return;
  results.busy = true;
  Object.assign(results, { message: null, confirm: null });
  replaceContent(placeOf("resultsDoing"), element("p", { class: "progress" }, element("span", { class: "spinner", "aria-hidden": "true" }), `${effectTitle(resultsSetup().item)} ${run} …`));
  showResultsMessage();
  holdControls(true);
  try {
    await ask("POST", "/results/session", { body: { run, replace } });
    results.open = run;
    showWatched(run, resultsSetup().monitors);
    await results.onSession();
  } catch (error) {
    results.message = wordsOf(error);
    if (mayConfirm(error)) results.confirm = run;
  }
  results.busy = false;
  replaceContent(placeOf("resultsDoing"), "");
  holdControls(false);
  showRuns();
  showResultsMessage();
}

export async function startResults(host: HTMLElement, onSession: () => Promise<void>) {
  results.onSession = onSession;
  results.setup = await ask("GET", "/results");
  const { name, title, subtitle, heading, list_heading: listHeading } = resultsSetup();
  document.title = `Studio: ${name}`;
  const header = element("header", {}, element("h1", {}, title));
  header.append(element("p", { class: "subtitle" }, subtitle));
  replaceContent(placeOf("head"), header);
  const list = element("div", { id: "results-runs" }, element("h3", {}, listHeading));
  list.append(...filtersOf("list").map(filterSelect), place("resultsDoing", { role: "status" }), place("resultsRuns"));
  host.append(
    sectionWith("results", heading, filterRow(), place("resultsFigures"), list, place("resultsMessage", { role: "alert" })),
  );
  await showResults();
}
