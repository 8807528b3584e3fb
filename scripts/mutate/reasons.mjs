// Why a wrong version that no test catches is none: blocks with a blank line between them,
//
//   path/of/the/file.hpp
//   - the line as it is
//   + the line with the error in it
//   Why nobody can tell the one from the other.
//
// Lines that begin with # are comments.
import { Refused } from "./refused.mjs";

export function reasonsOf(text, name) {
  const blocks = text.replace(/^#.*\n/gm, "").split(/\n\s*\n/).map((block) => block.trim());
  return blocks.filter((block) => block !== "").map((block) => {
    const [file, before, after, ...why] = block.split("\n").map((line) => line.trim());
    if (!before?.startsWith("- ") || !(after === "+" || after?.startsWith("+ ")) || why.join("") === "") {
      const allowed = "a file, - a line, + the line with its error, a reason";
      throw new Refused(`${name}: found "${block.replaceAll("\n", "; ")}", allowed: ${allowed}`);
    }
    return { file, before: before.slice(2), after: after.slice(2), why: why.join(" "), used: 0 };
  });
}

export function reasonFor(reasons, file, mutant) {
  return reasons.find((reason) =>
    reason.file === file && reason.before === mutant.before && reason.after === mutant.after);
}
