/** What a side of the map may be: the server's name for it, and the reader's. */
const kSides = [
  ["position", "position"],
  ["velocity", "velocity"],
  ["acceleration", "acceleration"],
  ["load", "model torque"],
  ["since_reversal", "time since reversal"],
];
/** What the reader has chosen; joint null: the one that is looked at. */
const explored = { x: { variable: "position", joint: null }, y: { variable: "velocity", joint: null }, over: "frequency" };

const explorePlaces = {};

function optionsOf(select, options, chosen) {
  for (const [value, words] of options) {
    const option = element("option", { value }, words);
    option.selected = value === chosen;
    select.append(option);
  }
  return select;
}

/** A labelled choice; `taken` hears of another value. */
function choiceOf(id, label, options, chosen, taken) {
  const select = optionsOf(element("select", { id }), options, chosen);
  select.addEventListener("change", () => taken(select.value));
  return element("span", { class: "pick" }, element("label", { for: id }, label), select);
}

function sideChoice(name, label, joints, redraw) {
  const side = explored[name];
  const row = choiceOf(`map-${name}`, label, kSides, side.variable, (value) => {
    side.variable = value;
    redraw();
  });
  if (joints.length < 2) return [row];
  const all = [["", "this joint"], ...joints.map(({ joint }) => [String(joint), `joint ${joint}`])];
  const chosen = side.joint === null ? "" : String(side.joint);
  const other = choiceOf(`map-${name}-joint`, `of, ${label}`, all, chosen, (value) => {
    side.joint = value === "" ? null : Number(value);
    redraw();
  });
  other.firstChild.className = "hidden-text";
  return [row, other];
}

/** The place of map and spectrum; filled by showExplored(). */
function exploreElement() {
  const part = (name) => {
    explorePlaces[name] = element("div", { class: "blocks" });
    explorePlaces[`${name}Choice`] = element("div", { class: "choice-row" });
    return element("div", { class: "explored" }, explorePlaces[`${name}Choice`], explorePlaces[name]);
  };
  const root = element("div", { class: "explore" }, part("map"), part("spectrum"));
  return root;
}

function showExploreChoices(joints, redraw) {
  replaceContent(explorePlaces.mapChoice, ...sideChoice("x", "Map over", joints, redraw), ...sideChoice("y", "and", joints, redraw));
  const overs = [
    ["frequency", "frequency"],
    ["order", "order: waves per turn of the joint"],
  ];
  replaceContent(
    explorePlaces.spectrumChoice,
    choiceOf("spectrum-over", "Spectrum over", overs, explored.over, (value) => {
      explored.over = value;
      redraw();
    }),
  );
}

function exploredAddresses(look, range) {
  const parts = [`joint=${look.joint}`, `recording=${look.recording}`];
  if (range) parts.push(`from=${range.from}`, `to=${range.to}`);
  const side = (name) => {
    const { variable, joint } = explored[name];
    return [`${name}=${variable}`, ...(joint === null ? [] : [`${name}_joint=${joint}`])];
  };
  return {
    map: `map?${[...parts, ...side("x"), ...side("y")].join("&")}`,
    spectrum: `spectrum?${[...parts, `over=${explored.over}`].join("&")}`,
  };
}

/** Of several that are asked for, the last one is drawn. */
let exploredAsked = 0;

/** Map and spectrum of what is looked at. */
async function drawExplored(look, range) {
  const own = ++exploredAsked;
  const addresses = Object.entries(exploredAddresses(look, range));
  const draw = async ([name, address]) => {
    const { chart } = await ask("GET", address);
    if (own === exploredAsked) showAlone(`${name}.0`, chart, explorePlaces[name]);
  };
  // Each without the other: a refusal of one is said, and the other is there.
  const ends = await Promise.allSettled(addresses.map(draw));
  const refused = ends.find(({ status }) => status === "rejected");
  if (refused) throw refused.reason;
}

/** Another robot has other joints. */
function forgetExploredJoints() {
  explored.x.joint = null;
  explored.y.joint = null;
}
