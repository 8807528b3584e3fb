// Drives `offnominal studio --campaign` in headless Chromium the whole way: a campaign is run, its tables and curves are
// looked at, filtered by fault and by detector, a run is opened with the keyboard, and the verbs are asked for the same.
//   node check_campaign.mjs --offnominal PROGRAM --campaign FILE.toml [--screenshots FOLDER]
// FILE.toml: a campaign with faults of the kinds friction and payload, of two joints, and fault-free runs.
// Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { execFileSync } from "node:child_process";
import { join, resolve } from "node:path";
import { checkNames, look, openPage, readArguments, runCheck } from "./studio_page.mjs";

const kLooks = [
  [1400, "light"],
  [1400, "dark"],
  [400, "light"],
  [400, "dark"],
];

function verb(options, folder, ...words) {
  return execFileSync(resolve(options.offnominal), words, { cwd: folder, stdio: ["ignore", "pipe", "ignore"] });
}

function tableOf(page, caption) {
  return page.$$eval("#place-resultsFigures table", (all, name) => {
    const table = all.find((each) => each.caption.textContent === name);
    return table === undefined ? [] : [...table.tBodies[0].rows].map((row) => row.cells[0].textContent);
  }, caption);
}

async function choose(page, key, value) {
  const before = await page.evaluate(() => document.body.dataset.results);
  await page.selectOption(`#results-${key}`, value);
  await page.waitForFunction((old) => document.body.dataset.results !== old, before);
}

function runsShown(page) {
  return page.evaluate(() => studio.results.runs);
}

async function checkFigures(page, summary, fault) {
  const titles = await page.$$eval("#place-resultsFigures figure h3", (all) => all.map((each) => each.textContent));
  for (const title of ["Faults seen against false alarms", "Time from fault to alarm"]) {
    if (!titles.includes(title)) fault(`there is no chart "${title}"`);
  }
  if ((await page.$$("#place-resultsFigures canvas")).length < 3) fault("the charts are not drawn");
  for (const detector of summary.detectors) {
    const rows = await tableOf(page, detector.name);
    if (rows.length !== detector.faults.length) fault(`of ${detector.name} ${rows.length} faults are told, not ${detector.faults.length}`);
  }
}

async function checkFilter(page, summary, fault) {
  const { count: all } = await runsShown(page);
  if (all !== summary.runs) fault(`${all} of ${summary.runs} runs are listed`);
  await choose(page, "kind", "friction");
  await choose(page, "joint", "2");
  const [one, two] = summary.detectors;
  const { count, runs } = await runsShown(page);
  const expected = one.faults.filter(({ kind, joint }) => kind === "friction" && joint === 2);
  if (count !== expected.reduce((sum, { runs: of }) => sum + of, 0)) fault(`${count} runs have friction at joint 2`);
  if (!runs.every(({ cells }) => cells[0].words === "friction, joint 2")) fault("other runs are listed beside");
  if ((await tableOf(page, one.name)).length !== expected.length) fault("the tables do not follow the choice of a fault");
  await choose(page, "outcome", "missed");
  const missed = await runsShown(page);
  if (!missed.runs.every(({ cells }) => cells.some(({ words }) => words === "not seen"))) fault("runs that are seen are listed as missed");
  await choose(page, "outcome", "");
  await choose(page, "detector", two.name);
  if ((await tableOf(page, one.name)).length > 0) fault("a detector that is not chosen is told of");
  await choose(page, "detector", "");
}

