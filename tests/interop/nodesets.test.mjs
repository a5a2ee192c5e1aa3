import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { createRequire } from "node:module";
import path from "node:path";
import test from "node:test";

// The NodeSets that node-opcua ships load together and re-read equal (tests/model).
test("published NodeSets", { skip: !process.env.BUSBAR_NODESET_TEST }, () => {
  const nodeOpcua = createRequire(import.meta.url).resolve("node-opcua");
  const main = createRequire(nodeOpcua).resolve("node-opcua-nodesets");
  const folder = path.join(main.slice(0, main.lastIndexOf("node-opcua-nodesets")),
    "node-opcua-nodesets", "nodesets");
  const run = spawnSync(process.env.BUSBAR_NODESET_TEST, ["Published*"], {
    env: { ...process.env, BUSBAR_NODESETS: folder },
    encoding: "utf8",
  });
  assert.equal(run.status, 0, run.stdout);
  assert.match(run.stdout, /\d+ namespaces/);
});
