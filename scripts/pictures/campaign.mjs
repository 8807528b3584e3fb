// Pictures of a campaign's results.
import { axis, kLook, kWidth, legend, lineSeries, save, words } from "./drawing.mjs";
import { said } from "./said.mjs";

/** Rows of an SQLite file, by its own program (Debian: sqlite3). */
function rowsOf(results, query) {
  return JSON.parse(said("sqlite3", ["-readonly", "-json", results, query]) || "[]");
}

// Those behind are wider: where all see the same, all are seen.
const kDetectors = [
  { name: "momentum_observer 30", words: "momentum observer, 30 1/s", color: kLook.cycle[1], width: 3.8 },
  { name: "torque 10", words: "one filter, 10 1/s", color: kLook.cycle[0], width: 2.4 },
  { name: "torque 10 and 30", words: "two filters, 10 and 30 1/s", color: kLook.cycle[2], width: 1.4 },
];

const kDelayed = [
  { words: "payload 0.5 kg", where: "kind = 'payload' AND size = 0.5" },
  { words: "friction +1 N m", where: "kind = 'friction' AND size = 1" },
  { words: "friction +2 N m", where: "kind = 'friction' AND size = 2" },
  { words: "torque lost 20 %", where: "kind = 'torque_lost' AND size = 0.2" },
  { words: "offset 1 N m", where: "kind = 'offset' AND size = 1" },
  { words: "push 15 N", where: "kind = 'push' AND size = 15" },
  { words: "encoder jump 10 mrad", where: "kind = 'encoder_jump' AND size = 0.01" },
  { words: "encoder stuck", where: "kind = 'encoder_stuck'" },
  { words: "joint locked", where: "kind = 'locked'" },
];

const kTimes = { 0.001: "1 ms", 0.01: "10 ms", 0.1: "0.1 s", 1: "1 s" };

/** Of each kind of fault, which share of its runs each detector had seen after which time. */
export function drawDelays(results, file) {
  const known = new Set(rowsOf(results, "SELECT name FROM detector").map(({ name }) => name));
  const detectors = kDetectors.filter(({ name }) => known.has(name));
  const kinds = kDelayed
    .map((kind) => {
      const query = `SELECT detector, detected, delay_s FROM result WHERE ${kind.where} ORDER BY delay_s`;
      return { ...kind, rows: rowsOf(results, query) };
    })
    .filter(({ rows }) => rows.length > 0);
  const [columns, left, right, top, height, gapX, gapY] = [3, 54, 22, 84, 128, 26, 44];
  const width = (kWidth - left - right - (columns - 1) * gapX) / columns;
  const [soonest, latest] = [0.001, 4];
  const option = { grid: [], xAxis: [], yAxis: [], series: [] };
  const entries = [...detectors].reverse().map(({ words: name, color, width: thick }) => {
    return { name, color, kind: "line", width: 212, thick };
  });
  const graphic = [
    words("Share of the runs in which the fault was seen within that time", 12, 20, { size: 15, weight: 600 }),
    ...legend(entries, 14, 46),
  ];
  const rows = Math.ceil(kinds.length / columns);
  kinds.forEach(({ words: name, rows: runs }, index) => {
    const [column, row] = [index % columns, Math.floor(index / columns)];
    const [x, y] = [left + column * (width + gapX), top + row * (height + gapY)];
    const lowest = index + columns >= kinds.length;
    const count = runs.filter(({ detector }) => detector === detectors[0].name).length;
    option.grid.push({ left: x, top: y, width, height, outerBoundsMode: "none" });
    option.xAxis.push(
      axis({
        type: "log",
        gridIndex: index,
        min: soonest,
        max: latest,
        axisLabel: { color: kLook.soft, fontSize: 12, formatter: (value) => kTimes[value] ?? "" },
      }),
    );
    option.yAxis.push(
      axis({
        gridIndex: index,
        min: 0,
        max: 100,
        interval: 50,
        axisLabel: { show: column === 0, color: kLook.soft, fontSize: 12, formatter: "{value} %" },
      }),
    );
    graphic.push(words(`${name} (${count} runs)`, x, y - 11, { size: 12 }));
    for (const { name: detector, color, width: wide } of detectors) {
      const own = runs.filter((run) => run.detector === detector);
      const delays = own.filter((run) => run.detected).map((run) => Math.max(run.delay_s, soonest));
      const share = (seen) => (100 * seen) / own.length;
      const points = [[soonest, 0], ...delays.map((delay, i) => [delay, share(i + 1)]), [latest, share(delays.length)]];
      option.series.push(lineSeries(points, color, { xAxisIndex: index, yAxisIndex: index, step: "end", width: wide }));
    }
  });
  save(file, {
    title: "Share of the runs in which a fault was seen, over the time since it began, per kind of fault and detector",
    height: top + rows * (height + gapY) - 8,
    ...option,
    graphic,
  });
}

