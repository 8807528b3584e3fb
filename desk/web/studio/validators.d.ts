/** Made by api.mjs of desk/studio/api/openapi.json. */
declare module "#validators" {
  /** Where an answer is not as the document says, and how. */
  export interface Mismatch {
    instancePath: string;
    keyword: string;
    params: { missingProperty?: string; additionalProperty?: string; type?: string | string[] };
  }

  interface Validator {
    (answer: unknown): boolean;
    errors?: Mismatch[] | null;
  }

  /** Of every answer, e.g. "GET /charts". */
  export const validators: Partial<Record<string, Validator>>;
}
