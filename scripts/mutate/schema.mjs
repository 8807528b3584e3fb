// All wrong versions of a file in one: which of them runs is told when the program starts. It is built
// once, where every version by itself would be built anew.

// The schema's text with these mutants in it, and for every line the mutant that it belongs to.
export function schemaOf(text, { tokens, regions }, mutants) {
  const byRegion = new Map();
  for (const mutant of mutants) byRegion.set(mutant.region, [...(byRegion.get(mutant.region) ?? []), mutant]);
  const out = pieces(text, tokens, regions, byRegion, 0, text.length);
  const lines = new Map();
  let line = 1;
  for (const { mutant, code } of out) {
    const last = line + code.split("\n").length - 1;
    if (mutant !== undefined) for (let at = line; at <= last; ++at) lines.set(at, mutant);
    line = last;
  }
  return { text: out.map(({ code }) => code).join(""), lines };
}

export function mutated(text, { begin, end, text: instead }) {
  return text.slice(0, begin) + instead + text.slice(end);
}

// The text from begin to end with the regions in it.
function pieces(text, tokens, regions, byRegion, begin, end) {
  const out = [];
  let at = begin;
  for (const region of regions) {
    const first = tokens[region.from].begin;
    const last = tokens[region.to - 1].end;
    out.push({ code: text.slice(at, first) });
    out.push(...choice(region, byRegion.get(region) ?? [], {
      right: () => pieces(text, tokens, region.inner, byRegion, first, last),
      wrong: (mutant) => text.slice(first, mutant.begin) + mutant.text + text.slice(mutant.end, last),
    }));
    at = last;
  }
  out.push({ code: text.slice(at, end) });
  return out;
}

function choice({ role }, mutants, { right, wrong }) {
  if (mutants.length === 0) return right();
  const isStatement = role === "statement" || role === "jump";
  const isTest = role === "condition" || role === "loop";
  const opened = isTest ? "static_cast<bool>(" : "(";
  const out = [{ code: isStatement ? "{" : "(" }];
  for (const mutant of mutants) {
    const active = `::offnominal_mutate::is_active(${mutant.number})`;
    // Of two types that do not go together the compiler speaks where the choice between them begins.
    out.push(isStatement ? { code: `if (${active}) {\n` } : { code: `${active} ? ${opened}\n`, mutant });
    out.push({ code: wrong(mutant), mutant });
    out.push({ code: isStatement ? "\n} else " : "\n) : " });
  }
  out.push({ code: isStatement ? "{" : opened }, ...right(), { code: isStatement ? "}}" : "))" });
  return out;
}
