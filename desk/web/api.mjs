// What is made of Studio's API (desk/studio/api/openapi.json): types for the page's modules. They are not kept in the
// repository.
import { fileURLToPath, pathToFileURL } from "node:url";
import openapiTS, { astToString } from "openapi-typescript";

const kApi = fileURLToPath(new URL("../studio/api/openapi.json", import.meta.url));

/** The text of a module of types: what each route is asked and answers. */
export async function typesText() {
  return astToString(await openapiTS(pathToFileURL(kApi), { defaultNonNullable: false }));
}
