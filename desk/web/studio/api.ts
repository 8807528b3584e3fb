import type { components, paths } from "#api";

/**
 * Studio's API as TypeScript knows it: made of desk/studio/api/openapi.json, which says what each of these means.
 * The names that the page uses most.
 */

type Schemas = components["schemas"];

export type State = Schemas["State"];
export type Joint = Schemas["Joint"];
export type Errors = Schemas["Errors"];
export type Effect = Schemas["EffectChoice"];
export type Step = Schemas["Step"];
export type Parameter = Schemas["Parameter"];
export type Draggable = Schemas["Draggable"];
export type Explanation = Schemas["Explanation"];
export type FoundAnswer = Schemas["Answer"];
export type JointAnswer = Schemas["JointAnswer"];
export type FindingCard = Schemas["Card"];
export type EffectAt = Schemas["EffectAt"];
export type Arm = Schemas["Arm"];
export type ArmJoint = Schemas["ArmJoint"];
export type LoadState = Schemas["LoadState"];
export type LoadRecording = Schemas["LoadRecording"];
export type LoadRobot = Schemas["LoadRobot"];
export type LoadUrdf = Schemas["LoadUrdf"];
export type LoadJoint = Schemas["LoadJoint"];
export type WrittenAtRest = Schemas["WrittenAtRest"];
export type SignalMap = Schemas["SignalMap"];
export type Signal = Schemas["Signal"];
export type SignalEdit = Schemas["SignalEdit"];
export type Side = Schemas["Side"];
export type Preview = Schemas["Preview"];
export type PreviewSignal = Schemas["PreviewSignal"];
export type Findings = Schemas["Findings"];
export type DataFault = Schemas["DataFault"];
export type Results = Schemas["Results"];
export type Filter = Schemas["Filter"];
export type Figures = Schemas["Figures"];
export type Runs = Schemas["Runs"];
export type Run = Schemas["Run"];
export type Watched = Schemas["Watched"];
export type LiveAnswer = Schemas["LiveAnswer"];
export type LiveSetup = Schemas["LiveSetup"];
export type Moment = Schemas["Moment"];
export type Detection = Schemas["Detection"];
export type LiveSteps = Schemas["LiveSteps"];

export type Method = "GET" | "POST" | "DELETE";

type Operation<M extends Method, Route extends keyof paths> = paths[Route][Lowercase<M>];

/** The routes that take this method. */
export type RouteOf<M extends Method> = {
  [Route in keyof paths]: Operation<M, Route> extends { responses: unknown } ? Route : never;
}[keyof paths];

/** What the server answers where it does what was asked. */
export type AnswerTo<M extends Method, Route extends RouteOf<M>> =
  Operation<M, Route> extends { responses: { 200: { content: { "application/json": infer Answer } } } } ? Answer : null;

type QueryOf<Op> = Op extends { parameters: { query: infer Query } }
  ? { query: Query }
  : Op extends { parameters: { query?: infer Query } }
    ? { query?: Query }
    : object;
type PathOf<Op> = Op extends { parameters: { path: infer Path } } ? { path: Path } : object;
type BodyOf<Op> = Op extends { requestBody: { content: { "application/json": infer Body } } }
  ? { body: Body }
  : Op extends { requestBody: { content: { "application/octet-stream": unknown } } }
    ? { file: Blob }
    : object;

/** What a question says: in its address and behind it. */
export type Said<M extends Method, Route extends RouteOf<M>> = QueryOf<Operation<M, Route>> &
  PathOf<Operation<M, Route>> &
  BodyOf<Operation<M, Route>>;

/** What a question says in its address behind the question mark. */
export type QueryTo<M extends Method, Route extends RouteOf<M>> = NonNullable<
  QueryOf<Operation<M, Route>> extends { query?: infer Query } ? Query : never
>;
