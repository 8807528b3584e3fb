// Drives the live view of `offnominal studio --sil` in headless Chromium: curves move, a fault is injected with
// the keyboard, the alarm is seen, what was around it is looked at, and explained; a recording is written. The
// robot is copied with names that would be script where a page took them for markup.
//   node check_live.mjs --offnominal PROGRAM --robot R.toml [--screenshots FOLDER] [--measure SECONDS]
// R.toml: two joints; its monitor is put into torque space. --measure: R.toml as it is, pictures a second and the
// server's processor time and memory, and nothing else.
// Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { mkdtemp, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { checkWithAxe, readAxe } from "./accessible.mjs";

const kScript = "<img src=x onerror=window.hacked=1>";
const kLooks = [
  [1280, "light"],
  [1280, "dark"],
  [400, "light"],
  [2560, "dark"],
];
const web = fileURLToPath(new URL("../../desk/report/web/", import.meta.url));

function readArguments() {
  const text = { type: "string" };
  const { values } = parseArgs({
    options: {
      offnominal: text, robot: text, screenshots: text, measure: text,
      chromium: { type: "string", default: process.env.OFFNOMINAL_CHROMIUM ?? "/usr/bin/chromium" },
    },
  });
  for (const name of ["offnominal", "robot"]) {
    if (values[name] === undefined) throw new Error(`--${name} is needed`);
  }
  return values;
}

/** The robot judged joint by joint, under hostile names. */
async function hostileRobot(file, folder) {
  const robot = join(folder, "arm.toml");
  let count = 0; // joints have to have names that differ
  const text = (await readFile(file, "utf8"))
    .replace(/^name = ".*"$/gm, () => `name = "${kScript}${++count}"`)
    .replace(/^\[estimator\]$/m, '[estimator]\nspace = "torque"')
    .replace(/^\[uncertainty_bound\][\s\S]*$/m, '[uncertainty_bound]\nkind = "per_joint"\nvalue = [1.0, 1.0]\n');
  await writeFile(robot, text);
  return robot;
}

