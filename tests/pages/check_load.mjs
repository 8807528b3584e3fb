// Drives `offnominal studio` without recordings in headless Chromium the whole way: a robot file is chosen, recordings
// are dropped, their columns are looked at and put right, and the session that comes of it is compared with the verbs.
//   node check_load.mjs --offnominal PROGRAM --robot R.toml --recording A.csv [--screenshots FOLDER]
// A.csv: of R.toml's two joints in the common format. It is written anew as a stranger would have it: other names,
// positions in degrees, the torque of joint 2 with the other sign.
// Exit 0: all went well. Exit 1: one line per fault on stderr. Exit 2: it could not be checked.
import { execFileSync } from "node:child_process";
import { mkdir, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { checkNames, kScript, look, openPage, readArguments, runCheck } from "./studio_page.mjs";

const kLooks = [
  [400, "light"],
  [400, "dark"],
  [1280, "light"],
  [1280, "dark"],
  [2560, "light"],
];
/** Of what is looked at with little around it. */
const kSomeLooks = [
  [400, "light"],
  [1280, "dark"],
  [2560, "light"],
];
const kRobotName = `arm${kScript}.toml`;
const kRecordingName = `run${kScript}.csv`;

/** Robot and recording as somebody else has them, outside of the folder in which Studio writes. */
async function strangersFiles(options, folder) {
  const theirs = join(folder, "theirs");
  await mkdir(theirs);
  let count = 0; // joints have to have names that differ
  const robot = (await readFile(options.robot, "utf8")).replace(/^name = ".*"$/gm, () => `name = "${kScript}${++count}"`);
  const [header, ...rows] = (await readFile(options.recording, "utf8")).trim().split("\n");
  if (header !== "t,q1,q2,dq1,dq2,tau1,tau2") throw new Error(`the recording has ${header}`);
  const degrees = (text) => String((Number(text) * 180) / Math.PI);
  const lines = rows.map((row) => {
    const [t, q1, q2, dq1, dq2, tau1, tau2] = row.split(",");
    return [t, degrees(q1), degrees(q2), dq1, dq2, tau1, String(-Number(tau2))].join(",");
  });
  const text = ["time,actual_pos_1,actual_pos_2,actual_vel_1,actual_vel_2,drive_torque_1,drive_torque_2", ...lines].join("\n");
  const files = { robot: join(theirs, kRobotName), recording: join(theirs, kRecordingName), text };
  await writeFile(files.robot, robot);
  await writeFile(files.recording, text);
  return files;
}

/** Until what was asked for is there and shown. */
async function settled(page, act) {
  const before = await page.evaluate(() => studio.mapView.asked);
  await act();
  await page.waitForFunction(
    (asked) => studio.mapView.asked > asked && studio.load.doing === "" && document.body.dataset.load === String(studio.load.state.revision),
    before,
  );
}

async function chooseByKeyboard(page, file, fault) {
  // Chromium takes a moment to learn that somebody listens.
  const asked = page.waitForEvent("filechooser");
  await page.waitForTimeout(500);
  await page.focus("#load-choose");
  await page.keyboard.press("Enter");
  const chooser = await asked;
  if (!chooser.isMultiple()) fault("only one file can be chosen");
  await chooser.setFiles(file);
  await page.waitForFunction(() => studio.load.doing === "" && studio.load.state.robot?.file.endsWith(".toml") && studio.load.state.urdf === null);
}

/** As from a file manager. */
async function drop(page, files) {
  const data = await page.evaluateHandle((all) => {
    const transfer = new DataTransfer();
    for (const [name, text] of all) transfer.items.add(new File([text], name));
    return transfer;
  }, files);
  await page.dispatchEvent("body", "dragover", { dataTransfer: data });
  await page.dispatchEvent("body", "drop", { dataTransfer: data });
}

async function checkEmpty(page, looks, fault) {
  const words = await page.textContent("#load");
  for (const said of ["Drop recordings", "Choose files", ".urdf", "At most", "offnominal new"]) {
    if (!words.includes(said)) fault(`the empty page does not say "${said}"`);
  }
  if (await page.isVisible("#effects")) fault("without files the analysis is there");
  await looks("load_empty");
}

async function checkRefused(page, fault) {
  await drop(page, [["none.csv", ""], ["broken.toml", "name = 3\n"]]);
  await page.waitForFunction(() => studio.load.doing === "" && document.querySelectorAll("#place-loadMessage .note.bad").length === 2);
  const words = await page.textContent("#place-loadMessage");
  for (const file of ["none.csv", "broken.toml"]) {
    if (!words.includes(file)) fault(`of ${file} is said: ${words}`);
  }
  if (words.includes("/tmp/") || words.includes("offnominal-studio-")) fault(`the message names a folder: ${words}`);
  if ((await page.evaluate(() => studio.load.state.recordings.length)) !== 0) fault("what cannot be read is there");
}

/** Two arms on one post. */
const kTwoArms = (() => {
  const limit = '<limit lower="-2" upper="2" velocity="3" effort="10"/>';
  const link = (name) => `<link name="${name}"><inertial><origin xyz="0.2 0 0"/><mass value="1"/><inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>`;
  const joint = (parent, child, more = "") => `<joint name="to_${child}" type="revolute"><parent link="${parent}"/><child link="${child}"/><axis xyz="0 1 0"/>${limit}${more}</joint>`;
  const parts = [link("left"), link("left_hand"), link("right"), joint("post", "left"), joint("left", "left_hand"), joint("post", "right", '<mimic joint="to_left"/>')];
  return `<robot name="two"><link name="post"/>${parts.join("")}</robot>`;
})();

/** Of a URDF with several chains one is chosen by the keyboard; one that import-urdf refuses is refused beside the choice. */
async function checkChains(page, looks, fault) {
  const idle = () => page.waitForFunction(() => studio.load.doing === "");
  await drop(page, [["two.urdf", kTwoArms]]);
  await page.waitForSelector("#chain");
  const words = await page.textContent("#chain");
  for (const said of ["post to left_hand, 2 joints", "post to right, 1 joint"]) {
    if (!words.includes(said)) fault(`of the chains is said: ${words}`);
  }
  if (await page.evaluate(() => studio.load.state.robot !== null)) fault("a chain is taken unasked");
  await page.selectOption("#chain", { label: "post to right, 1 joint" });
  await page.focus("#take-chain");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#chain-wrong");
  await idle();
  const wrong = await page.textContent("#chain-wrong");
  if (!wrong.includes("two.urdf") || !wrong.includes("mimic")) fault(`of a chain with a mimic is said: ${wrong}`);
  if ((await page.textContent("#chain option:checked")) !== "post to right, 1 joint") fault("a refused chain is chosen no more");
  await looks("load_chain", kSomeLooks);
  await page.selectOption("#chain", { label: "post to left_hand, 2 joints" });
  await page.focus("#take-chain");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => studio.load.doing === "" && (studio.load.state.urdf?.chosen ?? null) !== null);
  if ((await page.evaluate(() => document.activeElement.id)) !== "take-chain") fault("once a chain is taken the focus is lost");
  if ((await page.evaluate(() => studio.load.state.robot.joints.length)) !== 2) fault("the chosen chain has not its joints");
  if ((await page.$("#chain-wrong")) !== null) fault("what was refused stays where another chain is taken");
}

