// Where code that runs stands in a C++ file, so far as wrong code is made of it: statements of
// functions, and expressions that are conditions or that something begins with. Not templates'
// parameters, enumerations, static_asserts, parameters and lists of a constructor's members.
import { bracketsOf, tokensOf } from "./tokens.mjs";

const declares = new Set(["const", "constexpr", "static", "auto", "inline", "volatile", "unsigned", "signed"]);

// [{role, from, to, own, alone, constant, inner, returnsBool}], `from` to before `to` of the tokens. role:
//   statement  ends with a semicolon; may be left out   jump  a statement that may not: return, throw
//   condition, loop                                     value  an expression of another kind
// alone: it counts at compile time. constant: it may. inner: regions of functions inside of it, own: the
// tokens that are not in those.
export function regionsOf(text) {
  const tokens = tokensOf(text);
  return { tokens, regions: new Parser(tokens, bracketsOf(tokens)).scope(0, tokens.length, false) };
}

class Parser {
  constructor(tokens, closing) {
    this.tokens = tokens;
    this.closing = closing;
    this.constant = false;
    this.returnsBool = false;
  }

  is(i, ...texts) {
    return texts.includes(this.tokens[i]?.text);
  }

  // The first of these at or behind i that is in no bracket.
  find(i, end, ...texts) {
    while (i < end && !this.is(i, ...texts)) i = (this.closing.get(i) ?? i) + 1;
    return i;
  }

  // Behind the < > at i.
  behindAngles(i) {
    let depth = 0;
    for (; i < this.tokens.length; i = (this.closing.get(i) ?? i) + 1) {
      const { text, before, after } = this.tokens[i];
      if (text === "<") ++depth;
      if (text === ">" && !(before && after)) --depth;
      if (text === ">>") depth -= 2;
      if (depth <= 0) return i + 1;
    }
    throw new Error("a template's < is never closed");
  }

  // Declarations of a namespace or of a class.
  scope(i, end) {
    const regions = [];
    while (i < end) i = this.declaration(i, end, regions);
    return regions;
  }

  declaration(i, end, regions) {
    if (this.is(i, ";")) return i + 1;
    if (this.is(i, "public", "private", "protected") && this.is(i + 1, ":")) return i + 2;
    if (this.is(i, "template")) return this.behindAngles(i + 1);
    if (this.is(i, "requires") && this.is(i + 1, "(")) return this.closing.get(i + 1) + 1;
    if (this.is(i, "using", "static_assert", "friend", "typedef", "concept", "extern")) {
      return this.find(i, end, ";") + 1;
    }
    const head = this.head(i, end);
    const words = this.tokens.slice(i, head).map(({ text }) => text);
    const constant = words.includes("constexpr");
    if (this.is(head, "{")) {
      const close = this.closing.get(head);
      if (words.includes("enum")) return close + 1;
      if (words[0] === "namespace" || /^(class|struct|union)$/.test(words[0])) {
        regions.push(...this.scope(head + 1, close));
        return close + 1;
      }
      if (words.includes("(")) {
        regions.push(...this.functionBody(head, constant, words[words.indexOf("(") - 2] === "bool"));
        return close + 1;
      }
      regions.push(...this.values(head, { alone: constant, constant: true }));
      return this.find(close, end, ";") + 1;
    }
    const semicolon = this.find(head, end, ";");
    const isVariable = this.is(head, "=") && !words.includes("(") && !this.is(head + 1, "default", "delete");
    if (isVariable) regions.push(this.region("value", head + 1, semicolon, { alone: constant, constant: true }));
    return semicolon + 1;
  }

  // Where a declaration's head ends: its body, its value or its semicolon.
  head(i, end) {
    let isFunction = false;
    let isList = false;
    for (; i < end; ++i) {
      if (this.is(i, ";")) return i;
      if (this.is(i, "=") && !this.is(i - 1, "operator")) return i;
      if (isFunction && this.is(i, ":")) isList = true;
      // A member of the list before a constructor's body has braces behind its name.
      if (this.is(i, "{") && !(isList && this.tokens[i - 1].kind === "word")) return i;
      if (this.is(i, "(")) isFunction = true;
      i = this.closing.get(i) ?? i;
    }
    return end;
  }

  // The body that opens at `open`.
  functionBody(open, constant, returnsBool) {
    const outer = [this.constant, this.returnsBool];
    this.constant = constant;
    this.returnsBool = returnsBool;
    const regions = this.statements(open + 1, this.closing.get(open));
    [this.constant, this.returnsBool] = outer;
    return regions;
  }

  statements(i, end) {
    const regions = [];
    while (i < end) i = this.statement(i, end, regions);
    return regions;
  }

