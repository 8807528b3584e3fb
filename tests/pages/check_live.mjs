// Drives the live view of `offnominal studio --sil` in headless Chromium: curves move, a fault is injected with
// the keyboard, the alarm is seen, what was around it is looked at, and explained; a recording is written. The
// robot is copied with names that would be script where a page took them for markup.
//   node check_live.mjs --offnominal PROGRAM --robot R.toml [--screenshots FOLDER] [--measure SECONDS]
// R.toml: two joints; its monitor is put into torque space. --measure: R.toml as it is, pictures a second and the
// server's processor time and memory, and nothing else.
// Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { readFile, readdir, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { checkNames, kScript, look, openPage, readArguments, runCheck } from "./studio_page.mjs";

const kLooks = [
  [1280, "light"],
  [1280, "dark"],
  [400, "light"],
  [2560, "dark"],
];

const kFrozenLooks = [
  [400, "light"],
  [400, "dark"],
];

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

function pictures(page) {
  return page.evaluate(() => Number(document.body.dataset.pictures ?? 0));
}

/** Curves that move, and no alarm of a healthy arm. */
async function checkMoving(page, fault) {
  await page.waitForFunction(() => studio.live.now?.judging && studio.live.curves[0].threshold.length > 100);
  const before = await pictures(page);
  const newest = await page.evaluate(() => studio.live.curves[0].threshold.at(-1)[0]);
  await page.waitForTimeout(1000);
  if ((await pictures(page)) <= before) fault("no picture is drawn in a second");
  if ((await page.evaluate(() => studio.live.curves[0].threshold.at(-1)[0])) <= newest) fault("the curves stand still");
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
  await page.fill("#fault-size", "");
  await page.click("#fault-inject");
  const refused = await page.textContent("#place-liveMessage");
  if (!refused.includes("no number")) fault(`an empty size is answered with: ${refused}`);
  if (!(await page.textContent("#place-injected")).includes("8 N m")) fault("an empty size replaces a fault that is there");
  await page.waitForSelector("#live-explain:not([aria-disabled])");
  await page.waitForSelector("#place-frozen figure canvas");
  if ((await page.$$("#place-frozen figure")).length !== 2) fault("what was around the alarm is not there for every joint");
  const answer = await page.textContent("#place-detection .note");
  if (!answer.includes("confidence") && !answer.includes("Unknown")) fault(`isolation says nothing: ${answer}`);
}

/** Of the first chart around the detection: its width, that of its place, and the colour of its numbers. */
function frozenLook(page) {
  return page.evaluate(() => {
    const { chart, host } = studio.live.frozen[0];
    return { width: chart.getWidth(), room: host.clientWidth, ink: chart.getOption().xAxis[0].axisLabel.color };
  });
}

/** What is around the alarm follows window and colours before any session is there to bring charts of its own. */
async function checkFrozen(page, options, fault) {
  const { ink: light } = await frozenLook(page);
  await look(page, kFrozenLooks, "live_frozen", options, fault);
  const { width, room, ink } = await frozenLook(page);
  if (width !== room) fault(`the chart around the alarm is ${width} pixels wide in a place of ${room}`);
  if (ink === light) fault(`in dark colours the numbers of the chart around the alarm stay ${ink}`);
  await page.setViewportSize({ width: 1280, height: 900 });
  await page.emulateMedia({ colorScheme: "light" });
}

async function checkExplanation(page, folder, fault) {
  await page.waitForFunction((s) => studio.live.now.t_s > s, (await page.evaluate(() => studio.live.now.detection.t_s)) + 6);
  await page.click("#live-explain");
  await page.waitForFunction(() => document.querySelector("#place-learn .answer-words") !== null);
  if ((await page.textContent("#place-learn")).trim().length < 40) fault("the explanation says nothing");
  if (!(await page.isVisible("#effects"))) fault("the analysis is not there");
  const title = await page.textContent(".subtitle");
  if (!title.includes("arm_detection.csv")) fault(`the analysis is of: ${title}`);
  const text = await readFile(join(folder, "arm_detection.csv"), "utf8");
  if (!text.startsWith("t,q1,q2,dq1,dq2,tau1,tau2\n")) fault("the recording is none");
  const goesOn = page.waitForFunction((before) => Number(document.body.dataset.pictures ?? 0) > before, await pictures(page), { timeout: 20_000 });
  await goesOn.catch(() => fault("beside the analysis the live view stands still"));
}

