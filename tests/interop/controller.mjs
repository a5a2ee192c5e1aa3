// Starts and stops the busbar-controller program for a test.
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

export const user = { userName: "operator", password: "a pass phrase" };

/** A port that was free a moment ago. */
export function freePort() {
  return new Promise((resolve) => {
    const server = createServer();
    server.listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

function configuration(program, port, folder) {
  const hash = spawnSync(program, ["--hash-password"], { input: `${user.password}\n`, encoding: "utf8" });
  if (hash.status !== 0) throw new Error(`--hash-password failed: ${hash.stderr}`);
  return `
[server]
port = ${port}
certificates = "${folder}/pki"
trust_all_clients = true      # the clients' certificates are made by the test itself
min_channel_lifetime_ms = 1000

[[endpoint]]
policy = "None"
mode = "None"
[[endpoint]]
policy = "Basic256Sha256"
mode = "Sign"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"

[users]
anonymous = "write"
[[users.account]]
name = "${user.userName}"
password = "${hash.stdout.trim()}"

[plc]
scan_ms = 20
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
[[plc.variable]]
name = "Bulk"
type = "Int16"
count = 25000
[[plc.program]]
kind = "increment"
target = "Counter"
`;
}

/** A running controller: its port, its endpoint and stop(), which resolves to the exit code. */
export async function startController() {
  const program = process.env.BUSBAR_CONTROLLER;
  const folder = mkdtempSync(join(tmpdir(), "busbar-interop-"));
  const port = await freePort();
  const config = join(folder, "controller.toml");
  writeFileSync(config, configuration(program, port, folder));
  const child = spawn(program, ["--config", config], { stdio: ["ignore", "pipe", "pipe"] });
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
    endpointUrl: `opc.tcp://localhost:${port}`,
    output: () => output,
    async stop() {
      child.kill("SIGTERM");
      const code = await exited;
      rmSync(folder, { recursive: true, force: true });
      return code;
    },
  };
}