/** A run by the keyboard alone, and the same by the verbs. */
async function checkRun(page, options, folder, file, fault) {
  const { run } = (await runsShown(page)).runs.at(-1);
  await page.focus(`#open-run-${run}`);
  await page.keyboard.press("Enter");
  await page.waitForFunction((number) => studio.results.open === number && !studio.results.busy && document.body.dataset.revision === "0", run);
  if (!(await page.textContent("#place-run h2")).includes(`Run ${run}`)) fault("which run is open is not said");
  const [first] = await page.evaluate(() => [studio.timeFigures()[0].block.events.map(({ label }) => label)]);
  if (!first.includes("friction")) fault(`the chart marks ${first}`);
  verb(options, folder, "campaign", "record", file, "--run", String(run), "-o", "same.csv", "--model", "same.toml");
  const { joints } = JSON.parse(verb(options, folder, "compare", "same.csv", "--robot", "same.toml", "--json"));
  for (const { joint, relative_error_percent: percent } of joints) {
    const shown = await page.evaluate((at) => studio.state().joints[at - 1].now.fitted_percent, joint);
    if (Math.abs(shown - percent) > 1e-9) fault(`joint ${joint}: compare says ${percent} %, the page ${shown} %`);
  }
  return run;
}

/** What each of the campaign's monitors saw of the run: charts with the fault on their time. */
async function checkWatched(page, summary, fault) {
  await page.waitForSelector("#watched-fold-0");
  await page.focus("#watched-fold-0-summary");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#watched-fold-0 canvas");
  const monitors = await page.$$eval("#watched-monitor option", (all) => all.map((each) => each.value));
  const known = summary.detectors.map(({ name }) => name);
  if (monitors.length === 0 || !monitors.every((name) => known.includes(name))) fault(`monitors to choose from: ${monitors}`);
  for (const name of monitors.slice(1)) {
    await page.selectOption("#watched-monitor", name);
    await page.waitForSelector("#watched-fold-0[open] canvas");
  }
  const titles = await page.$$eval("#place-watched figure h3", (all) => all.map((each) => each.textContent));
  if (!titles.some((each) => each.startsWith("Residual against its threshold"))) fault(`the monitor's charts are ${titles}`);
  if (!(await page.textContent("#place-watched .note")).includes("nominal")) fault("what the monitor says is not shown");
}

async function checkSession(page, options, folder, run, fault) {
  await page.check("#joint-2");
  await page.waitForFunction(() => !document.body.hasAttribute("data-busy"));
  await page.click("#switch-coulomb_friction");
  await page.waitForFunction(() => document.body.dataset.revision === "1" && !document.body.hasAttribute("data-busy"));
  const lines = await page.textContent("#place-save pre");
  execFileSync("/bin/sh", ["-c", `set -e\noffnominal() { "$PROGRAM" "$@"; }\n${lines}\n`], {
    cwd: folder, env: { ...process.env, PROGRAM: resolve(options.offnominal) }, stdio: "pipe",
  });
  await page.click(`#open-run-${run}`);
  await page.waitForSelector("#open-anyway");
  await page.click("#open-anyway");
  await page.waitForFunction(() => !studio.results.busy && studio.state().steps.length === 0);
}

async function check({ options, folder, start, newContext, axeSource }, fault) {
  const file = resolve(options.campaign);
  const results = join(folder, "results.sqlite");
  const summary = JSON.parse(verb(options, folder, "campaign", file, "-o", results, "--json"));
  const { address } = await start(["--campaign", results, file]);
  const page = await openPage(await newContext(), address, "body[data-results]", ["409 (Conflict)"], fault);
  await page.setViewportSize({ width: 1400, height: 900 });
  await checkFigures(page, summary, fault);
  await look(page, kLooks, "campaign", { ...options, axeSource }, fault);
  await page.setViewportSize({ width: 1400, height: 900 });
  await checkFilter(page, summary, fault);
  const run = await checkRun(page, options, folder, file, fault);
  await checkWatched(page, summary, fault);
  await look(page, kLooks, "campaign_run", { ...options, axeSource }, fault);
  await page.setViewportSize({ width: 1400, height: 900 });
  await checkSession(page, options, folder, run, fault);
  await checkNames(page, fault);
  console.log(`campaign: looked at, filtered, run ${run} opened; the verbs say the same`);
}

await runCheck("campaign", () => readArguments(["offnominal", "campaign"]), check);
