import type { AnswerTo, Method, RouteOf } from "./api";

/** The answer to a question. */
export function checkAnswer<M extends Method, Route extends RouteOf<M>>(_method: M, _route: Route, answer: unknown) {
  return answer as AnswerTo<M, Route>;
}