function errorOf(page, joint) {
  return page.evaluate((at) => studio.mapView.findings?.joints.find((each) => each.joint === at)?.error_percent ?? null, joint);
}

function curve(page, quantity, joint) {
  return page.evaluate(
    ([what, of]) => studio.mapView.preview.signals.find((each) => each.quantity === what && each.joint === of).high,
    [quantity, joint],
  );
}

async function checkColumns(page, looks, fault) {
  const chosen = (id) => page.inputValue(id);
  if ((await chosen("#signal-position-2-source")) !== "actual_pos_2") fault("the position's column is not guessed");
  if ((await chosen("#signal-position-2-unit")) !== "deg") fault("that positions are in degrees is not guessed");
  if ((await chosen("#signal-torque-1-source")) !== "drive_torque_1") fault("the torque's column is not guessed");
  if ((await page.$$(".sketch svg")).length !== 6) fault("not every signal has its picture");
  const sign = await page.textContent('[aria-label="Joint 2"] [data-finding="torque_sign"]').catch(() => "");
  if (!sign.includes("To mend")) fault("that the torque's sign is turned is not said beside it");
  await looks("load_map");
  const [wrong, high] = [await errorOf(page, 2), await curve(page, "torque", 2)];
  // With the keyboard alone; the focus stays where it is.
  await page.focus("#signal-torque-2-sign");
  await settled(page, () => page.keyboard.press("Space"));
  if ((await page.evaluate(() => document.activeElement.id)) !== "signal-torque-2-sign") fault("after a change the focus is lost");
  if ((await page.$$("[data-finding]")).length > 0) fault(`put right, the doctor says: ${await page.textContent("#place-loadMap .note")}`);
  const [right, low] = [await errorOf(page, 2), await curve(page, "torque", 2)];
  if (!(right < wrong / 2) || low === high) fault(`with the right sign the error is ${right}, and was ${wrong}`);
  await settled(page, () => page.selectOption("#signal-position-1-unit", "rad"));
  if ((await page.$$("[data-finding]")).length === 0) fault("the doctor has nothing to say of degrees taken for radians");
  await settled(page, () => page.selectOption("#signal-position-1-unit", "deg"));
  await settled(page, () => page.selectOption("#signal-velocity-1-source", ""));
  if (!(await page.textContent("#place-loadMap pre")).includes('velocity = ["", {source = "actual_vel_2"}]')) fault("a velocity that is derived is not written so");
  await settled(page, () => page.selectOption("#signal-velocity-1-source", "actual_vel_1"));
}

