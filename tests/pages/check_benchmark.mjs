// Drives `offnominal studio --benchmark` in headless Chromium: a few cases of the benchmark are run and written, their
// table is looked at and filtered, a case is opened with the keyboard, and what it hides is added.
//   node check_benchmark.mjs --offnominal PROGRAM --bench PROGRAM [--screenshots FOLDER]
// Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { execFileSync } from "node:child_process";
import { join, resolve } from "node:path";
import { checkNames, look, openPage, readArguments, runCheck } from "./studio_page.mjs";

const kLooks = [
  [1400, "light"],
  [400, "dark"],
];

async function choose(page, key, value) {
  const before = await page.evaluate(() => document.body.dataset.results);
  await page.selectOption(`#results-${key}`, value);
  await page.waitForFunction((old) => document.body.dataset.results !== old, before);
}

function shown(page) {
  return page.evaluate(() => studio.results.runs);
}

async function check({ options, folder, start, newContext, axeSource }, fault) {
  const file = join(folder, "bench.sqlite");
  const words = ["--cases", "small", "--most", "6", "--seed", "77", "--threads", "2", "--results", file, "--write", join(folder, "cases"), "--json"];
  const told = JSON.parse(execFileSync(resolve(options.bench), words, { cwd: folder, stdio: ["ignore", "pipe", "ignore"] }));
  const { address } = await start(["--benchmark", file]);
  const page = await openPage(await newContext(), address, "body[data-results]", ["409 (Conflict)"], fault);
  await page.setViewportSize({ width: 1400, height: 900 });
  const { count, runs } = await shown(page);
  if (count !== told.cases.length) fault(`${count} of ${told.cases.length} cases are listed`);
  runs.forEach(({ cells }, at) => {
    if (cells[1].words !== told.cases[at].hidden) fault(`case ${at} is said to hide ${cells[1].words}, not ${told.cases[at].hidden}`);
  });
  await look(page, kLooks, "benchmark", { ...options, axeSource }, fault);
  await page.setViewportSize({ width: 1400, height: 900 });
  const [effect, joint] = told.cases[0].hidden.split("@");
  await choose(page, "effect", effect);
  const left = await shown(page);
  const expected = told.cases.filter(({ hidden }) => hidden.startsWith(`${effect}@`)).length;
  if (left.count !== expected) fault(`${left.count} cases hide ${effect}, not ${expected}`);
  await choose(page, "effect", "");
  await page.focus("#open-run-0");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => studio.results.open === 0 && !studio.results.busy && document.body.dataset.revision === "0");
  if (!(await page.textContent("#place-run h2")).includes("Case 0")) fault("which case is open is not said");
  await page.check(`#joint-${joint}`);
  await page.waitForFunction(() => !document.body.hasAttribute("data-busy"));
  const switched = await page.$(`#switch-${effect}:not([aria-disabled])`);
  if (switched === null) fault(`${effect} cannot be switched on`);
  else {
    const before = await page.evaluate((at) => studio.state().joints[at - 1].now.held_out_percent, joint);
    await switched.click();
    await page.waitForFunction(() => document.body.dataset.revision === "1" && !document.body.hasAttribute("data-busy"));
    const after = await page.evaluate((at) => studio.state().joints[at - 1].now.held_out_percent, joint);
    if (!(after < before)) fault(`with ${effect} the error goes from ${before} to ${after} %`);
  }
  await checkNames(page, fault);
  console.log(`benchmark: ${count} cases looked at, filtered, and case 0 (${effect} on joint ${joint}) opened`);
}

await runCheck("benchmark", () => readArguments(["offnominal", "bench"]), check);
