import { noteWith } from "./parts";

/** Why the server, or the page, did not do what was asked; shown beside where it was asked. */
export interface Refused {
  words: string;
  /** Whoever listens has heard of it: the page around it is made anew, and would say it again. */
  told: boolean;
}

export function refusedNote(id: string, refused: Refused) {
  const note = noteWith("bad", refused.words);
  note.id = id;
  if (!refused.told) note.setAttribute("role", "alert");
  refused.told = true;
  return note;
}
