// What is made of Studio's API (desk/studio/api/openapi.json): types for the page's modules, and functions that tell
// whether an answer is as the document says. Nothing of it is kept in the repository.
import Ajv from "ajv";
import standaloneCode from "ajv/dist/standalone/index.js";
import { readFileSync } from "node:fs";
import { fileURLToPath, pathToFileURL } from "node:url";
import openapiTS, { astToString } from "openapi-typescript";

const kApi = fileURLToPath(new URL("../studio/api/openapi.json", import.meta.url));
const kMethods = ["get", "post", "delete"];
const kSchemas = "#/components/schemas/";

/** The text of a module of types: what each route is asked and answers. */
export async function typesText() {
  return astToString(await openapiTS(pathToFileURL(kApi), { defaultNonNullable: false }));
}

/** Of all answers their `name`, as the page asks, e.g. "GET /charts", and the name of their schema. */
function answersOf({ paths }) {
  return Object.entries(paths).flatMap(([route, operations]) =>
    kMethods.flatMap((method) => {
      const schema = operations[method]?.responses["200"]?.content?.["application/json"]?.schema;
      if (schema === undefined) return [];
      const name = `${method.toUpperCase()} ${route}`;
      if (!schema.$ref?.startsWith(kSchemas)) throw new Error(`the answer to ${name} has no schema by name`);
      return [{ name, schema: schema.$ref.slice(kSchemas.length) }];
    }),
  );
}

/**
 * The text of a module that exports `validators`, by the name of the answer. They are compiled here: the page's policy
 * lets nothing be compiled there. A schema that is used in many places is one function; the page has its own words for
 * what is wrong.
 */
export function validatorsText() {
  const api = JSON.parse(readFileSync(kApi, "utf8"));
  const code = { source: true, esm: true, optimize: 2 };
  const ajv = new Ajv({ code, strict: true, allowUnionTypes: true, inlineRefs: false, messages: false });
  for (const [name, schema] of Object.entries(api.components.schemas)) ajv.addSchema(plain(schema), name);
  const answers = answersOf(api);
  const schemas = [...new Set(answers.map(({ schema }) => schema))];
  const functions = standaloneCode(ajv, Object.fromEntries(schemas.map((name) => [name, name])));
  const entries = answers.map(({ name, schema }) => `  ${JSON.stringify(name)}: ${schema},`);
  return `${functions}\nexport const validators = {\n${entries.join("\n")}\n};\n`;
}

/** Without what is for readers, and with names of schemas that ajv knows. */
function plain(schema) {
  const withoutWords = (key, value) => (key === "description" && typeof value === "string" ? undefined : value);
  return JSON.parse(JSON.stringify(schema, withoutWords).replaceAll(`"${kSchemas}`, '"'));
}
