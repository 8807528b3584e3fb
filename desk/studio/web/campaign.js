/** A campaign's results: what is looked at of them, and the run that is open. */
const campaign = {
  setup: null,
  filter: { detector: "", kind: "", joint: "", outcome: "" },
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

function filterSelect(key, label, options) {
  const id = `campaign-${key}`;
  const select = element("select", { id });
  for (const [value, words] of options) select.append(element("option", { value }, words));
  select.addEventListener("change", () => {
    campaign.filter[key] = select.value;
    showResults();
  });
  return element("div", { class: "choice-row" }, element("label", { for: id }, label), select);
}

function filterRow({ detectors, kinds, joints }) {
  const all = (words, values, name) => [["", words], ...values.map((value) => [String(value), name(value)])];
  const row = element("div", { class: "campaign-filter", role: "group", "aria-label": "What is looked at" });
  row.append(
    filterSelect("kind", "Fault", all("all faults", kinds, effectTitle)),
    filterSelect("joint", "Joint", all("every joint or link", joints, (joint) => `${joint}`)),
    filterSelect("detector", "Detector", all("all detectors", detectors, (name) => name)),
  );
  return row;
}

/** What the filter leaves, as a request says it. */
function filterQuery(keys) {
  const { filter } = campaign;
  return keys.filter((key) => filter[key] !== "").map((key) => `${key}=${encodeURIComponent(filter[key])}`);
}

/** Both follow the filter; an answer that comes late is of no use. */
async function showResults() {
  const asked = ++campaign.asked;
  const mine = ["detector", "kind", "joint"];
  try {
    const [shown, runs] = await Promise.all([
      ask("GET", `campaign/figures?${filterQuery(mine).join("&")}`),
      askRuns(0),
    ]);
    if (asked !== campaign.asked) return;
    campaign.figures = shown;
    campaign.runs = runs;
    campaign.message = null;
    showFigures();
    showRuns();
  } catch (error) {
    campaign.message = error.message;
  }
  showCampaignMessage();
  document.body.dataset.campaign = String(asked);
}

function askRuns(from) {
  return ask("GET", `campaign/runs?${[`from=${from}`, ...filterQuery(["detector", "kind", "joint", "outcome"])].join("&")}`);
}

function forgetFigures() {
  for (let at = figures.length - 1; at >= 0; --at) {
    if (!figures[at].place.startsWith("campaign")) continue;
    figures[at].chart?.dispose();
    figures.splice(at, 1);
  }
}

/** Tables alone are one click away: what is seen first is drawn. */
function showFigures() {
  forgetFigures();
  const content = campaign.figures.sections.map((section, index) => {
    const blocks = element("div", { class: "blocks" });
    section.blocks.forEach((block, at) => blocks.append(blockElement(block, `campaign${index}.${at}`)));
    if (section.blocks.every(({ type }) => type === "table")) {
      const fold = foldWith(`campaign-fold-${index}`, section.heading);
      fold.append(blocks);
      return fold;
    }
    return element("div", {}, element("h3", {}, section.heading), blocks);
  });
  replaceContent(places.campaignFigures, ...content);
  watchTables(places.campaignFigures);
  drawEverything();
}

function runRow({ run, fault, size, outcomes }) {
  const row = element("tr", run === campaign.open ? { class: "open-run", "aria-current": "true" } : {});
  const open = button(`open-run-${run}`, String(run), () => openRun(run, false), { "aria-label": `Open run ${run}: ${fault}${size === "" ? "" : `, ${size}`}` });
  row.append(element("th", { scope: "row" }, open), element("td", {}, fault), element("td", {}, size));
  for (const { outcome, words } of outcomes) row.append(element("td", { class: `outcome ${outcome.replace(" ", "-")}` }, words));
  return row;
}

function runTable(runs) {
  const head = element("tr");
  const names = runs.length === 0 ? [] : runs[0].outcomes.map(({ detector }) => detector);
  for (const name of ["Run", "Fault", "Size", ...names]) head.append(element("th", { scope: "col" }, name));
  const body = element("tbody");
  for (const run of runs) body.append(runRow(run));
  const caption = element("caption", { class: "hidden-text" }, "Runs of the campaign");
  const grid = element("table", { class: "runs" }, caption, element("thead", {}, head), body);
  return element("div", { class: "run-scroll", tabindex: "0", role: "region", "aria-label": "Runs of the campaign" }, grid);
}

function showRuns() {
  const { count, runs } = campaign.runs;
  const words = count === 0 ? "No run is left by this choice." : `${count} ${count === 1 ? "run" : "runs"}. A click on a number runs it once more and opens it below as a recording, with the model that the detectors have.`;
  const content = [element("p", {}, words)];
  if (count > 0) content.push(runTable(runs));
  if (runs.length < count) {
    const more = async () => {
      const next = await askRuns(runs.length).catch((error) => complainOf(error));
      if (next) campaign.runs = { ...next, runs: [...runs, ...next.runs] };
      showRuns();
    };
    content.push(button("more-runs", `Show ${Math.min(campaign.runs.most, count - runs.length)} more`, more));
  }
  replaceContent(places.campaignRuns, ...content);
}

function complainOf(error) {
  campaign.message = error.message;
  showCampaignMessage();
  return null;
}

function showCampaignMessage() {
  const { message, confirm } = campaign;
  if (message === null) return replaceContent(places.campaignMessage, "");
  const note = noteWith(confirm === null ? "bad" : "warn", message);
  if (confirm !== null) note.firstChild.append(" ", button("open-anyway", "Begin anew", () => openRun(confirm, true)));
  replaceContent(places.campaignMessage, note);
  places.campaignMessage.scrollIntoView({ block: "nearest" });
}

/** Runs it once more; it is the recording of the session below from then on. */
async function openRun(run, replace) {
  if (campaign.busy) return;
  campaign.busy = true;
  Object.assign(campaign, { message: null, confirm: null });
  replaceContent(places.campaignDoing, element("p", { class: "progress" }, element("span", { class: "spinner", "aria-hidden": "true" }), `Run ${run} …`));
  showCampaignMessage();
  holdControls(true);
  try {
    await ask("POST", "campaign/session", { run, replace });
    campaign.open = run;
    await campaign.onSession();
  } catch (error) {
    campaign.message = error.message;
    if (error.confirm) campaign.confirm = run;
  }
  campaign.busy = false;
  replaceContent(places.campaignDoing, "");
  holdControls(false);
  showRuns();
  showCampaignMessage();
}

async function startCampaign(host, onSession) {
  campaign.onSession = onSession;
  campaign.setup = await ask("GET", "campaign");
  const { name, file, runs, missing } = campaign.setup;
  document.title = `Studio: ${name}`;
  const header = element("header", {}, element("h1", {}, `Campaign: ${name}`));
  const there = missing === 0 ? `${runs} runs` : `${runs - missing} of ${runs} runs`;
  header.append(element("p", { class: "subtitle" }, `${file} · ${there}`));
  replaceContent(places.head, header);
  const outcome = filterSelect("outcome", "Show", [["", "all runs"], ["missed", "those that a detector missed"], ["early", "those with a false or early alarm"]]);
  const list = element("div", { id: "campaign-runs" }, element("h3", {}, "Run by run"), outcome, place("campaignDoing", { role: "status" }), place("campaignRuns"));
  host.append(
    sectionWith("campaign", "What was seen", filterRow(campaign.setup), place("campaignFigures"), list, place("campaignMessage", { role: "alert" })),
  );
  await showResults();
}