/** A second page over the same run shows the analysis that the first has asked for, and its own click begins no other. */
async function checkOtherPage(other, page, fault) {
  const shown = other.waitForFunction(() => document.querySelector("#place-learn .answer-words") !== null, undefined, { timeout: 30_000 });
  await shown.catch(() => fault("a second page does not show the analysis that the first has asked for"));
  if (!(await other.isVisible("#effects"))) fault("on a second page the analysis is not there");
  const session = () => page.evaluate(() => studio.live.now.session);
  const before = await session();
  await other.click("#live-explain");
  await other.waitForFunction(() => studio.live.saved.startsWith("Written: "));
  await other.waitForTimeout(300);
  if ((await session()) !== before) fault("a second page's click begins another session over the same detection");
  await other.close();
}

async function checkRest(page, folder, fault) {
  await page.click("#live-record");
  await page.waitForFunction(() => studio.live.now.recording_s > 0.5);
  await page.waitForFunction(() => document.getElementById("live-record").textContent.startsWith("Stop"));
  await page.click("#live-record");
  await page.waitForFunction(() => studio.live.saved.startsWith("Written: "));
  if (!(await readdir(folder)).includes("arm_live.csv")) fault("the recording was not written");
  await page.click("#accommodation");
  await page.waitForSelector("#accommodation[aria-checked=true]");
  await page.click("#fault-end");
  await page.waitForFunction(() => studio.live.now.faults.length === 0);
  await page.click("#live-again");
  await page.waitForFunction(() => document.body.dataset.detection === "" && studio.live.now.judging);
  await page.fill("#fault-size", "1e9");
  await page.click("#fault-inject");
  await page.waitForSelector("#place-liveMessage .note");
  const words = await page.textContent("#place-liveMessage");
  if (!words.includes("has to be")) fault(`a size that cannot be is answered with: ${words}`);
}

/** Processor time, s, and resident memory, MB. */
async function usage(pid) {
  const fields = (await readFile(`/proc/${pid}/stat`, "utf8")).replace(/^.*\) /, "").split(" ");
  const status = await readFile(`/proc/${pid}/status`, "utf8");
  return { cpu_s: (Number(fields[11]) + Number(fields[12])) / 100, rss_mb: Number(status.match(/VmRSS:\s+(\d+)/)[1]) / 1024 };
}

async function measure(page, program, seconds) {
  await page.waitForFunction(() => studio.live.now?.judging);
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

async function check({ options, folder, start, newContext, axeSource }, fault) {
  const robot = options.measure ? resolve(options.robot) : await hostileRobot(options.robot, folder);
  const { address, program } = await start(["--sil", "--robot", robot]);
  const expected = ["400 (Bad Request)", "willReadFrequently"]; // a size that cannot be; a picture that is read back
  const page = await openPage(await newContext(), address, "body[data-live]", expected, fault);
  if (options.measure) return await measure(page, program, Number(options.measure));
  await checkMoving(page, fault);
  await checkAlarm(page, fault);
  await checkFrozen(page, { ...options, axeSource }, fault);
  const other = await openPage(await newContext(), address, "body[data-live]", expected, fault);
  await checkExplanation(page, folder, fault);
  await checkOtherPage(other, page, fault);
  await look(page, kLooks, "live", { ...options, axeSource }, fault);
  await checkRest(page, folder, fault);
  await checkNames(page, fault);
  console.log("live: a fault was injected, seen, looked at, explained; a recording was written");
}

await runCheck("live", () => readArguments(["offnominal", "robot"], { measure: { type: "string" } }), check);
