// Wrong versions of a C++ file, each with one small error in it.
import { regionsOf } from "./regions.mjs";

const swapped = new Map(Object.entries({
  "<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
  "&&": ["||"], "||": ["&&"], "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["*"], "&": ["|"], "|": ["&"],
  "^": ["&"], "<<": [">>"], ">>": ["<<"],
}));
const exchanged = new Map(Object.entries({
  "+=": ["-="], "-=": ["+="], "*=": ["/="], "/=": ["*="], "&=": ["|="], "|=": ["&="], "++": ["--"], "--": ["++"],
  true: ["false"], false: ["true"], min: ["max"], max: ["min"], all_of: ["any_of", "none_of"],
  any_of: ["all_of", "none_of"], none_of: ["any_of"], isfinite: ["isnan"],
}));
// Calls that leave their argument as it may be.
const guards = new Set(["fabs", "abs", "sqrt", "floor", "ceil", "round"]);

// [{line, before, after, begin, end, text, region}]: `text` instead of what is from begin to end.
// before, after: the lines concerned without blanks at their ends, one line each.
export function mutantsOf(text) {
  const { tokens, regions } = regionsOf(text);
  const maker = new Maker(text, tokens);
  maker.visit(regions);
  const mutants = maker.mutants.sort((a, b) => a.begin - b.begin || a.end - b.end);
  return { regions, tokens, mutants };
}

class Maker {
  constructor(text, tokens) {
    this.text = text;
    this.tokens = tokens;
    this.mutants = [];
    this.siblings = siblingsOf(tokens);
    this.lineBegins = [0, ...Array.from(text.matchAll(/\n/g), ({ index }) => index + 1)];
  }

  visit(regions) {
    for (const region of regions) {
      this.seen = new Set();
      this.region = region;
      this.whole(region);
      for (const i of region.own) this.token(i, region);
      this.visit(region.inner);
    }
  }

