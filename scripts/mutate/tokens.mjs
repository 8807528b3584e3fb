// C++ text as tokens, without comments and preprocessor lines, and their brackets.
const punctuators = [
  "<=>", "<<=", ">>=", "...", "->*", "::", "->", "++", "--", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||",
  "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "[[", "]]",
];
const skipped = /(?:\s+|\/\/[^\n]*|\/\*[^]*?\*\/)+/y;
const directive = /#(?:[^\n\\]|\\[^])*/y;
const word = /[A-Za-z_]\w*/y;
const number = /\.?\d(?:[eEpP][+-]|'\w|[\w.])*/y;
const literal = /(?:u8|[uUL])?(?:"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')/y;
const rawLiteral = /(?:u8|[uUL])?R"([^(\s]*)\([^]*?\)\1"/y;

// [{text, kind, begin, end, before, after}]: kind word, number, literal or punctuator; before, after:
// whether there is a blank. Code that clang-format has laid out tells `a < b` from `span<int>` by it.
export function tokensOf(text) {
  const tokens = [];
  let at = 0;
  const match = (pattern) => {
    pattern.lastIndex = at;
    return pattern.exec(text)?.[0] ?? "";
  };
  while (at < text.length) {
    const gap = match(skipped) || (lineBegins(text, at) ? match(directive) : "");
    if (gap !== "") {
      at += gap.length;
      continue;
    }
    const found = [["literal", rawLiteral], ["literal", literal], ["word", word], ["number", number]]
      .map(([kind, pattern]) => ({ kind, text: match(pattern) }))
      .find((token) => token.text !== "") ?? {
        kind: "punctuator",
        // [[ and ]] are attributes where they close one another; what else they are has no place here.
        text: punctuators.find((sign) => text.startsWith(sign, at)) ?? text[at],
      };
    const end = at + found.text.length;
    tokens.push({
      ...found, begin: at, end, before: /\s/.test(text[at - 1] ?? "\n"), after: /\s/.test(text[end] ?? "\n"),
    });
    at = end;
  }
  return withoutAttributes(splitBrackets(tokens));
}

function lineBegins(text, at) {
  return /^[ \t]*$/.test(text.slice(text.lastIndexOf("\n", at - 1) + 1, at));
}

// `]]` closes two subscripts where no `[[` is open.
function splitBrackets(tokens) {
  const open = [];
  return tokens.flatMap((token) => {
    if (token.text === "[[" || token.text === "[") open.push(token.text);
    if (token.text === "]") open.pop();
    if (token.text !== "]]") return [token];
    if (open.pop() === "[[") return [token];
    open.pop();
    const half = { ...token, text: "]" };
    return [{ ...half, end: token.begin + 1, after: false }, { ...half, begin: token.begin + 1, before: false }];
  });
}

function withoutAttributes(tokens) {
  let depth = 0;
  return tokens.filter(({ text }) => {
    if (text === "[[") ++depth;
    const keep = depth === 0;
    if (text === "]]") --depth;
    return keep;
  });
}

// For every opening (, [ and { the index of the one that closes it.
export function bracketsOf(tokens) {
  const closing = new Map();
  const open = [];
  tokens.forEach(({ text, kind }, i) => {
    if (kind !== "punctuator") return;
    if ("([{".includes(text)) open.push(i);
    if (!")]}".includes(text)) return;
    const from = open.pop();
    if (from === undefined || "([{".indexOf(tokens[from].text) !== ")]}".indexOf(text)) {
      throw new Error(`a ${text} closes nothing`);
    }
    closing.set(from, i);
  });
  if (open.length > 0) throw new Error(`a ${tokens[open[0]].text} is never closed`);
  return closing;
}
