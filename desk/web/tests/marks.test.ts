import assert from "node:assert/strict";
import { test } from "node:test";
import { placeEventLabels } from "../report/marks";

test("LabelsApartStandInOneRow", () => {
  const { places, rows } = placeEventLabels([0, 100, 200], [50, 50, 50], 400);
  assert.equal(rows, 1);
  assert.deepEqual(places.map(({ row }) => row), [0, 0, 0]);
});

test("ALabelThatWouldCoverAnotherStandsHigher", () => {
  const { places, rows } = placeEventLabels([0, 30], [50, 50], 400);
  assert.equal(rows, 2);
  assert.equal(places[1]?.row, 0);
  assert.equal(places[0]?.row, 1);
});

test("ALabelThatWouldLeaveThePlotTurnsToTheLeft", () => {
  const { places } = placeEventLabels([10, 380], [50, 50], 400);
  assert.deepEqual(places.map(({ flipped }) => flipped), [false, true]);
});

test("NoTwoLabelsOfARowTouch", () => {
  const seed = Number(process.env.OFFNOMINAL_SEED ?? Date.now() % 100000);
  console.log(`seed ${seed}`);
  let state = seed;
  const random = () => (state = (state * 1103515245 + 12345) % 2147483648) / 2147483648;
  for (let run = 0; run < 200; ++run) {
    const positions = Array.from({ length: 12 }, () => 400 * random());
    const widths = positions.map(() => 20 + 60 * random());
    const { places, rows } = placeEventLabels(positions, widths, 416);
    const ends = places.map(({ row, flipped }, at) => {
      const [x, width] = [positions[at] ?? 0, widths[at] ?? 0];
      return { row, from: flipped ? x - width : x, to: flipped ? x : x + width };
    });
    for (const [at, one] of ends.entries()) {
      assert.ok(one.row < rows);
      for (const other of ends.slice(at + 1)) {
        if (one.row === other.row) assert.ok(one.to <= other.from || other.to <= one.from, `seed ${seed}, run ${run}`);
      }
    }
  }
});