  lineOf(offset) {
    let [low, high] = [0, this.lineBegins.length];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.lineBegins[middle] <= offset) low = middle;
      else high = middle;
    }
    return high;
  }

  add(from, to, text) {
    const begin = this.tokens[from].begin;
    const end = this.tokens[to].end;
    const lineBegin = this.text.lastIndexOf("\n", begin) + 1;
    const lineEnd = (this.text.indexOf("\n", end) + this.text.length + 1) % (this.text.length + 1);
    const oneLine = (lines) => lines.replace(/\s+/g, " ").trim();
    const before = oneLine(this.text.slice(lineBegin, lineEnd));
    const after = oneLine(this.text.slice(lineBegin, begin) + text + this.text.slice(end, lineEnd));
    const key = `${begin} ${after}`;
    if (before === after || this.seen.has(key)) return;
    this.seen.add(key);
    this.mutants.push({ line: this.lineOf(begin), before, after, begin, end, text, region: this.region });
  }

  // The statement, the condition or what is returned as a whole.
  whole({ role, from, to, returnsBool }) {
    const last = to - 1;
    const is = this.text.slice(this.tokens[from].begin, this.tokens[last].end);
    if (role === "statement") this.add(from, last, ";");
    // What compares is negated by another comparison, a loop without a turn by one as well.
    const isPlain = !this.tokens.slice(from, to).some(({ text, before }) => before && /^([<>=!]=|[<>!])$/.test(text));
    const isNegated = this.tokens[from].text === "!";
    if (role === "condition" || (role === "loop" && isPlain)) this.add(from, last, "false");
    if (role === "condition") this.add(from, last, "true");
    if (role === "condition" && isPlain && !isNegated) this.add(from, last, `!(${is})`);
    if (role !== "jump" || !/^return (?!(true|false);$)/.test(is)) return;
    if (returnsBool) {
      this.add(from, last, "return true;");
      this.add(from, last, "return false;");
    } else if (!/^return (\w+::)*k[A-Z]\w*;$/.test(is) && !/^return \{\s*\};$/.test(is)) {
      this.add(from, last, "return {};");
    }
  }

  token(i, region) {
    const { text, kind, before, after } = this.tokens[i];
    const replace = (others = []) => others.forEach((other) => this.add(i, i, other));
    if (kind === "number") replace(this.otherNumbers(text));
    if (kind === "word") {
      if (/^k[A-Z]/.test(text)) replace(this.siblings(i));
      this.call(i, region);
    }
    if (swapped.has(text) && before && after) replace(swapped.get(text));
    if (exchanged.has(text) && (kind === "punctuator" || !this.isMember(i))) replace(exchanged.get(text));
    if ((text === "!" || text === "-") && !after && !this.endsValue(i - 1)) this.add(i, i, "");
    if (text === "?") this.choice(i, region);
  }

  isMember(i) {
    return /^(\.|->)$/.test(this.tokens[i - 1]?.text);
  }
  endsValue(i) {
    const token = this.tokens[i];
    return token !== undefined && (token.kind === "number" || /^[)\]]$/.test(token.text) ||
      (token.kind === "word" && token.text !== "return"));
  }

  otherNumbers(text) {
    const whole = text.match(/^(\d[\d']*)([uUlLzZ]*)$/);
    if (whole !== null) {
      const value = BigInt(whole[1].replaceAll("'", ""));
      return (value > 0n ? [value + 1n, value - 1n] : [value + 1n]).map((other) => other + whole[2]);
    }
    return /^[\d.]+([eE]|[fFlL]?$)/.test(text) ? [`(${text} * 2)`, `(-${text})`] : [];
  }

  // Bounds left out, signs kept.
  call(i, region) {
    const name = this.tokens[i].text;
    if (this.tokens[i + 1]?.text !== "(" || this.isMember(i)) return;
    const values = this.argumentsAt(i + 1);
    let first = i;
    while (first > region.from && this.tokens[first - 1].text === "::") first -= 2;
    const prefix = this.tokens.slice(first, i).map((token) => token.text).join("");
    if (name === "clamp" && values.texts.length === 3) {
      const [value, low, high] = values.texts;
      this.add(first, values.close, `${prefix}min(${value}, ${high})`);
      this.add(first, values.close, `${prefix}max(${value}, ${low})`);
    }
    if (guards.has(name)) this.add(first, values.close, `(${values.texts[0]})`);
  }
  argumentsAt(open) {
    const texts = [];
    let depth = 0;
    let from = open + 1;
    for (let i = open; ; ++i) {
      const { text } = this.tokens[i];
      if ("([{".includes(text)) ++depth;
      if (")]}".includes(text)) --depth;
      if (depth > 1 || (depth === 1 && text !== ",")) continue;
      if (i > from) texts.push(this.text.slice(this.tokens[from].begin, this.tokens[i - 1].end));
      from = i + 1;
      if (depth === 0) return { texts, close: i };
    }
  }

  // Always the one, always the other.
  choice(i, region) {
    let depth = 0;
    let from = i;
    while (from > region.from) {
      const { text } = this.tokens[from - 1];
      if (/^[)\]}]$/.test(text)) ++depth;
      if (depth === 0 && /^([([{,;?:]|[-+*/&|]?=|return)$/.test(text)) break;
      if (/^[([{]$/.test(text)) --depth;
      --from;
    }
    this.add(from, i - 1, "true");
    this.add(from, i - 1, "false");
  }
}

// By token: the next constant of the same scope that the file names, in the order of the names'
// first appearance, round.
function siblingsOf(tokens) {
  const scope = (i) => {
    let first = i;
    while (tokens[first - 1]?.text === "::") first -= 2;
    return tokens.slice(first, i).map(({ text }) => text).join("");
  };
  const names = new Map();
  tokens.forEach(({ kind, text }, i) => {
    if (kind !== "word" || !/^k[A-Z]/.test(text) || tokens[i - 1]?.text !== "::") return;
    const known = names.get(scope(i)) ?? names.set(scope(i), []).get(scope(i));
    if (!known.includes(text)) known.push(text);
  });
  return (i) => {
    const known = names.get(scope(i)) ?? [];
    return known.length < 2 ? [] : [known[(known.indexOf(tokens[i].text) + 1) % known.length]];
  };
}
