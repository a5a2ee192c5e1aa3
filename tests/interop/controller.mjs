// Starts and stops the busbar-controller program for a test.
import { spawn, spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

export const user = { userName: "operator", password: "a pass phrase" };

/** A port that was free a moment ago: below those of test scripts and those that systems give to clients, either of which
 * could have taken it since. */
export function freePort() {
  return new Promise((resolve) => {
    const server = createServer();
    const listen = () => server.listen(10_000 + Math.floor(Math.random() * 10_000), "127.0.0.1");
    server.on("error", listen).on("listening", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
    listen();
  });
}

const plc = (bulk) => `
[plc]
scan_ms = 20
queued_scans = 500
[[plc.variable]]
name = "Counter"
type = "Int32"
[[plc.variable]]
name = "Level"
type = "Double"
initial = 1.5
[[plc.variable]]
name = "Serial"
type = "String"
initial = "BB-1"
access = "read"
[[plc.variable]]
name = "Recipe"
type = "Int16"
dimensions = [8]
${bulk ? `[[plc.variable]]
name = "Bulk"
type = "Int16"
count = ${bulk}` : ""}
[[plc.variable]]
name = "Temperature"
type = "Float"
[[plc.variable]]
name = "Door"
type = "Boolean"
[[plc.program]]
kind = "increment"
target = "Counter"
[[plc.event]]
variable = "Temperature"
limit = 80.0
severity = 400
message = "Temperature is high"
[[plc.event]]
variable = "Temperature"
limit = 120.0
severity = 900
message = "Temperature is dangerous"
[[plc.event]]
variable = "Door"
severity = 600
message = "The door was opened"
`;

/** Costs as little as the controller allows: logins are many here, and none is about the hash. */
const quickHash = `
password_hash = "pbkdf2"
password_iterations = 10000`;
const hashes = new Map();

function hashOf(program, folder, password) {
  if (!hashes.has(password)) {
    const config = join(folder, "hash.toml");
    writeFileSync(config, `[users]${quickHash}`);
    const made = spawnSync(program, ["--hash-password", "--config", config], { input: `${password}\n`, encoding: "utf8" });
    if (made.status !== 0) throw new Error(`--hash-password failed: ${made.stderr}`);
    hashes.set(password, made.stdout.trim());
  }
  return hashes.get(password);
}

function account(program, folder, { userName, password, roles }) {
  return `
[[users.account]]
name = "${userName}"
password = "${hashOf(program, folder, password)}"
${roles ? `roles = ${JSON.stringify(roles)}` : ""}
`;
}

function machineSection(folder, { declarations, programs = "" }) {
  const file = join(folder, "machine.st");
  writeFileSync(file, declarations);
  return `
[machine]
program = "${file}"
name = "Press 4"
state = "${join(folder, "state")}"
medium = "${join(folder, "medium")}"
execution_log = true
[plc]
scan_ms = 20
${programs}`;
}

function labelsSection(folder, { declarations, programs = "" }) {
  const file = join(folder, "labels.st");
  writeFileSync(file, declarations);
  return `
[labels]
program = "${file}"
[plc]
scan_ms = 20
${programs}`;
}

function plcSection(folder, machine, labels, bulk) {
  if (labels) return labelsSection(folder, labels);
  return machine ? machineSection(folder, machine) : plc(bulk);
}

const endpoint = ([policy, mode]) => `
[[endpoint]]
policy = "${policy}"
mode = "${mode}"
`;

/** Without security, and both modes of one policy; every client's certificate is accepted. */
export const openHouse = {
  endpoints: [["None", "None"], ["Basic256Sha256", "Sign"], ["Basic256Sha256", "SignAndEncrypt"]],
  trustsAll: true, // the clients make their certificates themselves
  users: 'anonymous = "write"',
};

/**
 * A running controller: its port, its endpoint and stop(), which resolves to the exit code. `prepare` may
 * fill the folder of the certificates before it starts. `bulk` is how many variables are served besides, from Bulk0
 * on: they take most of the time that it needs to start. With a `machine` (declarations) its variables are
 * served instead of the simple ones, with an execution log; with `labels` they are the labels of a project, which is
 * in the folder "project". `backends` are tables [[backend]] of the configuration.
 */
export async function startController({ endpoints, trustsAll = false, users, prepare, nodesets = [],
  nodesetsStrict = true, reverseUrls = [], discoveryUrl = "", address = "", accounts = [], machine, labels,
  bulk = 0, backends = "",
  args = [] } = openHouse) {
  const program = process.env.BUSBAR_CONTROLLER;
  const folder = mkdtempSync(join(tmpdir(), "busbar-interop-"));
  const certificates = join(folder, "pki");
  mkdirSync(certificates);
  await prepare?.(certificates);
  const port = await freePort();
  const config = join(folder, "controller.toml");
  writeFileSync(config, `
[server]
address = "${address}"
port = ${port}
min_channel_lifetime_ms = 1000
nodesets = ${JSON.stringify(nodesets)}
nodesets_strict = ${nodesetsStrict}
[reverse_connect]
urls = ${JSON.stringify(reverseUrls)}
[discovery]
url = "${discoveryUrl}"
[certificates]
folder = "${certificates}"
trust_all_clients = ${trustsAll}
${endpoints.map(endpoint).join("")}
[users]${quickHash}
${users}
${[user, ...accounts].map((each) => account(program, folder, each)).join("")}
${plcSection(folder, machine, labels, bulk)}
${backends}`);
  // A project has a port of its own, but for this.
  const model = labels ? ["--project", join(folder, "project"), "--port", String(port)] : [];
  const child = spawn(program, ["--config", config, ...model, ...args], { stdio: ["ignore", "pipe", "pipe"] });
  let output = "";
  const exited = new Promise((resolve) => child.on("exit", (code, signal) => resolve(code ?? signal)));
  await new Promise((resolve, reject) => {
    const onText = (text) => {
      output += text;
      if (/ready/i.test(output)) resolve();
    };
    child.stdout.setEncoding("utf8").on("data", onText);
    child.stderr.setEncoding("utf8").on("data", onText);
    exited.then((code) => reject(new Error(`the controller ended with ${code}: ${output}`)));
  });
  return {
    port,
    folder,
    certificates,
    endpointUrl: `opc.tcp://${address || "localhost"}:${port}`,
    output: () => output,
    /** Has a machine take over other declarations. */
    edit(declarations) {
      writeFileSync(join(folder, "machine.st"), declarations);
      child.kill("SIGHUP");
    },
    async stop() {
      child.kill("SIGTERM");
      const code = await exited;
      rmSync(folder, { recursive: true, force: true });
      return code;
    },
  };
}
