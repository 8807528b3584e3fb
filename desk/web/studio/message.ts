import { noteWith, replaceContent } from "./parts";
import { placeOf } from "./places";
import { wordsOf } from "./server";

/** What is said above the charts; empty: nothing any more. */
export function complain(words: string) {
  const place = placeOf("message");
  replaceContent(place, words === "" ? "" : noteWith("bad", words));
  if (words !== "") place.scrollIntoView({ block: "nearest" });
}

/** What nothing waits for says by itself that it failed. */
export function complainOf(error: unknown) {
  complain(wordsOf(error));
}
