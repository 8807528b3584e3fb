// Drives `offnominal studio` in headless Chromium the whole way: look, add, watch the error fall, undo, save;
// and asks the verbs for the same numbers. Robot and recording are copied under names that would be script
// where a page took them for markup.
//   node check_studio.mjs --offnominal PROGRAM --robot R.toml --recording A.csv [--holdout B.csv] --joint N
//     --effect NAME [--screenshots FOLDER] [--measure] [--tour]
// --tour: the guided tour alone.
// Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { execFileSync } from "node:child_process";
import { appendFile, copyFile, readFile, writeFile } from "node:fs/promises";
import { extname, join, resolve } from "node:path";
import { checkArm, checkWithoutWebgl } from "./studio_arm.mjs";
import { checkNames, kScript, look, openPage, readArguments, runCheck } from "./studio_page.mjs";

const kLooks = [
  [1280, "light"],
  [1280, "dark"],
  [400, "light"],
  [2560, "light"],
  [3840, "dark"],
];
const kReady = "body[data-revision]";
const kPatience = 30000; // [ms]
const kExpected = ["409 (Conflict)"]; // that a file is there, say

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
  const recording = await copy(options.recording, "a");
  // Its writer was stopped in the midst of a line, which is left out: the page has to say so.
  if (extname(recording) === ".csv") await appendFile(recording, "0.1");
  return { robot, recording, holdout: await copy(options.holdout, "b") };
}

/** What was noted when the recording was read stands above the charts. */
async function checkRemarks(page, { recording }, fault) {
  if (extname(recording) !== ".csv") return;
  const head = await page.textContent("#place-head");
  if (!head.includes("last line is cut off")) fault(`of a line that was left out the page's head says: ${head}`);
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
  return JSON.parse(execFileSync(resolve(options.offnominal), [...words, "--json"], { stdio: ["ignore", "pipe", "ignore"] }));
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
    execFileSync("/bin/sh", ["-c", script], { env: { ...process.env, PROGRAM: resolve(options.offnominal) }, stdio: "pipe" });
  } catch (error) {
    return fault(`the commands of the page fail: ${error.stderr}`);
  }
  const again = saved.replace(/\.toml$/, "_again.toml");
  if ((await readFile(again, "utf8")) !== (await readFile(saved, "utf8"))) fault("the commands write another file");
}

/** Clicks, and what stands under the charts at the very end of the change, before those below the window are drawn anew. */
function clickAndLook(page, ids) {
  return page.evaluate(async (all) => {
    all.forEach((id) => document.getElementById(id).click());
    await new Promise((done) => {
      const watch = () => document.body.hasAttribute("data-busy") || done();
      new MutationObserver(watch).observe(document.body, { attributes: true });
    });
    const wrong = [...document.querySelectorAll("#place-charts figure")].flatMap((figure) => {
      const own = ` of ${figure.querySelector("h3").textContent}`;
      const said = [...figure.querySelectorAll(".hidden-text")].map((span) => span.textContent);
      return said.filter((words) => words !== own);
    });
    return { joint: Number(document.querySelector("input[name=joint]:checked").value), wrong };
  }, ids);
}

/** Choices while a change is under way wait for its end: the last one counts. */
async function checkHaste(page, options, fault) {
  const all = await page.$$eval("[name=joint]", (inputs) => inputs.map((each) => each.id));
  const own = `joint-${options.joint}`;
  const other = all.find((id) => id !== own);
  if (other === undefined) return;
  for (const ids of [[other], [own, other, own]]) {
    const { joint, wrong } = await clickAndLook(page, ids);
    if (`joint-${joint}` !== ids.at(-1)) fault(`after ${ids} joint ${joint} is shown`);
    if (wrong.length > 0) fault(`under the charts of joint ${joint} controls say "${wrong}"`);
  }
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
  const asked = page.waitForResponse((answer) => answer.url().includes("charts?") && answer.url().includes("from="));
  await page.evaluate(() =>
    studio.timeFigures()[0].chart.dispatchAction({ type: "dataZoom", dataZoomIndex: 0, start: 40, end: 60 }),
  );
  if ((await asked).status() !== 200) fault("zooming is refused");
  await page.waitForTimeout(100);
  if ((await page.evaluate(() => studio.zoomRange())) === null) fault("the zoom is lost");
}

async function titleAfter(page, place, act) {
  const title = () => page.$eval(place, (root) => root.querySelector("figure")?.textContent ?? "");
  const before = await title();
  await act();
  await page.waitForFunction(
    ([selector, old]) => (document.querySelector(selector).querySelector("figure")?.textContent ?? "") !== old,
    [place, before],
  );
  return title();
}

