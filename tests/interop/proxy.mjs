// busbar's proxy in front of a server of this machine: it cuts connections and records them as a capture file.
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

const busbar = process.env.BUSBAR_CLIENT;

/** Listens on a free port and forwards to `target`, a port. */
export async function startProxy(target) {
  const folder = mkdtempSync(join(tmpdir(), "busbar-proxy-"));
  const recording = join(folder, "recording");
  const proxy = spawn(busbar, ["proxy", `opc.tcp://127.0.0.1:${target}`, "--pass", "--control", "--quiet", "--record", recording],
    { stdio: ["pipe", "ignore", "pipe"] });
  const ended = new Promise((resolve) => proxy.on("exit", resolve));
  const url = await new Promise((resolve, reject) => {
    proxy.on("exit", () => reject(new Error("the proxy does not start")));
    createInterface({ input: proxy.stderr }).on("line", (line) => {
      const found = /^busbar: (\S+) leads to/.exec(line);
      if (found) resolve(found[1]);
    });
  });
  return {
    port: Number(new URL(url.replace("opc.tcp", "http")).port),
    /** Cuts every connection without a goodbye. */
    cut() {
      proxy.stdin.write("cut\n");
    },
    /** Ends it, and writes what it has seen as a capture file if there is a name for one. */
    async stop(file) {
      proxy.kill("SIGTERM");
      await ended;
      if (file !== undefined) {
        spawnSync(busbar, ["show", recording, "--pcap", file], { stdio: "ignore" });
      }
      rmSync(folder, { recursive: true });
    },
  };
}
