// Published information models: node-opcua ships their NodeSet2 files.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readdirSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import test from "node:test";
import opcua from "./opcua.mjs";
import { anonymous, modes, withSession } from "./client.mjs";
import { openHouse, startController } from "./controller.mjs";
import { crawl } from "./crawl.mjs";

const { AttributeIds, DataType, NodeClass, StatusCodes } = opcua;

const nodeOpcua = createRequire(import.meta.url).resolve("node-opcua");
const main = createRequire(nodeOpcua).resolve("node-opcua-nodesets");
const folder = path.join(main.slice(0, main.lastIndexOf("node-opcua-nodesets")), "node-opcua-nodesets", "nodesets");

test("they load together and re-read equal, and each with what it requires", { skip: !process.env.BUSBAR_NODESET_TEST }, () => {
  const run = spawnSync(process.env.BUSBAR_NODESET_TEST, ["Published*"], {
    env: { ...process.env, BUSBAR_NODESETS: folder },
    encoding: "utf8",
  });
  assert.equal(run.status, 0, run.stdout);
  assert.match(run.stdout, /\d+ namespaces/);
  assert.match(run.stdout, /[3-9]\d models in \d+ files/);
});

test("one server has them all, and a client reads their structures", { timeout: 180_000 }, async () => {
  const nodesets = readdirSync(folder).filter((name) => name.endsWith(".xml")).map((name) => path.join(folder, name));
  const controller = await startController({ ...openHouse, nodesets });
  try {
    await withSession(controller, modes.None, anonymous, async (session) => {
      const namespaces = await session.readNamespaceArray();
      assert.ok(namespaces.length > 30, `${namespaces.length} namespaces`);
      const nodes = await crawl(session, "i=84");
      const variables = [...nodes].filter(([nodeId, reference]) =>
        reference?.nodeClass === NodeClass.Variable && /^ns=([3-9]|\d\d)/.test(nodeId)).map(([nodeId]) => nodeId);
      let structures = 0;
      let ofModels = 0; // of types that the client learns from DataTypeDefinitions
      for (let at = 0; at < variables.length; at += 1_000) {
        const part = variables.slice(at, at + 1_000);
        const values = await session.read(part.map((nodeId) => ({ nodeId, attributeId: AttributeIds.Value })));
        values.forEach((value, i) => {
          if (value.statusCode !== StatusCodes.Good || value.value?.dataType !== DataType.ExtensionObject) return;
          for (const one of [value.value.value].flat().filter((object) => object !== null)) {
            assert.notEqual(one.constructor.name, "OpaqueStructure", `${part[i]}: ${one.nodeId} is not decoded`);
            ++structures;
            if (one.schema.dataTypeNodeId?.namespace > 0) ++ofModels;
          }
        });
      }
      assert.ok(nodes.size > 15_000, `${nodes.size} nodes`);
      assert.ok(structures > 1_000, `${structures} structures in ${variables.length} variables`);
      assert.ok(ofModels > 10, `${ofModels} of the models' own types`);
    });
  } finally {
    assert.equal(await controller.stop(), 0);
  }
});
