/** What the table of A and B shows of every joint: how it is called, where it is in the answer, its unit. */
const kQuantities = {
  position: { name: "Position", unit: ({ unit }) => unit },
  measured: { name: "Measured torque", unit: ({ torque_unit }) => torque_unit },
  model: { name: "Model torque", unit: ({ torque_unit }) => torque_unit },
  error: { name: "Error", unit: ({ torque_unit }) => torque_unit },
  percent: { name: "Error as a share of the torque", unit: () => "%" },
};

/** The answers of the server for A and for B; null: none. */
const marks = { a: null, b: null };

/** One unit where all joints have it, or none in the column's head. */
function commonUnit(joints, quantity) {
  const units = new Set(joints.map(kQuantities[quantity].unit));
  return units.size === 1 ? [...units][0] : "";
}

function jointTitle(joint, units) {
  return `${joint.joint}. ${joint.name}${units === "" ? "" : ` [${units}]`}`;
}

/** Fills the table in its place: where only numbers differ, only they are written. */
function fillTable(host, table) {
  const lines = [...host.querySelectorAll("tbody tr")];
  const shape = JSON.stringify([table.caption, table.columns, table.rows.map(([name]) => name)]);
  if (host.dataset.shape !== shape) {
    host.dataset.shape = shape;
    replaceContent(host, scrollingTable(table));
    watchTables(host);
    return;
  }
  table.rows.forEach((row, index) =>
    row.forEach((value, at) => {
      const text = at === 0 ? value : formatNumber(value, table.columns[at].format);
      const cell = lines[index].children[at];
      if (cell.textContent !== text) cell.textContent = text;
    }),
  );
}

/** Of the instant that is shown: what the picture shows, in numbers. */
function cursorTable(data, instant) {
  const { joints } = data;
  const mixed = commonUnit(joints, "position") === "";
  const columns = [
    { name: "Joint", unit: "", format: "" },
    { name: "Position", unit: commonUnit(joints, "position"), format: ".4g" },
    { name: "Error", unit: commonUnit(joints, "error"), format: ".3g" },
    { name: "Share", unit: "%", format: ".1f" },
  ];
  if (data.over_bound !== null) columns.push({ name: "Of bound", unit: "", format: ".2f" });
  const rows = joints.map((joint, index) => {
    const row = [jointTitle(joint, mixed ? `${joint.unit}, ${joint.torque_unit}` : "")];
    for (const what of ["position", "error", "percent"]) row.push(data[what][index][instant]);
    if (data.over_bound !== null) row.push(data.over_bound[index][instant]);
    return row;
  });
  return { caption: "At the cursor; share: of the rms of the joint's torque", columns, rows };
}

/** A, B and what lies between them, of one quantity. */
function markTable(data, instant, quantity) {
  const unit = commonUnit(data.joints, quantity);
  const heads = [
    ["Cursor", data.t_s[instant]],
    ["A", marks.a?.t_s[0] ?? null],
    ["B", marks.b?.t_s[0] ?? null],
  ];
  const columns = [{ name: "Joint", unit: "", format: "" }];
  for (const [name] of [...heads, ["B \u2212 A"]]) columns.push({ name, unit, format: ".5g" });
  const difference = (a, b) => (a === null || b === null ? null : b - a);
  const line = (name, at, a, b) => [name, at, a, b, difference(a, b)];
  const rows = data.joints.map((joint, index) =>
    line(
      jointTitle(joint, unit === "" ? kQuantities[quantity].unit(joint) : ""),
      data[quantity][index][instant],
      marks.a?.[quantity][index][0] ?? null,
      marks.b?.[quantity][index][0] ?? null,
    ),
  );
  const times = heads.map(([, time]) => time);
  rows.unshift(line("Time [s]", ...times));
  return { caption: `${kQuantities[quantity].name} at A and B`, columns, rows };
}

/** What the arm does at one time: that sample alone. */
async function askMark(name, recording) {
  const time = cursor[name];
  if (time === null) {
    marks[name] = null;
    return;
  }
  const half = 1e-6 * Math.max(1, Math.abs(time));
  const answer = await ask("GET", `arm?recording=${recording}&instants=2&from=${time - half}&to=${time + half}`);
  if (cursor[name] === time) marks[name] = answer;
}