/** Said by the keyboard alone; what cannot be is refused beside it, and what was written stays. */
async function checkPayload(page, looks, fault) {
  const id = await page.evaluate(() => studio.load.state.recordings[0].id);
  const field = (name) => `#payload-${id}-${name}`;
  const focused = () => page.evaluate(() => document.activeElement.id);
  const errors = async () => [await errorOf(page, 1), await errorOf(page, 2)];
  const before = await errors();
  // The look for accessibility has unfolded everything.
  await page.$eval(`#payload-${id}`, (fold) => (fold.open = false));
  await page.press(field("summary"), "Enter");
  await page.waitForSelector(`#payload-${id}[open]`);
  await page.fill(field("mass_kg"), "-1");
  for (const name of ["x_m", "y_m"]) await page.fill(field(name), "0");
  await page.press(field("y_m"), "Enter");
  const wrong = () => page.textContent(field("wrong"));
  if (!(await wrong()).includes("z: empty")) fault(`of an empty field is said: ${await wrong()}`);
  if ((await page.getAttribute(field("z_m"), "aria-invalid")) !== "true") fault("an empty field is not marked");
  if ((await focused()) !== field("y_m").slice(1)) fault("after a refusal the focus is lost");
  await page.fill(field("z_m"), "0.1");
  await settled(page, () => page.press(field("z_m"), "Enter"));
  if (!(await wrong()).includes("allowed: a mass of 0 kg or more and a place in m; to mend: write a mass of 0 to")) fault(`of a negative mass is said: ${await wrong()}`);
  if ((await page.inputValue(field("mass_kg"))) !== "-1") fault("what was written is gone with its refusal");
  if (await page.isVisible("#place-loadMessage .note")) fault("a payload is refused far from its fields");
  await looks("load_payload", kSomeLooks);
  await page.fill(field("mass_kg"), "0.05");
  await settled(page, () => page.press(field("mass_kg"), "Enter"));
  if ((await focused()) !== field("mass_kg").slice(1)) fault("once the payload is set the focus is lost");
  const summary = await page.textContent(field("summary"));
  if (!summary.includes("0.05 kg at [0, 0, 0.1] m")) fault(`a payload that is set reads ${summary}`);
  const loaded = await errors();
  if (loaded.join() === before.join()) fault("with a payload the error stays as it was");
  await page.focus(field("remove"));
  await settled(page, () => page.keyboard.press("Enter"));
  if ((await focused()) !== field("summary").slice(1)) fault("once the payload is taken away the focus is lost");
  if ((await errors()).join() !== before.join()) fault("without the payload the error is another than before it");
  await page.fill(field("mass_kg"), "0.05");
  for (const [name, text] of [["x_m", "0"], ["y_m", "0"], ["z_m", "0.1"]]) await page.fill(field(name), text);
  await settled(page, () => page.click(field("set")));
  if ((await errors()).join() !== loaded.join()) fault("the same payload makes another error");
}