/** Starts Studio where it may write, and waits for its address. */
function startStudio(options, robot, folder) {
  const words = ["studio", "--sil", "--robot", robot, "--no-open", "--json"];
  const program = spawn(resolve(options.offnominal), words, { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
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

function pictures(page) {
  return page.evaluate(() => Number(document.body.dataset.pictures ?? 0));
}

/** Curves that move, and no alarm of a healthy arm. */
async function checkMoving(page, fault) {
  await page.waitForFunction(() => live.now?.judging && live.curves[0].threshold.length > 100);
  const before = await pictures(page);
  const newest = await page.evaluate(() => live.curves[0].threshold.at(-1)[0]);
  await page.waitForTimeout(1000);
  if ((await pictures(page)) <= before) fault("no picture is drawn in a second");
  if ((await page.evaluate(() => live.curves[0].threshold.at(-1)[0])) <= newest) fault("the curves stand still");
  if ((await page.getAttribute("body", "data-detection")) !== "") fault("a healthy arm raises an alarm");
  if (await page.isVisible("#effects")) fault("without a recording the analysis is there");
  const painted = await page.evaluate(() => {
    const canvas = document.querySelector(".live-picture canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4) colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return colours.size;
  });
  if (painted < 4) fault("the picture is empty");
}

/** With the keyboard alone. */
async function injectFault(page) {
  await page.focus("#fault-kind");
  await page.selectOption("#fault-kind", "disturbance_torque");
  await page.focus("#fault-joint");
  await page.selectOption("#fault-joint", "2");
  await page.fill("#fault-size", "8");
  await page.focus("#fault-inject");
  await page.keyboard.press("Enter");
}

async function checkAlarm(page, fault) {
  await injectFault(page);
  await page.waitForFunction(() => !["", undefined].includes(document.body.dataset.detection));
  const alarm = await page.textContent("#place-detection .note");
  if (!alarm.includes("Off nominal") || !alarm.includes("joint 2")) fault(`the alarm says: ${alarm}`);
  if (!(await page.textContent("#place-injected")).includes("Disturbance torque, joint 2")) fault("the fault is not listed");
  await page.waitForSelector("#live-explain:not([aria-disabled])");
  await page.waitForSelector("#place-frozen figure canvas");
  if ((await page.$$("#place-frozen figure")).length !== 2) fault("what was around the alarm is not there for every joint");
  const answer = await page.textContent("#place-detection .note");
  if (!answer.includes("confidence") && !answer.includes("Unknown")) fault(`isolation says nothing: ${answer}`);
}

async function checkExplanation(page, folder, fault) {
  await page.waitForFunction((s) => live.now.t_s > s, (await page.evaluate(() => live.now.detection.t_s)) + 6);
  await page.click("#live-explain");
  await page.waitForFunction(() => document.querySelector("#place-learn .answer-words") !== null);
  if ((await page.textContent("#place-learn")).trim().length < 40) fault("the explanation says nothing");
  if (!(await page.isVisible("#effects"))) fault("the analysis is not there");
  const title = await page.textContent(".subtitle");
  if (!title.includes("arm_detection.csv")) fault(`the analysis is of: ${title}`);
  const text = await readFile(join(folder, "arm_detection.csv"), "utf8");
  if (!text.startsWith("t,q1,q2,dq1,dq2,tau1,tau2\n")) fault("the recording is none");
  const before = await pictures(page);
  await page.waitForTimeout(500);
  if ((await pictures(page)) <= before) fault("beside the analysis the live view stands still");
}

async function checkRest(page, folder, fault) {
  await page.click("#live-record");
  await page.waitForFunction(() => live.now.recording_s > 0.5);
  await page.waitForFunction(() => document.getElementById("live-record").textContent.startsWith("Stop"));
  await page.click("#live-record");
  await page.waitForFunction(() => live.saved.startsWith("Written: "));
  if (!(await readdir(folder)).includes("arm_live.csv")) fault("the recording was not written");
  await page.click("#accommodation");
  await page.waitForSelector("#accommodation[aria-checked=true]");
  await page.click("#fault-end");
  await page.waitForFunction(() => live.now.faults.length === 0);
  await page.click("#live-again");
  await page.waitForFunction(() => document.body.dataset.detection === "" && live.now.judging);
  await page.fill("#fault-size", "1e9");
  await page.click("#fault-inject");
  await page.waitForSelector("#place-liveMessage .note");
  const words = await page.textContent("#place-liveMessage");
  if (!words.includes("has to be")) fault(`a size that cannot be is answered with: ${words}`);
}

async function look(page, options, axeSource, fault) {
  for (const [width, mode] of kLooks) {
    await page.setViewportSize({ width, height: 900 });
    await page.emulateMedia({ colorScheme: mode });
    await page.waitForTimeout(300);
    const inLook = (words) => fault(`${mode}, ${width} pixels wide: ${words}`);
    if (options.screenshots) {
      await page.screenshot({ path: join(options.screenshots, `live_${mode}_${width}.png`), fullPage: true });
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
    const refused = message.text().includes("400 (Bad Request)"); // a size that cannot be
    const slow = message.text().includes("GPU stall due to ReadPixels");
    const readBack = message.text().includes("willReadFrequently");
    if (["error", "warning"].includes(message.type()) && !refused && !slow && !readBack) fault(`console: ${message.text()}`);
  });
  await page.goto(address);
  await page.waitForSelector("body[data-live]");
  return page;
}

/** Processor time, s, and resident memory, MB. */
async function usage(pid) {
  const fields = (await readFile(`/proc/${pid}/stat`, "utf8")).replace(/^.*\) /, "").split(" ");
  const status = await readFile(`/proc/${pid}/status`, "utf8");
  return { cpu_s: (Number(fields[11]) + Number(fields[12])) / 100, rss_mb: Number(status.match(/VmRSS:\s+(\d+)/)[1]) / 1024 };
}

async function measure(page, program, seconds) {
  await page.waitForFunction(() => live.now?.judging);
  const [drawn, before, begun] = [await pictures(page), await usage(program.pid), performance.now()];
  await page.waitForTimeout(1000 * seconds);
  const [drawnThen, after, passed] = [await pictures(page), await usage(program.pid), (performance.now() - begun) / 1000];
  const rate = ((drawnThen - drawn) / passed).toFixed(1);
  const share = ((100 * (after.cpu_s - before.cpu_s)) / passed).toFixed(1);
  console.log(
    `${passed.toFixed(0)} s: ${rate} pictures a second; server ${share} % of a core, ` +
      `memory ${before.rss_mb.toFixed(1)} MB before, ${after.rss_mb.toFixed(1)} MB after`,
  );
}

async function check(options, fault) {
  const { chromium } = createRequire(join(web, "package.json"))("playwright-core");
  const axeSource = await readAxe(web);
  const folder = await mkdtemp(join(tmpdir(), "offnominal-live-"));
  const robot = options.measure ? resolve(options.robot) : await hostileRobot(options.robot, folder);
  const { program, ended, address } = startStudio(options, robot, folder);
  let browser;
  try {
    browser = await chromium.launch({
      executablePath: options.chromium,
      args: ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking"],
    });
    const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
    const page = await openPage(context, await address, fault);
    if (options.measure) return await measure(page, program, Number(options.measure));
    await checkMoving(page, fault);
    await checkAlarm(page, fault);
    await checkExplanation(page, folder, fault);
    await look(page, options, axeSource, fault);
    await checkRest(page, folder, fault);
    if (await page.evaluate(() => window.hacked !== undefined)) fault("a name was taken for markup");
    console.log("live: a fault was injected, seen, looked at, explained; a recording was written");
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
  console.error(`check_live: ${error.message}`);
  process.exitCode = 2;
}
