// Drives `offnominal studio` in headless Chromium the whole way: look, add, watch the error fall, undo, save;
// and asks the verbs for the same numbers. Robot and recording are copied under names that would be script
// where a page took them for markup.
//   node check_studio.mjs --offnominal PROGRAM --robot R.toml --recording A.csv [--holdout B.csv] --joint N
//     --effect NAME [--screenshots FOLDER] [--measure]
// Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { execFileSync, spawn } from "node:child_process";
import { createRequire } from "node:module";
import { copyFile, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { checkWithAxe, readAxe } from "./accessible.mjs";
import { checkArm, checkWithoutWebgl } from "./studio_arm.mjs";

const kScript = "<img src=x onerror=window.hacked=1>";
const kLooks = [
  [1280, "light"],
  [1280, "dark"],
  [400, "light"],
  [2560, "light"],
  [3840, "dark"],
];
const web = fileURLToPath(new URL("../../desk/report/web/", import.meta.url));

function readArguments() {
  const text = { type: "string" };
  const { values } = parseArgs({
    options: {
      offnominal: text, robot: text, recording: text, holdout: text, joint: text, effect: text,
      screenshots: text, measure: { type: "boolean", default: false },
      chromium: { type: "string", default: process.env.OFFNOMINAL_CHROMIUM ?? "/usr/bin/chromium" },
    },
  });
  for (const name of ["offnominal", "robot", "recording", "joint", "effect"]) {
    if (values[name] === undefined) throw new Error(`--${name} is needed`);
  }
  return values;
}

/** The inputs under hostile names, in a folder of their own. */
async function hostileInputs(options, folder) {
  const robot = join(folder, "robot.toml");
  const text = await readFile(options.robot, "utf8");
  let count = 0; // joints have to have names that differ
  await writeFile(robot, text.replace(/^name = ".*"$/gm, () => `name = "${kScript}${++count}"`));
  const copy = async (file, name) => {
    if (file === undefined) return undefined;
    const to = join(folder, `${name}${kScript}${extname(file)}`);
    await copyFile(file, to);
    return to;
  };
  return { robot, recording: await copy(options.recording, "a"), holdout: await copy(options.holdout, "b") };
}

/** Starts Studio and waits for its address. */
function startStudio(options, inputs) {
  const words = ["studio", inputs.recording, "--robot", inputs.robot, "--no-open", "--json"];
  if (inputs.holdout) words.push("--holdout", inputs.holdout);
  const program = spawn(options.offnominal, words, { stdio: ["ignore", "pipe", "inherit"] });
  const ended = new Promise((done) => program.on("exit", (code, signal) => done({ code, signal })));
  const address = new Promise((found, failed) => {
    let said = "";
    program.stdout.on("data", (data) => {
      said += data;
      const at = said.match(/"address": "([^"]+)"/);
      if (at) found(at[1]);
    });
    program.on("exit", () => failed(new Error("studio ended before it said its address")));
  });
  address.catch(() => {}); // who waits for it later hears of it
  return { program, ended, address };
}

/** The numbers in the page's head, as they are read: [held out, fitted]. */
function headline(page) {
  return page.$$eval("#place-headline .value", (all) => all.map((each) => Number.parseFloat(each.textContent.replace(/^\D+/, ""))));
}

async function afterChange(page, act) {
  const before = await page.evaluate(() => document.body.dataset.revision);
  await act();
  await page.waitForFunction(
    (old) => document.body.dataset.revision !== old && !document.body.hasAttribute("data-busy"),
    before,
  );
}

function verb(options, ...words) {
  return JSON.parse(execFileSync(options.offnominal, [...words, "--json"], { stdio: ["ignore", "pipe", "ignore"] }));
}

async function checkSaved(page, options, inputs, fault) {
  const [, fitted] = await headline(page);
  await page.fill("#save-name", "saved.toml");
  await page.click("#save-file");
  await page.waitForFunction(() => document.querySelector("#place-save .note") !== null);
  const words = await page.textContent("#place-save .note");
  if (!words.includes("Written: ")) fault(`saving says: ${words}`);
  const saved = join(inputs.robot, "..", "saved.toml");
  const compared = verb(options, "compare", inputs.recording, "--robot", saved);
  const same = compared.joints[Number(options.joint) - 1].relative_error_percent.toFixed(2);
  if (same !== fitted.toFixed(2)) fault(`compare of the saved file says ${same} %, the page ${fitted} %`);
  const added = join(inputs.robot, "..", "added.toml");
  const words2 = ["add", options.effect, "--joint", options.joint, "--robot", inputs.robot, "--log", inputs.recording];
  if (inputs.holdout) words2.push("--holdout", inputs.holdout);
  verb(options, ...words2, "-o", added);
  if ((await readFile(saved, "utf8")) !== (await readFile(added, "utf8"))) fault("the saved file is not that of add");
  await checkCommands(page, options, saved, fault);
  await page.click("#save-file");
  await page.waitForSelector("#save-anyway");
  // Another name: what was asked of the old one is no question any more.
  await page.fill("#save-name", "other.toml");
  if ((await page.$("#save-anyway")) !== null) fault("another name leaves the question about the old one");
}