/** The same motion in two files: positions, and torques in every other sample whose clock began an hour before. */
function inTwoFiles(text) {
  const cells = text.split("\n").map((line) => line.split(","));
  const lines = (rows) => rows.map((row) => row.join(",")).join("\n");
  const torques = cells.slice(1).filter((_, at) => at % 2 === 1).map(([t, , , , , ...rest]) => [Number(t) + 3600, ...rest]);
  return [
    [`currents${kScript}.csv`, lines([["time", "drive_torque_1", "drive_torque_2"], ...torques])],
    [`positions${kScript}.csv`, lines(cells.map((row) => row.slice(0, 5)))],
  ];
}

/** Files that are one recording are taken for one, taken apart and joined by the keyboard, and their clocks put right. */
async function checkSeveralFiles(page, text, looks, fault) {
  const names = () => page.evaluate(() => studio.load.state.recordings.map(({ name }) => name));
  const focused = () => page.evaluate(() => document.activeElement.id);
  const [currents, positions] = inTwoFiles(text);
  await settled(page, () => drop(page, [currents, positions]));
  const joined = `${positions[0]}+${currents[0]}`;
  if ((await names()).join() !== joined) fault(`files of one recording are ${await names()}`);
  const told = await page.textContent(".joined-why");
  if (!told.includes(`positions, velocities in ${positions[0]}, torques in ${currents[0]}`)) fault(`why files are joined is told so: ${told}`);
  const wrong = await page.textContent("#place-loadMap .note.bad");
  if (!wrong.includes("3600")) fault(`of clocks that share no time is said: ${wrong}`);
  if ((await page.$$(".sketch svg")).length !== 6) fault("of clocks that share no time the columns are not drawn");
  await page.fill("#signal-time-2-offset", "-3600");
  await settled(page, () => page.press("#signal-time-2-offset", "Tab"));
  if ((await page.$("#place-loadMap .note.bad[role=note]:not([data-finding])")) !== null) fault(`with its offset it is refused: ${await page.textContent("#place-loadMap .note.bad")}`);
  if (!(await page.textContent("#place-loadMap pre")).includes("offset = -3600.0")) fault("the offset of a clock is not written");
  const id = await page.evaluate(() => studio.load.state.recordings[0].id);
  await page.press(`#files-${id}-summary`, "Enter");
  await looks("load_files", kSomeLooks);
  await page.focus(`#split-${id}`);
  await settled(page, () => page.keyboard.press("Enter"));
  if ((await names()).join() !== `${currents[0]},${positions[0]}`) fault(`taken apart they are ${await names()}`);
  if ((await focused()) !== `files-${id}-summary`) fault("once files are taken apart the focus is lost");
  const other = await page.evaluate((not) => studio.load.state.recordings.find((one) => one.id !== not).id, id);
  await page.$eval(`#files-${other}`, (fold) => (fold.open = true));
  await page.focus(`#join-${other}`);
  await settled(page, () => page.keyboard.press("Enter"));
  if ((await names()).join() !== joined) fault(`joined by hand they are ${await names()}`);
  if ((await focused()) !== `files-${id}-summary`) fault("once files are joined the focus is lost");
  if (!(await page.textContent("#place-loadMap pre")).includes("offset = -3600.0")) fault("what was said of a clock is lost where files are joined again");
  await page.click(`#remove-${id}`);
  await page.waitForFunction(() => studio.load.doing === "" && studio.load.state.recordings.length === 0);
}