const kNames = {
  payload: "payload",
  friction: "friction",
  lost_torque: "lost torque",
  offset: "offset",
  contact: "contact",
  encoder_jump: "encoder jump",
  encoder_stuck: "encoder stuck",
  locked_joint: "locked joint",
  unknown: "unknown",
};

/** Kinds of faults in campaigns have other names than answers. */
const kNamedFor = { torque_lost: "lost_torque", push: "contact", locked: "locked_joint" };

/** What the faults that the first detector saw were called: rows the faults, columns the answers. */
export function drawNames(results, detector, file) {
  const counts = rowsOf(
    results,
    `SELECT kind, named, count(*) AS runs FROM result WHERE detector = '${detector}' AND detected GROUP BY kind, named`,
  );
  const names = Object.keys(kNames);
  const kinds = names.filter((name) => name !== "unknown");
  const [left, top, cell, height] = [150, 104, 61, 30];
  const graphic = [
    words("What the faults that were seen were called", 12, 20, { size: 15, weight: 600 }),
    words("Runs. A row: a kind of fault, and how many of it were seen. A column: the answer. Framed: right.", 12, 44, {
      size: 12,
      color: kLook.soft,
    }),
  ];
  names.forEach((name, column) => {
    const text = kNames[name].replace(" ", "\n");
    graphic.push(words(text, left + (column + 0.5) * cell, top - 24, { align: "center", size: 12 }));
  });
  kinds.forEach((kind, row) => {
    const own = counts.filter((count) => (kNamedFor[count.kind] ?? count.kind) === kind);
    const all = own.reduce((sum, { runs }) => sum + runs, 0);
    const y = top + row * height;
    graphic.push(words(`${kNames[kind]}, ${all}`, left - 10, y + height / 2, { align: "right" }));
    names.forEach((name, column) => {
      const runs = own.filter(({ named }) => (named || "unknown") === name).reduce((sum, each) => sum + each.runs, 0);
      const share = all > 0 ? runs / all : 0;
      const right = name === kind;
      const x = left + column * cell;
      const shape = { x: x + 1.5, y: y + 1.5, width: cell - 3, height: height - 3 };
      const fill = right ? kLook.tones.model : kLook.tones.residual;
      const opacity = runs > 0 ? 0.12 + 0.6 * share : 0.03;
      graphic.push({ type: "rect", silent: true, shape, style: { fill, opacity } });
      const frame = { fill: "none", stroke: fill, lineWidth: 1.2 };
      if (right) graphic.push({ type: "rect", silent: true, shape, style: frame });
      if (runs > 0) {
        const weight = right ? 700 : "normal";
        graphic.push(words(String(runs), x + cell / 2, y + height / 2, { align: "center", weight }));
      }
    });
  });
  save(file, {
    title: `What the faults that the monitor saw were called, detector ${detector}`,
    height: top + kinds.length * height + 16,
    graphic,
  });
}
