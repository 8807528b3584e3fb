import { start } from "./studio";

void start();

// What the tests of the page look at and take hold of.
export { arm } from "./arm_state";
export { showTime, showWhole, timeFigures, zoomRange } from "./charts";
export { live } from "./live_state";
export { load } from "./load";
export { mapView } from "./load_map";
export { results } from "./results";
export { session, state } from "./session";