/** Readings at rest are another kind of recording: no time, no velocities, and what is written is for explain. */
async function checkHoldMap(page, folder, looks, fault) {
  const rows = () => page.$$eval(".signal h4", (all) => all.map(({ textContent }) => textContent));
  const text = () => page.textContent("#place-loadMap .use ~ pre");
  const before = await text();
  await page.focus("#at-rest");
  await settled(page, () => page.keyboard.press("Space"));
  if ((await page.evaluate(() => document.activeElement.id)) !== "at-rest") fault("once readings are at rest the focus is lost");
  if ((await rows()).join() !== "Position,Torque,Position,Torque") fault(`of a hold map there is ${await rows()}`);
  if (await page.isVisible("#signal-time-source")) fault("a hold map has a time");
  if (!(await text()).startsWith("[channels]\nat_rest = true")) fault(`of a hold map is written ${await text()}`);
  if (!(await page.textContent("#place-loadMap")).includes("readings at rest. Time and velocities are not read")) fault("what a hold map has is not said");
  await looks("load_at_rest", kSomeLooks);
  await page.focus("#use-these");
  await page.keyboard.press("Enter");
  const commands = await page.textContent("#at-rest-commands");
  const channels = (await page.textContent("#place-loadMessage .note.good")).match(/[^ ,]*_channels[^ ,]*\.toml/)?.[0];
  if (!commands.includes("offnominal explain") || !commands.includes("--channels")) fault(`the commands of a hold map are ${commands}`);
  const written = (await readdir(folder)).filter((name) => name.endsWith(".toml"));
  if (channels === undefined || written.length !== 2) fault(`of a hold map is written ${written}, and said ${channels}`);
  for (const name of written) await rm(join(folder, name));
  await settled(page, () => page.click("#at-rest"));
  if ((await page.$("#at-rest-commands")) !== null) fault("commands of a hold map stay where there is none");
  if ((await text()) !== before) fault("back in time the columns are others");
}

async function useThese(page, fault) {
  await page.click("#use-these");
  await page.waitForFunction(() => studio.load.doing === "" && (studio.load.written.length > 0 || studio.load.message !== null));
  if (await page.evaluate(() => studio.load.message !== null)) fault(`using them is refused: ${await page.textContent("#place-loadMessage")}`);
  await page.waitForSelector("body[data-revision]");
  await page.waitForFunction(() => !document.body.hasAttribute("data-busy"));
}

/** What was written says the same to `compare`, and what the page prints can be run. */
async function checkSession(page, options, folder, files, fault) {
  await useThese(page, fault);
  const written = await page.evaluate(() => studio.load.written);
  const [robot, channels] = written.map((name) => join(folder, name));
  if (written.length !== 2 || !(await readFile(channels, "utf8")).startsWith("[channels]\n")) fault(`written is ${written}`);
  const payload = `${kRecordingName}=0.05@0,0,0.1`;
  const text = execFileSync(resolve(options.offnominal), ["compare", files.recording, "--robot", robot, "--channels", channels, "--payload", payload, "--json"], { stdio: ["ignore", "pipe", "ignore"] });
  for (const { joint, relative_error_percent: percent } of JSON.parse(text).joints) {
    const shown = await page.evaluate((at) => studio.state().joints[at - 1].now.fitted_percent, joint);
    if (Math.abs(shown - percent) > 1e-9) fault(`joint ${joint}: compare says ${percent} %, the page ${shown} %`);
  }
  if (await page.isVisible("#load-drop")) fault("with a session the files are not folded up");
  await page.check("#joint-2");
  await page.click("#switch-viscous_friction");
  await page.waitForFunction(() => document.body.dataset.revision === "1" && !document.body.hasAttribute("data-busy"));
  const lines = await page.textContent("#place-save pre");
  if (!lines.includes("--channels") || !lines.includes(payload)) fault(`the commands are ${lines}`);
  execFileSync("/bin/sh", ["-c", `set -e\noffnominal() { "$PROGRAM" "$@"; }\n${lines}\n`], {
    // They name the recording alone: it lies elsewhere, as the page says.
    cwd: await besideRecording(folder, files, written), env: { ...process.env, PROGRAM: resolve(options.offnominal) }, stdio: "pipe",
  });
  if (!(await page.textContent("#place-save")).includes("where they lie")) fault("where the commands can be run is not said");
}

