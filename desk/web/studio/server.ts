import { checkAnswer } from "./answers";
import type { AnswerTo, Method, RouteOf, Said } from "./api";

/** Why the server did not do what was asked; `confirm`: it will where it is asked once more. */
export class Refusal extends Error {
  constructor(
    words: string,
    readonly confirm: boolean,
  ) {
    super(words);
  }
}

/** What went wrong, in words. */
export function wordsOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

/** Whether the server will do it where it is asked once more. */
export function mayConfirm(error: unknown): boolean {
  return error instanceof Refusal && error.confirm;
}

/** Every question has the same form, whatever it says. */
interface AnySaid {
  query?: Record<string, unknown>;
  path?: Record<string, unknown>;
  body?: object;
  file?: Blob;
}

/** A question that says nothing may leave that out. */
type Rest<Words> = object extends Words ? [said?: Words] : [said: Words];

/**
 * What the server answers to a question of desk/studio/api/openapi.json; addresses are relative, the token is in the
 * page's own. An answer that is not as the document says is refused: nothing of it is shown.
 */
export async function ask<M extends Method, Route extends RouteOf<M>>(
  method: M,
  route: Route,
  ...[said]: Rest<Said<M, Route>>
): Promise<AnswerTo<M, Route>> {
  const words: AnySaid = said ?? {};
  const answer = await answerTo(addressOf(route, words), optionsOf(method, words));
  return checkAnswer(method, route, answer);
}

/** "steps/3" of "/steps/{id}"; what is undefined is not said. */
export function addressOf(route: string, { query = {}, path = {} }: AnySaid): string {
  const place = route.slice(1).replace(/\{(\w+)\}/g, (_, name: string) => encodeURIComponent(String(path[name])));
  const said = Object.entries(query).filter(([, value]) => value !== undefined);
  const words = said.map(([name, value]) => `${name}=${encodeURIComponent(String(value))}`);
  return words.length === 0 ? place : `${place}?${words.join("&")}`;
}

function optionsOf(method: Method, { body, file }: AnySaid): RequestInit {
  if (file !== undefined) return { method, headers: { "Content-Type": "application/octet-stream" }, body: file };
  if (method !== "POST") return { method };
  return { method, headers: { "Content-Type": "application/json" }, body: JSON.stringify(body ?? {}) };
}

async function answerTo(address: string, options: RequestInit): Promise<unknown> {
  let answer: Response;
  try {
    answer = await fetch(`api/${address}`, options);
  } catch {
    throw new Refusal("Studio does not answer any more: start it again in the terminal.", false);
  }
  if (answer.status === 204) return null;
  const json = (await answer.json().catch(() => ({ error: `The server says ${answer.status}.` }))) as unknown;
  if (!answer.ok) throw refusalOf(json, answer.status);
  return json;
}

function refusalOf(json: unknown, status: number): Refusal {
  const { error, confirm } = (json ?? {}) as { error?: unknown; confirm?: unknown };
  return new Refusal(typeof error === "string" ? error : `The server says ${status}.`, confirm === true);
}

/** Whoever leaves the page wants nothing to go on behind it. A beacon would not say its origin everywhere. */
export function watchLeaving() {
  window.addEventListener("pagehide", () => {
    fetch("api/leave", { method: "POST", keepalive: true }).catch(() => {});
  });
}
