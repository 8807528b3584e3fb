/**
 * Pictures of what effects do, by what they are of: {host, place, figure}. They outlive the cards, which are made anew
 * with every answer.
 */
const evidence = new Map();
let evidenceCount = 0;

/**
 * What the error looks like without an effect, and the effect's torque over it: asked for once.
 * @param {string} key which effect of which model
 * @param {string} address where the server has its picture
 */
function evidenceElement(key, address) {
  const known = evidence.get(key);
  if (known) return known.host;
  const host = element("div", { class: "evidence" }, element("p", { class: "remark" }, "Drawing its picture …"));
  const picture = { host, place: `evidence.${++evidenceCount}`, figure: null };
  evidence.set(key, picture);
  evidenceQueue = evidenceQueue.then(() => drawEvidence(picture, address));
  return host;
}

/** One after the other: each takes the server some time. */
let evidenceQueue = Promise.resolve();

async function drawEvidence(picture, address) {
  if (!picture.host.isConnected) return forgetUnseen();
  try {
    const { chart } = await ask("GET", address);
    if (!picture.host.isConnected) return forgetUnseen();
    picture.host.replaceChildren();
    picture.figure = makeFigure(chart, picture.place, picture.host);
    shareExtents();
    drawSoon([picture.figure]);
  } catch (error) {
    picture.host.replaceChildren(element("p", { class: "remark" }, error.message));
  }
}

/** Pictures of cards that are gone. */
function forgetUnseen() {
  for (const [key, { host, place, figure }] of evidence) {
    if (host.isConnected) continue;
    evidence.delete(key);
    drawn.delete(place);
    if (figure === null) continue;
    stale.delete(figure);
    figure.chart?.dispose();
    figures.splice(figures.indexOf(figure), 1);
  }
}

/** The picture of a step, unfolded by the reader: it follows the model. */
function stepEvidence(step, revision) {
  const id = `evidence-of-step-${step.id}`;
  const details = foldWith(id, "What the error looks like without it");
  const key = `step ${step.id} ${revision}`;
  const fill = () => details.append(evidenceElement(key, `evidence?step=${step.id}`));
  if (evidence.has(key)) fill();
  details.addEventListener("toggle", () => {
    if (details.open && !details.querySelector(".evidence")) fill();
  });
  return details;
}