  // Behind the statement at i.
  statement(i, end, regions) {
    if (this.is(i, ";")) return i + 1;
    if (this.is(i, "{")) {
      regions.push(...this.statements(i + 1, this.closing.get(i)));
      return this.closing.get(i) + 1;
    }
    if (this.is(i, "else", "do")) return this.statement(i + 1, end, regions);
    if (this.is(i, "case", "default")) return this.find(i, end, ":") + 1;
    if (this.is(i, "if", "while", "for", "switch")) return this.control(i, end, regions);
    const semicolon = this.find(i, end, ";");
    if (this.is(i, "static_assert", "using", "typedef")) return semicolon + 1;
    if (this.is(i, "return", "throw")) {
      if (semicolon > i + 1) regions.push(this.region("jump", i, semicolon + 1));
    } else if (this.isDeclaration(i)) {
      this.beginning(i, semicolon, regions);
    } else {
      regions.push(this.region("statement", i, semicolon + 1));
    }
    return semicolon + 1;
  }

  control(i, end, regions) {
    const atCompileTime = this.is(i + 1, "constexpr");
    const open = i + (atCompileTime ? 2 : 1);
    const close = this.closing.get(open);
    const parts = [open + 1];
    for (let at = open + 1; (at = this.find(at, close, ";")) < close;) parts.push(++at);
    if (this.is(i, "for") && parts.length === 1) {
      const colon = this.find(open + 1, close, ":");
      if (colon < close) regions.push(this.region("value", colon + 1, close, { alone: true }));
    } else if (!this.is(i, "switch")) {
      const isFor = this.is(i, "for");
      const tested = isFor ? 1 : parts.length - 1;
      parts.forEach((from, part) => {
        const to = (parts[part + 1] ?? close + 1) - 1;
        if (from >= to) return;
        if (part < tested || (part === tested && this.isDeclaration(from))) {
          this.isDeclaration(from) ? this.beginning(from, to, regions) : regions.push(this.region("value", from, to));
        } else if (part === tested) {
          const role = this.is(i, "if") ? "condition" : "loop";
          regions.push(this.region(role, from, to, atCompileTime ? { alone: true } : {}));
        } else {
          regions.push(this.region("value", from, to));
        }
      });
    }
    if (this.is(close + 1, ";") && this.is(i, "while")) return close + 2;
    return this.statement(close + 1, end, regions);
  }

  // What a variable begins with, in the declaration i to before end.
  beginning(i, end, regions) {
    const alone = this.tokens.slice(i, end).some(({ text }) => text === "constexpr");
    const at = this.find(i, end, "=", "{");
    if (at >= end) return;
    if (this.is(at, "{")) {
      regions.push(...this.values(at, { alone }));
    } else {
      regions.push(this.region("value", at + 1, end, { alone }));
    }
  }

  // Those between the braces at `open`, one by one.
  values(open, how) {
    const close = this.closing.get(open);
    const regions = [];
    for (let from = open + 1; from < close;) {
      const to = this.find(from, close, ",");
      // .name = value
      const equal = this.is(from, ".") ? this.find(from, to, "=") + 1 : from;
      if (equal < to) regions.push(this.region("value", equal, to, how));
      from = to + 1;
    }
    return regions;
  }

  // A type and a name behind it.
  isDeclaration(i) {
    if (declares.has(this.tokens[i].text)) return true;
    if (this.tokens[i].kind !== "word") return false;
    for (++i; this.is(i, "::", "<");) i = this.is(i, "<") ? this.behindTypes(i) : i + 2;
    while (this.is(i, "&", "*", "const", "&&") && !(this.tokens[i].before && this.tokens[i].after)) ++i;
    return this.tokens[i]?.kind === "word" && !this.tokens[i - 1].text.startsWith(".");
  }
  // As behindAngles(), where it may be a comparison.
  behindTypes(i) {
    return this.tokens[i].before ? this.tokens.length : this.behindAngles(i);
  }

  region(role, from, to, how = {}) {
    const inner = [];
    const own = [];
    for (let i = from; i < to; ++i) {
      own.push(i);
      const body = this.lambdaBody(i);
      if (body === undefined) continue;
      for (++i; i < body; ++i) own.push(i);
      inner.push(...this.functionBody(body, this.constant, false));
      i = this.closing.get(body);
    }
    return {
      role, from, to, own, inner, alone: how.alone ?? false, constant: how.constant ?? this.constant,
      returnsBool: this.returnsBool,
    };
  }

  // Where the body opens of the lambda that begins at i.
  lambdaBody(i) {
    if (!this.is(i, "[")) return undefined;
    const { kind, text } = this.tokens[i - 1] ?? {};
    const isSubscript = text === ")" || text === "]" || (kind !== "punctuator" && text !== "return");
    if (kind !== undefined && isSubscript) return undefined;
    const after = this.closing.get(i) + 1;
    const body = this.is(after, "(") ? this.find(this.closing.get(after) + 1, this.tokens.length, "{", ";") : after;
    return this.is(body, "{") ? body : undefined;
  }
}