/** Map and spectrum follow what is chosen for their axes. */
async function checkExplored(page, fault) {
  const map = ".explored:first-child";
  const over = await titleAfter(page, map, () => page.selectOption("#map-x", "since_reversal"));
  if (!over.includes("time since reversal")) fault(`the map's words are: ${over}`);
  const spectrum = await titleAfter(page, ".explored:last-child", () => page.selectOption("#spectrum-over", "order"));
  if (!/order|waves per metre/.test(spectrum)) fault(`the spectrum's words are: ${spectrum}`);
}

/** The picture of a step, and a number that is dragged off its fit and snaps back. */
async function checkDrag(page, fault) {
  const fold = (id) => page.$eval(`details[id^=${id}]`, (details) => (details.open = true));
  await fold("evidence-of-step");
  await page.waitForSelector(".step .evidence figure");
  await fold("drag-");
  const atFit = await headline(page);
  const joint = () => page.textContent("input[name=joint]:checked + label");
  const before = await joint();
  await page.focus("input[id^=drag-]");
  for (let i = 0; i < 30; ++i) await page.keyboard.press("ArrowRight");
  // The first answer may be that of one small step, which no digit of the error shows.
  const until = Date.now() + kPatience;
  let off = atFit;
  while (!(off[1] > atFit[1]) && Date.now() < until) {
    await page.waitForTimeout(50);
    off = await headline(page);
  }
  if (!(off[1] > atFit[1])) fault(`dragged off its fit, the error went from ${atFit} to ${off}`);
  const words = await page.$eval("#place-headline", (root) => root.textContent);
  if (!words.includes("dragged")) fault(`while a number is dragged, the page says: ${words}`);
  // At this width the list of joints stays in sight, the headline does not.
  const beside = await joint();
  if (!beside.includes("dragged")) fault(`while a number is dragged, the list of joints says: ${beside}`);
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => !document.querySelector("#place-headline").textContent.includes("dragged"));
  const back = await headline(page);
  if (back[1] !== atFit[1]) fault(`let go, the error is ${back} and was ${atFit}`);
  const after = await joint();
  if (after !== before) fault(`let go, the list of joints says ${after}, and said ${before}`);
}

