import { element } from "../report/element";
import type { LoadUrdf } from "./api";
import { choiceOf, type Choice } from "./choices";
import { jointsWords } from "./files";
import { load, loadChange } from "./load";
import { button } from "./parts";
import { refusedNote, type Refused } from "./refusals";
import { ask, wordsOf } from "./server";

/** What somebody has chosen and the server has not taken. */
const draft: { urdf: LoadUrdf | null; chain: number; refused: Refused | null } = { urdf: null, chain: 1, refused: null };

/** Of another file nothing is chosen yet. */
function beginWith(urdf: LoadUrdf) {
  const isSame = draft.urdf !== null && JSON.stringify(draft.urdf.chains) === JSON.stringify(urdf.chains) && draft.urdf.file === urdf.file;
  draft.urdf = urdf;
  if (isSame) return;
  draft.chain = urdf.chosen ?? 1;
  draft.refused = null;
}

function take() {
  return loadChange(async () => {
    try {
      load.state = await ask("POST", "/load/chain", { body: { chain: draft.chain } });
      draft.refused = null;
    } catch (error) {
      draft.refused = { words: wordsOf(error), told: false };
    }
  });
}

/** "world to hand, 3 joints" */
export function chainWords({ base, tip, joints }: LoadUrdf["chains"][number]): string {
  return `${base} to ${tip}, ${jointsWords(joints)}`;
}

/** Which chain of a URDF is the robot: chosen, taken, and another one taken in its place. */
export function chainElement(urdf: LoadUrdf) {
  beginWith(urdf);
  const choices = urdf.chains.map((chain, at): Choice => [String(at + 1), chainWords(chain)]);
  const pick = choiceOf("chain", "Chain, from base to tip", choices, String(draft.chain), (value) => {
    draft.chain = Number(value);
    draft.refused = null;
  });
  const root = element("div", { class: "chain" }, element("div", { class: "choice-row" }, pick, button("take-chain", "Take this chain", take)));
  if (draft.refused !== null) {
    pick.querySelector("select")?.setAttribute("aria-describedby", "chain-wrong");
    root.append(refusedNote("chain-wrong", draft.refused));
  }
  return root;
}
