// The picture of the arm in Studio: that it is drawn, that it follows the cursor, by keys too, that A and B are
// compared, and that the numbers stay where a browser has no WebGL.

/** Colours of the picture as it is drawn now, no more than 64 of them. */
function coloursOf(page) {
  return page.evaluate(() => {
    const { view } = studio.arm;
    view.drawNow();
    const copy = document.createElement("canvas");
    copy.width = copy.height = 128;
    const context = copy.getContext("2d", { willReadFrequently: true });
    context.drawImage(view.renderer.domElement, 0, 0, 128, 128);
    const { data } = context.getImageData(0, 0, 128, 128);
    const colours = new Set();
    for (let i = 0; i < data.length && colours.size < 64; i += 4) {
      if (data[i + 3] > 0) colours.add(`${data[i]},${data[i + 1]},${data[i + 2]}`);
    }
    return [...colours];
  });
}

function shown(page) {
  return page.evaluate(() => ({
    time: document.querySelector("output.arm-time").textContent,
    table: document.querySelector("#arm-table tbody").textContent,
    pictures: studio.arm.view?.pictures ?? 0,
    camera: studio.arm.view?.camera.position.toArray().join() ?? "",
  }));
}

/**
 * Presses a key on the picture; returns what was shown before, and after it was drawn anew. A busy machine without a
 * graphics card takes its time for that; a picture that is not drawn within 10 s does not follow.
 */
async function press(page, key) {
  const before = await shown(page);
  await page.press("#arm-view", key);
  await page
    .waitForFunction((drawn) => studio.arm.view.pictures > drawn, before.pictures, { timeout: 10_000 })
    .catch(() => undefined);
  return [before, await shown(page)];
}

export async function checkArm(page, fault) {
  await page.waitForFunction(() => studio.arm.view?.pictures > 0);
  const colours = await coloursOf(page);
  if (colours.length < 8) fault(`the picture of the arm has ${colours.length} colours`);
  const [before, after] = await press(page, "ArrowRight");
  if (after.time === before.time || after.table === before.table) fault("the right arrow does not move the arm in time");
  if (after.pictures <= before.pictures) fault("the picture does not follow the cursor");
  const [straight, turned] = await press(page, "Shift+ArrowLeft");
  if (turned.camera === straight.camera) fault("shift and an arrow do not turn the view");
  if (turned.time !== straight.time) fault("turning the view moves it in time");
  const [far, near] = await press(page, "+");
  if (near.camera === far.camera) fault("+ does not bring the arm nearer");
  await page.press("#arm-view", "0");
  await page.press("#arm-view", "a");
  for (let i = 0; i < 3; ++i) await page.press("#arm-view", "ArrowRight");
  await page.press("#arm-view", "b");
  await page.waitForFunction(() => document.querySelectorAll("#arm-marks tbody tr").length > 0);
  const joints = await page.evaluate(() => studio.arm.data.joints.length);
  // A row of times stands above the joints.
  if ((await page.$$("#arm-marks tbody tr")).length !== joints + 1) fault("A and B are not compared joint by joint");
  await page.evaluate(() => studio.timeFigures()[0].chart.dispatchAction({ type: "updateAxisPointer", x: 300, y: 60 }));
  const still = await shown(page);
  await page.click("#arm-play");
  await page.waitForFunction((time) => document.querySelector("output.arm-time").textContent !== time, still.time);
  await page.click("#arm-play");
  if ((await page.textContent("#arm-play")).trim() !== "Play") fault("the second press does not stop the arm");
}

/** A browser without WebGL: words instead of a picture, and the same numbers. */
export async function checkWithoutWebgl(page, fault) {
  await page.waitForSelector(".arm-none");
  if ((await page.$("#arm-view")) !== null) fault("without WebGL an empty picture is left");
  if ((await page.$$("#arm-table tbody tr")).length === 0) fault("without WebGL the numbers of the arm are missing");
  const before = await page.textContent("output.arm-time");
  await page.press("#arm-time", "ArrowRight");
  if ((await page.textContent("output.arm-time")) === before) fault("without WebGL the slider moves nothing");
}
