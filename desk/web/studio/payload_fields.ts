/** The fields of a payload, in their order: what each is called beside it, and in the API. */
export const kPayloadFields = [
  ["mass", "mass_kg", "kg"],
  ["x", "x_m", "m"],
  ["y", "y_m", "m"],
  ["z", "z_m", "m"],
] as const;

export type PayloadField = (typeof kPayloadFields)[number][1];

/** What stands in the fields. */
export type PayloadTexts = Record<PayloadField, string>;

export type PayloadNumbers = Record<PayloadField, number>;

/** Why nothing is asked of the server with these texts, and in which fields that is. */
export interface WrongFields {
  words: string;
  fields: PayloadField[];
}

function wrongWith(text: string): string | null {
  if (text === "") return "empty";
  if (Number.isFinite(Number(text))) return null;
  return `“${text}”, which is no number`;
}

/** Four numbers, or what is none of them; whether a robot can carry that is for the server to say. */
export function readPayload(texts: PayloadTexts): PayloadNumbers | WrongFields {
  const numbers: PayloadNumbers = { mass_kg: 0, x_m: 0, y_m: 0, z_m: 0 };
  const wrong: WrongFields = { words: "", fields: [] };
  const found: string[] = [];
  for (const [label, field, unit] of kPayloadFields) {
    const text = texts[field].trim();
    const why = wrongWith(text);
    if (why === null) {
      numbers[field] = Number(text);
    } else {
      found.push(`${label}: ${why}; allowed: a number in ${unit}, such as 0.8`);
      wrong.fields.push(field);
    }
  }
  if (found.length === 0) return numbers;
  wrong.words = found.join(". ");
  return wrong;
}

export function textsOf(payload: PayloadNumbers | null): PayloadTexts {
  const text = (field: PayloadField) => (payload === null ? "" : String(payload[field]));
  return { mass_kg: text("mass_kg"), x_m: text("x_m"), y_m: text("y_m"), z_m: text("z_m") };
}
