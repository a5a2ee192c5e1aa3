// Starts the node-opcua server of peer_server.mjs, and runs the program busbar against it.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { clientOptions, makeCertificate } from "./certificates.mjs";
import { freePort } from "./controller.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const limitMs = 150_000; // for what hangs: where others build, to start a server has taken a minute

/** A folder with the certificate that all servers of a test share, since keys take their time. */
export async function makeFolder(addresses = []) {
  const folder = mkdtempSync(join(tmpdir(), "busbar-peer-"));
  const made = await makeCertificate("Peer", { applicationUri: "urn:interop:peer", addresses });
  await clientOptions(folder, "peer", made);
  return folder;
}
export const removeFolder = (folder) => rmSync(folder, { recursive: true, force: true });

/** A process, and what it writes line by line. */
class Running {
  constructor(program, words, { environment = {}, read = (line) => line } = {}) {
    this.name = [program, ...words].join(" ");
    this.lines = [];
    this.errors = "";
    this.child = spawn(program, words, { env: { ...process.env, ...environment } });
    this.waiting = new Set();
    this.child.stderr.setEncoding("utf8").on("data", (text) => {
      this.errors += text;
      this.waiting.forEach((look) => look());
    });
    this.closed = new Promise((resolve) => this.child.on("close", (code, signal) => resolve(code ?? signal)));
    createInterface({ input: this.child.stdout }).on("line", (line) => {
      this.lines.push(read(line));
      this.waiting.forEach((look) => look());
    });
  }
  /** Until `condition` holds for the lines, or for what it wrote to standard error. */
  async until(condition, what) {
    let look;
    try {
      await this.bounded(what, (resolve, reject) => {
        look = () => condition(this.lines, this.errors) && resolve();
        this.waiting.add(look);
        this.closed.then((code) => reject(new Error(`${this.name} ended with ${code} before ${what}: ${this.errors}`)));
        look();
      });
    } finally {
      this.waiting.delete(look);
    }
  }
  /** Its exit code, or the signal that ended it. */
  end() {
    return this.bounded("its end", (resolve) => this.closed.then(resolve));
  }
  kill(signal) {
    this.child.kill(signal);
    return this.end();
  }
  bounded(what, action) {
    let timer;
    const promise = new Promise((resolve, reject) => {
      timer = setTimeout(() => {
        this.child.kill("SIGKILL");
        const last = JSON.stringify(this.lines.slice(-3));
        reject(new Error(`${this.name}: in vain waited for ${what}: ${last} ${this.errors}`));
      }, limitMs);
      action(resolve, reject);
    });
    return promise.finally(() => clearTimeout(timer));
  }
}

/**
 * A server that is ready, with the certificate in `folder`. `isLater`: all is loaded, and it is ready after start().
 * `second`: it is the same at another port, too, which has a limit: "signing", "small". See the programs.
 */
export async function startPeer({
  folder, port, types = join(here, "peer.NodeSet2.xml"), program = "peer_server.mjs", second, isLater = false,
}) {
  port ??= await freePort();
  const secondPort = second && (await freePort());
  const words = [join(here, program), String(port), folder, types];
  if (second) words.push(`${second}=${secondPort}`);
  if (isLater) words.push("later");
  const server = new Running(process.execPath, words);
  const isReady = () => server.until((lines) => lines.includes("ready"), "being ready");
  await (isLater ? server.until((lines) => lines.includes("loaded"), "being loaded") : isReady());
  const behave = async (options) => {
    const told = `behaves: ${options.join(" ")}`;
    const countOf = (lines) => lines.filter((line) => line === told).length;
    const count = countOf(server.lines) + 1;
    server.child.stdin.write(`${options.join(" ")}\n`);
    await server.until((lines) => countOf(lines) === count, told);
  };
  return {
    port,
    endpointUrl: `opc.tcp://localhost:${port}`,
    secondUrl: `opc.tcp://localhost:${secondPort}`,
    behave,
    async start() {
      await behave([]);
      await isReady();
    },
    /** Until somebody has logged in like "Basic256Sha256 Sign UserNameIdentityToken". */
    login: (how) => server.until((lines) => lines.includes(`login: ${how}`), how),
    /** Without time for a goodbye. */
    kill: () => server.kill("SIGKILL"),
  };
}

/** The program with a folder of certificates and options of its own. */
export class Busbar {
  constructor({ endpointUrl }, pki, options = []) {
    this.options = ["--url", endpointUrl, "--pki", pki, ...options];
  }
  /** As people use it. */
  startForPeople(words) {
    return new Running(process.env.BUSBAR_CLIENT, [...this.options, ...words]);
  }
  /** As scripts do: each line is a JSON document. */
  start(words, environment) {
    const all = ["--json", ...this.options, ...words];
    return new Running(process.env.BUSBAR_CLIENT, all, { environment, read: JSON.parse });
  }
  /** The exit code and all lines. */
  async run(words, environment) {
    const program = this.start(words, environment);
    const code = await program.end();
    return { code, json: program.lines[0], lines: program.lines, errors: program.errors };
  }
}
