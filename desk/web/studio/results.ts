/** Results of many runs, of a campaign or of a benchmark: what is looked at of them, and the run that is open. */
const results = {
  setup: null,
  /** Of every filter what is chosen; empty: all. */
  filter: {},
  figures: null,
  runs: null,
  open: null,
  busy: false,
  asked: 0,
  message: null,
  /** The run that a second click begins anew with. */
  confirm: null,
  onSession: async () => {},
};

function filterSelect({ key, label, options }) {
  const id = `results-${key}`;
  const select = element("select", { id });
  for (const { value, words } of options) select.append(element("option", { value }, words));
  select.addEventListener("change", () => {
    results.filter[key] = select.value;
    showResults();
  });
  return element("div", { class: "choice-row" }, element("label", { for: id }, label), select);
}

/** Those that the figures follow too, or those of the list alone. */
function filtersOf(of) {
  return results.setup.filters.filter((each) => each.of === of);
}

function filterRow() {
  const row = element("div", { class: "results-filter", role: "group", "aria-label": "What is looked at" });
  row.append(...filtersOf("all").map(filterSelect));
  return row;
}

/** What the filters leave, as a request says it. */
function filterQuery(filters) {
  const chosen = filters.map(({ key }) => [key, results.filter[key] ?? ""]).filter(([, value]) => value !== "");
  return chosen.map(([key, value]) => `${key}=${encodeURIComponent(value)}`);
}

/** Both follow the filter; an answer that comes late is of no use. */
async function showResults() {
  const asked = ++results.asked;
  try {
    const [shown, runs] = await Promise.all([
      ask("GET", `results/figures?${filterQuery(filtersOf("all")).join("&")}`),
      askRuns(0),
    ]);
    if (asked !== results.asked) return;
    results.figures = shown;
    results.runs = runs;
    results.message = null;
    showFigures();
    showRuns();
  } catch (error) {
    results.message = error.message;
  }
  showResultsMessage();
  document.body.dataset.results = String(asked);
}

function askRuns(from) {
  return ask("GET", `results/runs?${[`from=${from}`, ...filterQuery(results.setup.filters)].join("&")}`);
}

function forgetFigures() {
  for (let at = figures.length - 1; at >= 0; --at) {
    if (!figures[at].place.startsWith("results")) continue;
    figures[at].chart?.dispose();
    figures.splice(at, 1);
  }
}

/** Tables alone are one click away: what is seen first is drawn. */
function showFigures() {
  forgetFigures();
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
  replaceContent(places.resultsFigures, ...content);
  watchTables(places.resultsFigures);
  drawEverything();
}

function runRow({ run, label, cells }) {
  const row = element("tr", run === results.open ? { class: "open-run", "aria-current": "true" } : {});
  const name = `Open ${results.setup.item} ${run}: ${label}`;
  const open = button(`open-run-${run}`, String(run), () => openRun(run, false), { "aria-label": name });
  row.append(element("th", { scope: "row" }, open));
  for (const { words, level } of cells) row.append(element("td", level === "" ? {} : { class: `level-${level}` }, words));
  return row;
}

function runTable({ columns, runs }) {
  const head = element("tr");
  for (const name of columns) head.append(element("th", { scope: "col" }, name));
  const body = element("tbody");
  for (const run of runs) body.append(runRow(run));
  const words = results.setup.list_heading;
  const caption = element("caption", { class: "hidden-text" }, words);
  const grid = element("table", { class: "runs" }, caption, element("thead", {}, head), body);
  return element("div", { class: "run-scroll", tabindex: "0", role: "region", "aria-label": words }, grid);
}

function showRuns() {
  const { count, runs } = results.runs;
  const { item, list_words: listWords } = results.setup;
  const words = count === 0 ? `No ${item} is left by this choice.` : `${count} ${count === 1 ? item : `${item}s`}. ${listWords}`;
  const content = [element("p", {}, words)];
  if (count > 0) content.push(runTable(results.runs));
  if (runs.length < count) {
    const more = async () => {
      const next = await askRuns(runs.length).catch((error) => complainOf(error));
      if (next) results.runs = { ...next, runs: [...runs, ...next.runs] };
      showRuns();
    };
    content.push(button("more-runs", `Show ${Math.min(results.runs.most, count - runs.length)} more`, more));
  }
  replaceContent(places.resultsRuns, ...content);
}

function complainOf(error) {
  results.message = error.message;
  showResultsMessage();
  return null;
}

function showResultsMessage() {
  const { message, confirm } = results;
  if (message === null) return replaceContent(places.resultsMessage, "");
  const note = noteWith(confirm === null ? "bad" : "warn", message);
  if (confirm !== null) note.firstChild.append(" ", button("open-anyway", "Begin anew", () => openRun(confirm, true)));
  replaceContent(places.resultsMessage, note);
  places.resultsMessage.scrollIntoView({ block: "nearest" });
}

/** Runs it once more; it is the recording of the session below from then on. */
async function openRun(run, replace) {
  if (results.busy) return;
  results.busy = true;
  Object.assign(results, { message: null, confirm: null });
  replaceContent(places.resultsDoing, element("p", { class: "progress" }, element("span", { class: "spinner", "aria-hidden": "true" }), `${effectTitle(results.setup.item)} ${run} …`));
  showResultsMessage();
  holdControls(true);
  try {
    await ask("POST", "results/session", { run, replace });
    results.open = run;
    await results.onSession();
  } catch (error) {
    results.message = error.message;
    if (error.confirm) results.confirm = run;
  }
  results.busy = false;
  replaceContent(places.resultsDoing, "");
  holdControls(false);
  showRuns();
  showResultsMessage();
}

async function startResults(host, onSession) {
  results.onSession = onSession;
  results.setup = await ask("GET", "results");
  const { name, title, subtitle, heading, list_heading: listHeading } = results.setup;
  document.title = `Studio: ${name}`;
  const header = element("header", {}, element("h1", {}, title));
  header.append(element("p", { class: "subtitle" }, subtitle));
  replaceContent(places.head, header);
  const list = element("div", { id: "results-runs" }, element("h3", {}, listHeading));
  list.append(...filtersOf("list").map(filterSelect), place("resultsDoing", { role: "status" }), place("resultsRuns"));
  host.append(
    sectionWith("results", heading, filterRow(), place("resultsFigures"), list, place("resultsMessage", { role: "alert" })),
  );
  await showResults();
}
