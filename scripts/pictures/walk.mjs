// Pictures of docs/diagnosis.md, "The whole way, on seven joints".
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { axis, kLook, kWidth, legend, lineSeries, pointsSeries, save, stroke, words } from "./drawing.mjs";
import { said } from "./said.mjs";

/** The charts of the page that `verb` of the command writes, by their titles. */
function chartsOf(offnominal, verb) {
  const folder = mkdtempSync(join(tmpdir(), "offnominal-pictures-"));
  try {
    const page = join(folder, "page.html");
    said(offnominal, [...verb, "--report", page]);
    const [, data] = readFileSync(page, "utf8").match(/<script type="application\/json" id="data">([^]*?)<\/script>/);
    const blocks = JSON.parse(data).sections.flatMap((section) => section.blocks);
    return new Map(blocks.filter((block) => block.type === "chart").map((chart) => [chart.title, chart]));
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

function pairsOf(series, from = -Infinity, to = Infinity) {
  return series.x.map((x, i) => [x, series.y[i]]).filter(([x]) => x >= from && x <= to);
}

/** What the walk has: the scenario's fault, what replay says of the recording, and the charts of its page. */
export function readWalk(folder, offnominal) {
  const recording = join(folder, "friction.csv");
  const robot = ["--robot", join(folder, "watched.toml")];
  const scenario = readFileSync(join(folder, "friction.toml"), "utf8");
  return {
    fault_s: Number(scenario.match(/begin_s = (\S+)/)[1]),
    joint: Number(scenario.match(/joint = (\S+)/)[1]),
    size: Number(scenario.match(/\nsize = (\S+)/)[1]),
    replay: JSON.parse(said(offnominal, ["replay", recording, ...robot, "--json"])),
    residuals: chartsOf(offnominal, ["replay", recording, ...robot]),
    errors: chartsOf(offnominal, ["compare", recording, ...robot]),
  };
}

/** Residual and threshold of every joint about the fault, one strip per joint over the same time. */
export function drawResiduals(walk, file) {
  const [left, right, top, strip, gap] = [92, 22, 66, 64, 18];
  const [from, to] = [walk.fault_s - 0.5, walk.fault_s + 1];
  const joints = walk.replay.joints;
  const [fault] = walk.replay.faults;
  const xOf = (time) => left + ((time - from) / (to - from)) * (kWidth - left - right);
  const topOf = (index) => top + index * (strip + gap);
  const bottom = topOf(joints.length) - gap;
  const graphic = [
    words(`Each joint behind its filter of ${walk.replay.filter.alpha_per_s} 1/s, N m`, 12, 20, { size: 15, weight: 600 }),
    ...legend(
      [
        { name: "|residual|", color: kLook.tones.residual, kind: "line", width: 116 },
        { name: "threshold", color: kLook.tones.threshold, kind: "dashed", width: 116 },
      ],
      480,
      20,
    ),
    stroke([xOf(walk.fault_s), 42], [xOf(walk.fault_s), bottom], kLook.ink, { dashed: true }),
    words(`friction on joint ${walk.joint} up by ${walk.size} N m`, xOf(walk.fault_s) - 6, 50, {
      size: 12,
      align: "right",
    }),
    stroke([xOf(fault.time_s), 42], [xOf(fault.time_s), bottom], kLook.levels.good),
    words(`named: friction up by ${fault.size.toFixed(2)} N m`, xOf(fault.time_s) + 6, 50, {
      size: 12,
      color: kLook.levels.good,
    }),
  ];
  const series = [];
  const spans = { xAxis: [], yAxis: [], grid: [] };
  joints.forEach(({ name, detection_time_s }, index) => {
    const chart = walk.residuals.get(`Residual against its threshold, ${name}`);
    const [residual, threshold] = chart.series.map((each) => pairsOf(each, from, to));
    const highest = Math.max(...[...residual, ...threshold].map(([, y]) => y));
    const end = Math.ceil(highest * 2) / 2;
    const last = index + 1 === joints.length;
    spans.grid.push({ left, right, top: topOf(index), height: strip, outerBoundsMode: "none" });
    spans.xAxis.push(
      axis({
        gridIndex: index,
        min: from,
        max: to,
        interval: 0.5,
        axisLabel: { show: last, color: kLook.soft },
        splitLine: { show: false },
        name: last ? "time [s]" : "",
        nameLocation: "middle",
        nameGap: 28,
      }),
    );
    spans.yAxis.push(axis({ gridIndex: index, min: 0, max: end, interval: end }));
    const place = { xAxisIndex: index, yAxisIndex: index };
    series.push(lineSeries(threshold, kLook.tones.threshold, { ...place, dashed: true, sampling: "none" }));
    series.push(lineSeries(residual, kLook.tones.residual, { ...place, width: 1.2 }));
    const isFirst = detection_time_s !== null;
    graphic.push(words(`joint ${index + 1}`, 12, topOf(index) + strip / 2, { weight: isFirst ? 700 : "normal" }));
    if (isFirst && detection_time_s >= from && detection_time_s <= to) {
      const x = xOf(detection_time_s);
      const after = Math.round((detection_time_s - walk.fault_s) * 1000);
      graphic.push(stroke([x, topOf(index)], [x, topOf(index) + strip], kLook.levels.bad, { width: 2 }));
      graphic.push(words(`alarm, ${after} ms after`, x + 6, topOf(index) + 8, { color: kLook.levels.bad, size: 12 }));
    }
  });
  save(file, {
    title: `Residual and threshold of the joints, before and after friction on joint ${walk.joint} goes up`,
    height: bottom + 54,
    ...spans,
    series,
    graphic,
  });
}

/** What the model does not explain of the named joint's torque over its velocity, before and after the fault. */
export function drawFriction(walk, file) {
  const joint = walk.replay.first_joint;
  const overTime = walk.errors.get(`Joint ${joint}: residual (measured minus model)`).series[0];
  const overVelocity = walk.errors.get(`Joint ${joint}: residual over velocity`).series[0];
  // Not those in which the low-pass of `compare` has both.
  const apart = 0.2;
  const points = pairsOf(overVelocity).map((point, i) => ({ point, time: overTime.x[i] }));
  const part = (holds) => points.filter(({ time }) => holds(time)).map(({ point }) => point);
  const before = part((time) => time < walk.fault_s - apart);
  const after = part((time) => time > walk.fault_s + apart);
  save(file, {
    title: `What the model does not explain on joint ${joint}, over its velocity, before and after the fault`,
    height: 340,
    grid: { left: 62, right: 22, top: 66, bottom: 48, outerBoundsMode: "none" },
    xAxis: axis({ name: `velocity of joint ${joint} [rad/s]`, nameLocation: "middle", nameGap: 30 }),
    yAxis: axis(),
    series: [pointsSeries(before, kLook.tones.model), pointsSeries(after, kLook.tones.residual)],
    graphic: [
      words(`Joint ${joint}: torque that the model does not explain`, 12, 20, { size: 15, weight: 600 }),
      words("torque [N m]", 12, 46),
      ...legend(
        [
          { name: `before ${walk.fault_s} s`, color: kLook.tones.model, kind: "points", width: 120 },
          { name: `after ${walk.fault_s} s`, color: kLook.tones.residual, kind: "points", width: 120 },
        ],
        460,
        20,
      ),
    ],
  });
}
