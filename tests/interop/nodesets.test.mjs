// Published information models: node-opcua ships their NodeSet2 files.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
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

/** NodeClass, BrowseName and whether it is restricted, of every node that a file has, by the NodeId in a server of these namespaces. */
function nodesOf(file, namespaces) {
  const text = readFileSync(file, "utf8").replace(/<!--[^]*?-->/g, "");
  const uris = [namespaces[0], ...[...text.matchAll(/<Uri>\s*([^<]*?)\s*<\/Uri>/g)].map((match) => match[1])];
  const mapped = (index) => namespaces.indexOf(uris[index]);
  const nodes = new Map();
  for (const [, nodeClass, attributes] of text.matchAll(/<UA(Object|Variable|Method|ObjectType|VariableType|ReferenceType|DataType|View)\s([^>]*)>/g)) {
    const [, , index, id] = /\bNodeId="(ns=(\d+);)?([^"]*)"/.exec(attributes);
    const [, , nameIndex, name] = /\bBrowseName="((\d+):)?([^"]*)"/.exec(attributes);
    if (!Number(index ?? 0)) continue; // the server's own namespace 0
    // Some are for clients with a secure channel or a role.
    const isRestricted = /\b(AccessRestrictions|HasNoPermissions)=/.test(attributes);
    nodes.set(`ns=${mapped(index)};${unescaped(id)}`,
      [nodeClass, `${mapped(nameIndex ?? 0)}:${unescaped(name)}`, isRestricted]);
  }
  return nodes;
}
const unescaped = (text) => text.replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&quot;/g, '"').replace(/&apos;/g, "'").replace(/&amp;/g, "&");

test("one server has them all, and a client reads their structures", { timeout: 300_000 }, async () => {
  const nodesets = readdirSync(folder).filter((name) => name.endsWith(".xml")).map((name) => path.join(folder, name));
  const controller = await startController({ ...openHouse, nodesets, nodesetsStrict: false });
  try {
    await withSession(controller, modes.None, anonymous, async (session) => {
      const namespaces = await session.readNamespaceArray();
      assert.ok(namespaces.length > 30, `${namespaces.length} namespaces`);
      const nodes = await crawl(session, "i=84");
      const wanted = new Map(nodesets.flatMap((file) => [...nodesOf(file, namespaces)]));
      const ids = [...wanted.keys()];
      assert.ok(ids.length > 14_000, `${ids.length} nodes in the files`);
      let hidden = 0;
      for (let at = 0; at < ids.length; at += 1_000) {
        const part = ids.slice(at, at + 1_000);
        const values = await session.read(part.flatMap((nodeId) =>
          [AttributeIds.NodeClass, AttributeIds.BrowseName].map((attributeId) => ({ nodeId, attributeId }))));
        part.forEach((nodeId, i) => {
          if (!values[2 * i].statusCode.isGood() && wanted.get(nodeId)[2]) {
            ++hidden;
            return;
          }
          const name = values[2 * i + 1].value?.value;
          assert.deepEqual([NodeClass[values[2 * i].value?.value], `${name?.namespaceIndex}:${name?.name}`],
            wanted.get(nodeId).slice(0, 2), `${nodeId} ${values[2 * i].statusCode}`);
        });
      }
      assert.ok(hidden < 100, `${hidden} nodes that others must not see`);
      const models = new Set(ids.map((nodeId) => nodeId.slice(0, nodeId.indexOf(";"))));
      const others = [...nodes.keys()].filter((nodeId) =>
        models.has(nodeId.slice(0, nodeId.indexOf(";"))) && !wanted.has(nodeId));
      assert.deepEqual(others, [], "nodes that no file has");
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
