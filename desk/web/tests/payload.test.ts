import assert from "node:assert/strict";
import { test } from "node:test";
import { readPayload, textsOf } from "../studio/payload_fields";

const kTool = { mass_kg: 0.8, x_m: 0, y_m: -0.02, z_m: 0.1 };

test("APayloadIsFourNumbers", () => {
  assert.deepEqual(readPayload({ mass_kg: " 0.8", x_m: "0", y_m: "-2e-2", z_m: ".1" }), kTool);
  assert.deepEqual(readPayload(textsOf(kTool)), kTool);
});

test("OfWhatIsNoNumberNothingIsGuessedAndEveryFieldIsNamed", () => {
  const wrong = readPayload({ mass_kg: "0,8", x_m: "", y_m: "0", z_m: "Infinity" });
  assert.ok("words" in wrong);
  assert.deepEqual(wrong.fields, ["mass_kg", "x_m", "z_m"]);
  assert.match(wrong.words, /^mass: “0,8”, which is no number; allowed: a number in kg, such as 0\.8\. x: empty/);
  const empty = readPayload(textsOf(null));
  assert.ok("words" in empty);
  assert.equal(empty.fields.length, 4);
});
