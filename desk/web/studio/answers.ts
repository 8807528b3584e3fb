import { validators, type Mismatch } from "#validators";
import type { AnswerTo, Method, RouteOf } from "./api";

/** The answer to a question, once it is known to be what desk/studio/api/openapi.json says. */
export function checkAnswer<M extends Method, Route extends RouteOf<M>>(
  method: M,
  route: Route,
  answer: unknown,
): AnswerTo<M, Route> {
  const name = `${method} ${route}`;
  const isFine = validators[name];
  if (isFine !== undefined && !isFine(answer)) throw new Error(mismatchWords(name, isFine.errors ?? []));
  return answer as AnswerTo<M, Route>;
}

/** Which answer is wrong, where and how. */
function mismatchWords(name: string, mismatches: Mismatch[]): string {
  const [first, ...others] = mismatches;
  if (first === undefined) return `The answer to ${name} is not what this page knows.`;
  // Of several forms that an answer may have, the one that it comes nearest to is meant.
  const worst = others.reduce((a, b) => (depthOf(b) > depthOf(a) ? b : a), first);
  const place = worst.instancePath === "" ? "the whole of it" : worst.instancePath;
  return (
    `The answer to ${name} is not what this page knows: ${place} ${howWords(worst)}. ` +
    "Nothing of it is shown; load the page anew where Studio was started again."
  );
}

function depthOf({ instancePath }: Mismatch): number {
  return instancePath.split("/").length;
}

function howWords({ keyword, params }: Mismatch): string {
  if (keyword === "required") return `lacks "${params.missingProperty}"`;
  if (keyword === "additionalProperties") return `has "${params.additionalProperty}", which is unknown`;
  if (keyword === "type") return `is not of the type ${[params.type].flat().join(" or ")}`;
  if (keyword === "enum" || keyword === "const") return "has a value that is unknown";
  if (keyword === "minItems" || keyword === "maxItems") return "has another number of entries";
  return "is beyond its limits";
}
