import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { addressOf, ask, mayConfirm, Refusal, wordsOf } from "../studio/server";

const real = globalThis.fetch;
afterEach(() => {
  globalThis.fetch = real;
});

interface Asked {
  address: string;
  options: RequestInit;
}

/** Whatever is asked is answered so; gives what was asked. */
function answer(status: number, body: unknown): Asked[] {
  const asked: Asked[] = [];
  globalThis.fetch = (address, options = {}) => {
    asked.push({ address: String(address), options });
    const text = typeof body === "string" ? body : JSON.stringify(body);
    return Promise.resolve(new Response(status === 204 ? null : text, { status }));
  };
  return asked;
}

test("AnAddressNamesWhatIsSaidAndNoMore", () => {
  assert.equal(addressOf("/steps/{id}", { path: { id: 3 } }), "steps/3");
  assert.equal(addressOf("/map", { query: { x: "velocity", x_joint: undefined, joint: 2 } }), "map?x=velocity&joint=2");
  assert.equal(addressOf("/load/files", { query: { name: "a&b=c.csv" } }), "load/files?name=a%26b%3Dc.csv");
});

test("AQuestionWithoutWordsPostsAnEmptyObject", async () => {
  const asked = answer(200, {});
  await ask("POST", "/live/again");
  assert.equal(asked[0]?.address, "api/live/again");
  assert.equal(asked[0]?.options.body, "{}");
});

test("AFileIsHandedOverAsItIs", async () => {
  const asked = answer(422, { error: "not a recording", confirm: false });
  const file = new Blob(["t,q\n"]);
  await assert.rejects(ask("POST", "/load/files", { query: { name: "a.csv" }, file }), /not a recording/);
  assert.equal(asked[0]?.options.body, file);
});

test("ARefusalSaysWhyAndWhetherItMayBeAskedOnceMore", async () => {
  answer(409, { error: "steps would be lost", confirm: true });
  const error: unknown = await ask("POST", "/load/session", { body: { replace: false } }).catch((each: unknown) => each);
  assert.ok(error instanceof Refusal);
  assert.equal(wordsOf(error), "steps would be lost");
  assert.ok(mayConfirm(error));
});

test("AnAnswerThatIsNoJsonIsToldByItsNumber", async () => {
  answer(500, "<html>");
  await assert.rejects(ask("GET", "/state"), /The server says 500\./);
});

test("AServerThatIsGoneIsSaid", async () => {
  globalThis.fetch = () => Promise.reject(new TypeError("connection refused"));
  await assert.rejects(ask("GET", "/state"), /start it again in the terminal/);
});
