// Programs that are run, some at a time, and the folder that all of them write into. None outlives this
// one, however it ends, and the folder goes with it; where this one is killed, the next one takes it away.
import { spawn } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { availableParallelism, tmpdir } from "node:os";
import { join } from "node:path";

const prefix = "offnominal-mutate";
const running = new Set();

export function workFolder() {
  for (const name of readdirSync(tmpdir())) {
    const owner = name.match(/^offnominal-mutate\.(\d+)\./);
    if (owner !== null && !isAlive(Number(owner[1]))) rmSync(join(tmpdir(), name), { recursive: true, force: true });
  }
  const folder = mkdtempSync(join(tmpdir(), `${prefix}.${process.pid}.`));
  process.on("exit", () => {
    for (const child of running) end(child);
    rmSync(folder, { recursive: true, force: true });
  });
  for (const [signal, code] of [["SIGINT", 130], ["SIGTERM", 143], ["SIGHUP", 129]]) {
    process.on(signal, () => process.exit(code));
  }
  return folder;
}

function isAlive(pid) {
  try {
    process.kill(pid, 0);
    return true;
  } catch (error) {
    return error.code === "EPERM";
  }
}

function end(child) {
  try {
    process.kill(-child.pid, "SIGKILL");
  } catch {
    // It has ended by itself.
  }
}

export const killed = 137;

// {code, text}: exit code, `killed` for one that took longer, and what it printed, its end where that is long.
// memory_kb: of its address space.
export function run([program, ...args], { seconds = 3600, memory_kb = "unlimited", ...options } = {}) {
  return new Promise((done) => {
    // A process dies with the one that began it: this one, timeout.
    const limited = 'ulimit -v "$1" -c 0; seconds="$2"; shift 2; ' +
      'exec setpriv --pdeathsig KILL timeout --signal=KILL "$seconds" setpriv --pdeathsig KILL "$@"';
    const child = spawn("bash", ["-c", limited, "limited", memory_kb, seconds, program, ...args].map(String), {
      ...options, detached: true, stdio: ["ignore", "pipe", "pipe"],
    });
    running.add(child);
    let text = "";
    const take = (data) => {
      text = (text + data).slice(-1_000_000);
    };
    child.stdout.on("data", take);
    child.stderr.on("data", take);
    child.on("close", (code) => {
      running.delete(child);
      // What it has left behind holds no pipe of ours.
      end(child);
      done({ code: code ?? killed, text });
    });
  });
}

// The results of work(item, worker), as many at a time as there are processors, in the items' order.
export async function inParallel(items, work) {
  const results = new Array(items.length);
  let next = 0;
  const worker = async (_, number) => {
    while (next < items.length) {
      const at = next++;
      results[at] = await work(items[at], number);
    }
  };
  await Promise.all(Array.from({ length: workers }, worker));
  return results;
}
export const workers = availableParallelism();
