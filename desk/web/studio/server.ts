"use strict";

/** Why the server did not do what was asked; `confirm`: it will where it is asked once more. */
class Refusal extends Error {
  constructor(words, confirm) {
    super(words);
    this.confirm = confirm;
  }
}

/**
 * What the server answers to a request of docs/studio.md; addresses are relative, the token is in
 * the page's own.
 * @param {"GET" | "POST" | "DELETE"} method
 * @param {string} path
 * @param {object=} body
 * @returns {Promise<any>}
 */
async function ask(method, path, body) {
  const options = { method };
  if (method === "POST") {
    options.headers = { "Content-Type": "application/json" };
    options.body = JSON.stringify(body ?? {});
  }
  return answerTo(path, options);
}

/**
 * A file as it lies on the disk, under its name.
 * @param {File} file
 */
function handOver(file) {
  return answerTo(`load/files?name=${encodeURIComponent(file.name)}`, {
    method: "POST",
    headers: { "Content-Type": "application/octet-stream" },
    body: file,
  });
}

async function answerTo(path, options) {
  let answer;
  try {
    answer = await fetch(`api/${path}`, options);
  } catch {
    throw new Refusal("Studio does not answer any more: start it again in the terminal.", false);
  }
  if (answer.status === 204) return null;
  const json = await answer.json().catch(() => ({ error: `The server says ${answer.status}.` }));
  if (!answer.ok) throw new Refusal(json.error, json.confirm === true);
  return json;
}

/** Whoever leaves the page wants nothing to go on behind it. A beacon would not say its origin everywhere. */
window.addEventListener("pagehide", () => {
  fetch("api/leave", { method: "POST", keepalive: true }).catch(() => {});
});