async function besideRecording(folder, files, written) {
  const theirs = join(folder, "theirs");
  for (const name of written) await writeFile(join(theirs, name), await readFile(join(folder, name)));
  return theirs;
}

/** A session with steps is not lost without a question. */
async function checkAnew(page, fault) {
  if (!(await page.isVisible("#use-these"))) await page.click("#load-fold-summary");
  await page.click("#use-these");
  await page.waitForSelector("#use-anyway");
  await page.click("#use-anyway");
  await page.waitForFunction(() => studio.load.doing === "" && studio.state().steps.length === 0);
  if (await page.evaluate(() => studio.load.message !== null)) fault("beginning anew is refused");
}

/** What was said of columns and recordings lies on the disk while the program runs: whatever ends it, the next one has it. */
async function checkNextProgram(page, start, newContext, files, looks, fault) {
  const said = () => page.evaluate(() => studio.load.state.map.text);
  const { address, end } = await start([]);
  const next = await openPage(await newContext(), address, "body[data-load]", [], fault);
  await chooseByKeyboard(next, files.robot, fault);
  await settled(next, () => drop(next, [[kRecordingName, files.text]]));
  const [before, after] = [await said(), await next.evaluate(() => studio.load.state.map.text)];
  if (after !== before) fault(`the next program reads ${after}, this one ${before}`);
  const words = await next.textContent("#place-loadMap .note.neutral");
  if (!words.includes("the torque of joint 2") || !words.includes("studio_columns.json")) fault(`of what is taken up is said: ${words}`);
  const payload = await next.evaluate(() => studio.load.state.recordings[0].payload?.words ?? "none");
  if (!payload.startsWith("0.05 kg")) fault(`the payload of the next program is ${payload}`);
  await looks(next);
  await settled(next, () => next.click("#guess-again"));
  if ((await next.$("#place-loadMap .note.neutral")) !== null) fault("guessed again, what was taken up is still said");
  await next.close();
  await end();
}

async function check({ options, folder, start, newContext, axeSource }, fault) {
  const files = await strangersFiles(options, folder);
  const { address, end } = await start([]);
  const page = await openPage(await newContext(), address, "body[data-load]", ["422 (Unprocessable", "409 (Conflict)"], fault);
  const looks = (name, sizes = kLooks) => look(page, sizes, name, { ...options, axeSource }, fault);
  await checkEmpty(page, looks, fault);
  await page.setViewportSize({ width: 1400, height: 900 });
  await checkRefused(page, fault);
  await checkChains(page, looks, fault);
  await chooseByKeyboard(page, files.robot, fault);
  if ((await page.$("#chain")) !== null) fault("beside a robot file a chain of another one can be chosen");
  await checkSeveralFiles(page, files.text, looks, fault);
  await page.setViewportSize({ width: 1400, height: 900 });
  await settled(page, () => drop(page, [[kRecordingName, files.text]]));
  await checkColumns(page, looks, fault);
  await checkPayload(page, looks, fault);
  await checkHoldMap(page, folder, looks, fault);
  await checkSession(page, options, folder, files, fault);
  await looks("load_used");
  await checkAnew(page, fault);
  await checkNextProgram(page, start, newContext, files, (next) => look(next, kSomeLooks, "load_kept", { ...options, axeSource }, fault), fault);
  await checkNames(page, fault);
  await page.close();
  await end();
  const left = (await readdir(folder)).filter((name) => name.startsWith("offnominal-studio-"));
  if (left.length > 0) fault(`left behind: ${left}`);
  console.log("studio: files dropped, columns put right, a session begun; compare says the same");
}

await runCheck("load", () => readArguments(["offnominal", "robot", "recording"]), check);