/** What was added is there for the next program over the same files; a page for others beside it. */
async function checkKept({ start, newContext }, words, page, fault) {
  const names = (on) => on.$$eval(".step .step-head h3", (all) => all.map((each) => each.textContent));
  const before = await names(page);
  await page.click("#save-page");
  await page.waitForFunction(() => document.querySelector("#place-save .note")?.textContent.includes(".html"));
  await page.evaluate(() => studio.showTime({ from: 2, to: 5 }));
  await page.waitForResponse((answer) => answer.url().endsWith("api/look"));
  const again = await start(words);
  const other = await openPage(await newContext(), again.address, kReady, kExpected, fault);
  const after = await names(other);
  if (after.join() !== before.join()) fault(`the next program takes up "${after}" of "${before}"`);
  await other.waitForFunction(() => studio.zoomRange() !== null).catch(() => fault("the next program shows all of the time"));
  const shown = await other.evaluate(() => studio.zoomRange());
  if (Math.abs(shown.from - 2) > 0.01 || Math.abs(shown.to - 5) > 0.01) fault(`the next program shows ${JSON.stringify(shown)}`);
  await page.evaluate(() => studio.showWhole());
  await afterChange(other, () => other.click("#begin-anew"));
  if ((await names(other)).length !== 0) fault("begun anew, there are steps");
  await other.context().close(); // before its server: what it still asks for would be refused
  await again.end();
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

/** A stranger does what the tour says, by the keyboard, and presses nothing else: the error falls with every click. */
async function checkTour({ options, start, newContext, axeSource }, words, fault) {
  const { address, end } = await start([...words, "--no-session"]);
  const page = await openPage(await newContext(), address, kReady, kExpected, fault);
  const told = () => page.textContent("#tour-callout");
  const focused = () => page.evaluate(() => document.activeElement.id);
  await page.focus("#tour-start");
  await page.keyboard.press("Enter");
  if ((await focused()) !== "tour-callout") fault(`when the tour begins the focus is on "${await focused()}"`);
  const first = await told();
  if (!first.includes("%") || !first.includes("look")) fault(`the tour begins with: ${first}`);
  await look(page, [[400, "light"], [1280, "dark"], [2560, "light"]], "tour_look", { ...options, axeSource }, fault);
  await page.focus("#tour-next");
  await page.keyboard.press("Enter");
  if ((await page.$eval(".tour-target", ({ id }) => id)) !== "search") fault("the tour does not mark the search");
  const isInView = () => {
    const { top, bottom } = document.getElementById("tour-callout").getBoundingClientRect();
    return top >= 0 && bottom <= window.innerHeight;
  };
  await page.waitForFunction(isInView, undefined, { timeout: 10_000 }).catch(() => fault("behind Next the tour is out of sight"));
  let clicks = 0;
  const errors = [];
  for (;;) {
    const target = await page.$(".tour-target");
    if (target === null) break;
    const label = await told();
    if (!label.includes(`click ${++clicks}`)) fault(`click ${clicks} of the tour is told so: ${label}`);
    if (clicks === 2) await look(page, [[400, "dark"], [1280, "light"], [2560, "light"]], "tour_add", { ...options, axeSource }, fault);
    await target.focus();
    await page.keyboard.press("Enter");
    const isOver = (before) => !document.body.hasAttribute("data-busy") && studio.session.found.state !== "running" && document.querySelector(".tour-title").textContent !== before;
    await page.waitForFunction(isOver, await page.textContent(".tour-title")).catch(() => {});
    errors.push((await headline(page))[0]);
    if ((await focused()) !== "tour-callout") fault(`behind click ${clicks} of the tour the focus is on "${await focused()}"`);
    await page.waitForFunction(isInView, undefined, { timeout: 10_000 }).catch(() => fault(`behind click ${clicks} the tour is out of sight`));
    if (clicks > 20) break;
  }
  const rose = await page.evaluate(() => studio.state().joints.filter(({ start, now }) => now.fitted_percent > start.fitted_percent + 1e-9).map(({ joint }) => joint));
  const fell = await page.evaluate(() => studio.state().joints.some(({ start, now }) => now.fitted_percent < 0.9 * start.fitted_percent));
  if (rose.length > 0 || !fell) fault(`with the clicks of the tour the error is ${errors}, and of joints ${rose} larger`);
  if (!(await told()).includes("what came of it")) fault(`the tour ends with: ${await told()}`);
  await look(page, [[400, "light"], [1280, "light"]], "tour_end", { ...options, axeSource }, fault);
  await page.focus("#tour-end");
  await page.keyboard.press("Enter");
  if ((await page.$("#tour-callout")) !== null || (await focused()) !== "tour-start") fault("the tour does not end");
  await page.context().close();
  await end();
  await checkSkippedTour({ start, newContext }, words, fault);
  return `${clicks} clicks, error ${errors.join(" → ")} %`;
}

/** Who skips to the end without a search hears of none. */
async function checkSkippedTour({ start, newContext }, words, fault) {
  const { address, end } = await start([...words, "--no-session"]);
  const page = await openPage(await newContext(), address, kReady, kExpected, fault);
  await page.click("#tour-start");
  await page.click("#tour-next");
  await page.click("#tour-next");
  const told = await page.textContent("#tour-callout");
  if (!told.includes("No search has run")) fault(`skipped to its end without a search, the tour says: ${told}`);
  await page.click("#tour-end");
  await page.context().close();
  await end();
}

/** Milliseconds from a click to new charts in the window, of switching an effect on (never seen) and off again. */
async function measure(page) {
  const times = [];
  await page.evaluate(() => document.getElementById("place-charts").scrollIntoView());
  await page.waitForTimeout(1000);
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
  console.log(`all of them, ms: ${times.map((each) => each.toFixed(0)).join(" ")}`);
}

async function check({ options, folder, start, newContext, axeSource }, fault) {
  const inputs = await hostileInputs(options, folder);
  const words = [inputs.recording, "--robot", inputs.robot, ...(inputs.holdout ? ["--holdout", inputs.holdout] : [])];
  if (options.tour) return console.log(await checkTour({ options, start, newContext, axeSource }, words, fault));
  const { address } = await start(words);
  const page = await openPage(await newContext(), address, kReady, kExpected, fault);
  if (options.measure) return await measure(page);
  await checkRemarks(page, inputs, fault);
  await checkSteps(page, options, inputs, fault);
  await checkExplored(page, fault);
  await checkDrag(page, fault);
  await checkZoom(page, fault);
  await checkArm(page, fault);
  const learnt = await checkSearch(page, fault);
  const tour = await checkTour({ options, start, newContext, axeSource }, words, fault);
  await checkKept({ start, newContext }, words, page, fault);
  await look(page, kLooks, "studio", { ...options, axeSource }, fault);
  const plain = await newContext();
  await plain.addInitScript(() => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...more);
    };
  });
  await checkWithoutWebgl(await openPage(plain, address, kReady, kExpected, fault), fault);
  await checkNames(page, fault);
  console.log(`studio: added, undone, saved, searched (${learnt}), toured (${tour}); the verbs say the same`);
}

const kOptions = { holdout: { type: "string" }, measure: { type: "boolean", default: false }, tour: { type: "boolean", default: false } };
await runCheck("studio", () => readArguments(["offnominal", "robot", "recording", "joint", "effect"], kOptions), check);