/** What the page prints, run by a shell as it stands, writes the saved file once more. */
async function checkCommands(page, options, saved, fault) {
  const lines = await page.textContent("#place-save pre");
  const script = `set -e\noffnominal() { "$PROGRAM" "$@"; }\n${lines}\n`;
  try {
    execFileSync("/bin/sh", ["-c", script], { env: { ...process.env, PROGRAM: options.offnominal }, stdio: "pipe" });
  } catch (error) {
    return fault(`the commands of the page fail: ${error.stderr}`);
  }
  const again = saved.replace(/\.toml$/, "_again.toml");
  if ((await readFile(again, "utf8")) !== (await readFile(saved, "utf8"))) fault("the commands write another file");
}

/** Choices while a change is under way wait for its end: the last one counts. */
async function checkHaste(page, options, fault) {
  const all = await page.$$eval("[name=joint]", (inputs) => inputs.map((each) => each.id));
  const own = `joint-${options.joint}`;
  const other = all.find((id) => id !== own);
  if (other === undefined) return;
  await page.evaluate(([first, last]) => [first, last].forEach((id) => document.getElementById(id).click()), [other, own]);
  await page.waitForFunction(() => !document.body.hasAttribute("data-busy"));
  const [joint, title] = await page.evaluate(() => [look.joint, document.querySelector("#place-charts h3").textContent]);
  if (joint !== Number(options.joint)) fault(`chosen in haste, joint ${joint} is shown`);
  const tools = await page.$$eval("#place-charts figure:first-child .hidden-text", (spans) => spans.map((each) => each.textContent));
  if (!tools.every((words) => words === ` of ${title}`)) fault(`under "${title}" a control says "${tools}"`);
}

async function checkSteps(page, options, inputs, fault) {
  const toggle = `#switch-${options.effect}`;
  await page.check(`#joint-${options.joint}`);
  await page.waitForFunction(() => !document.body.hasAttribute("data-busy"));
  const asRead = await headline(page);
  await afterChange(page, () => page.click(toggle));
  const added = await headline(page);
  if (!(added[0] < asRead[0] || Number.isNaN(asRead[0])) || !(added[1] < asRead[1])) {
    fault(`the error did not fall: ${asRead} became ${added}`);
  }
  await checkHaste(page, options, fault);
  const text = `${toggle}-text`;
  await page.click(`${text} summary`);
  await afterChange(page, () => page.click(".step button"));
  if (await page.evaluate(() => document.activeElement === document.body)) fault("after Undo the focus is lost");
  if (!(await page.$eval(text, (details) => details.open))) fault("after a change what was unfolded is shut");
  const undone = await headline(page);
  if (undone[1] !== asRead[1]) fault(`undone, the error is ${undone}, and was ${asRead}`);
  // With the keyboard alone; the focus stays on the switch.
  await page.focus(toggle);
  await afterChange(page, () => page.keyboard.press("Space"));
  const focus = await page.evaluate(() => document.activeElement.id);
  if (`#${focus}` !== toggle) fault(`after a change the focus is on "${focus}"`);
  await checkSaved(page, options, inputs, fault);
}

/** A zoom asks for finer curves and keeps its range. */
async function checkZoom(page, fault) {
  const asked = page.waitForResponse((answer) => answer.url().includes("only=time"));
  await page.evaluate(() =>
    timeFigures()[0].chart.dispatchAction({ type: "dataZoom", dataZoomIndex: 0, start: 40, end: 60 }),
  );
  if ((await asked).status() !== 200) fault("zooming is refused");
  await page.waitForTimeout(100);
  if ((await page.evaluate(() => zoomRange())) === null) fault("the zoom is lost");
}

async function checkSearch(page, fault) {
  await page.click("#search");
  await page.waitForFunction(() => document.querySelector("#place-learn .answer-words") !== null);
  const words = await page.textContent("#place-learn");
  if (words.trim().length < 40) fault("the search says nothing");
  const button = await page.$("#place-learn .main:not(#search)");
  if (button === null) return "nothing to add";
  await afterChange(page, () => button.click());
  if ((await page.$$(".step")).length !== 2) fault("a card's button adds nothing");
  return "added from a card";
}

