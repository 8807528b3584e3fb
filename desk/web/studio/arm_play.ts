import { byId } from "../report/element";
import { itemAt } from "../report/lists";
import { arm, armData } from "./arm_state";
import { holdPointer, setCursor } from "./cursor";

export function togglePlay() {
  if (arm.playing !== null) stopPlay();
  else startPlay();
}

/** In the time of the recording; where motion is to be reduced in steps of half a second. */
function startPlay() {
  const { t_s } = armData();
  const last = itemAt(t_s, t_s.length - 1);
  const from = itemAt(t_s, arm.instant >= t_s.length - 1 ? 0 : arm.instant);
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  const begun = performance.now();
  holdPointer(true);
  byId("arm-play").textContent = "Pause";
  const tick = (now: number) => {
    const passed = Math.max(0, now - begun) / 1000;
    const time = from + (still ? Math.floor(2 * passed) / 2 : passed);
    setCursor("at", Math.min(time, last));
    if (time >= last) stopPlay();
    else arm.playing = requestAnimationFrame(tick);
  };
  arm.playing = requestAnimationFrame(tick);
}

export function stopPlay() {
  if (arm.playing === null) return;
  cancelAnimationFrame(arm.playing);
  arm.playing = null;
  holdPointer(false);
  byId("arm-play").textContent = "Play";
}