/** Milliseconds from a click to new charts, of switching an effect on (never seen) and off again. */
async function measure(page) {
  const times = [];
  for (const id of await page.$$eval(".switch:not([aria-disabled])[aria-checked=false]", (all) => all.map((each) => each.id))) {
    const ms = await page.evaluate(async (id) => {
      const before = document.body.dataset.revision;
      const start = performance.now();
      document.getElementById(id).click();
      while (document.body.hasAttribute("data-busy")) await new Promise((done) => requestAnimationFrame(done));
      return document.body.dataset.revision === before ? null : performance.now() - start;
    }, id);
    if (ms === null) continue; // refused by the fit
    times.push(ms);
    await afterChange(page, () => page.click(`#${id}`));
  }
  times.sort((a, b) => a - b);
  const at = (share) => times[Math.min(times.length - 1, Math.floor(share * times.length))].toFixed(0);
  console.log(`click to new charts: median ${at(0.5)} ms, p95 ${at(0.95)} ms, ${times.length} clicks`);
}

async function look(page, options, axeSource, fault) {
  for (const [width, mode] of kLooks) {
    await page.setViewportSize({ width, height: 900 });
    await page.emulateMedia({ colorScheme: mode });
    await page.waitForTimeout(150);
    const inLook = (words) => fault(`${mode}, ${width} pixels wide: ${words}`);
    if (options.screenshots) {
      const name = `studio_${mode}_${width}.png`;
      await page.screenshot({ path: join(options.screenshots, name), fullPage: true });
    }
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    if (wide > 0) inLook(`the page is ${wide} pixels wider than the window`);
    await checkWithAxe(page, axeSource, inLook);
  }
}

async function openPage(context, address, fault) {
  await context.route("**/*", (route) => {
    if (route.request().url().startsWith(address)) return route.continue();
    fault(`the page asks for ${route.request().url().slice(0, 200)}`);
    return route.abort();
  });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  page.on("pageerror", (error) => fault(`script error: ${error.message}`));
  page.on("console", (message) => {
    const refused = message.text().includes("409 (Conflict)"); // that a file is there, say
    // Chromium's own, of a picture that is read back for a screenshot.
    const slow = message.text().includes("GPU stall due to ReadPixels");
    if (["error", "warning"].includes(message.type()) && !refused && !slow) fault(`console: ${message.text()}`);
  });
  await page.goto(address);
  await page.waitForSelector("body[data-revision]");
  return page;
}

async function check(options, fault) {
  const { chromium } = createRequire(join(web, "package.json"))("playwright-core");
  const axeSource = await readAxe(web);
  const folder = await mkdtemp(join(tmpdir(), "offnominal-studio-"));
  const inputs = await hostileInputs(options, folder);
  const { program, ended, address } = startStudio(options, inputs);
  let browser;
  try {
    browser = await chromium.launch({
      executablePath: options.chromium,
      args: ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking"],
    });
    const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
    const page = await openPage(context, await address, fault);
    if (options.measure) return await measure(page);
    await checkSteps(page, options, inputs, fault);
    await checkZoom(page, fault);
    await checkArm(page, fault);
    const learnt = await checkSearch(page, fault);
    // axe needs a page whose policy lets its source in: it comes by the debugger, which is let in.
    await look(page, options, axeSource, fault);
    const plain = await browser.newContext({ viewport: { width: 1280, height: 900 } });
    await plain.addInitScript(() => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
        return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...more);
      };
    });
    await checkWithoutWebgl(await openPage(plain, await address, fault), fault);
    if (await page.evaluate(() => window.hacked !== undefined)) fault("a name was taken for markup");
    console.log(`studio: added, undone, saved, searched (${learnt}); the verbs say the same`);
  } finally {
    await browser?.close();
    program.kill("SIGINT");
    const { code, signal } = await ended;
    if (code !== 0) fault(`Ctrl-C ends it with ${code ?? signal}`);
    await rm(folder, { recursive: true, force: true });
  }
}

const faults = [];
try {
  await check(readArguments(), (text) => faults.push(text));
  for (const text of new Set(faults)) console.error(text);
  process.exitCode = faults.length === 0 ? 0 : 1;
} catch (error) {
  for (const text of new Set(faults)) console.error(text);
  console.error(`check_studio: ${error.message}`);
  process.exitCode = 2;
}
