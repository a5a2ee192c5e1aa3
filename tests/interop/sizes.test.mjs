// Each size of namespace 0 says what is there: node-opcua crawls it.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import opcua from "./opcua.mjs";
import { anonymous, modes, withSession } from "./client.mjs";
import { crawl } from "./crawl.mjs";

const { AttributeIds, DataType, NodeClass, StatusCodes } = opcua;

async function start(size) {
  const child = spawn(process.env.BUSBAR_SIZED_SERVER, [size], { stdio: ["ignore", "pipe", "inherit"] });
  const exited = new Promise((resolve) => child.on("exit", (code, signal) => resolve(code ?? signal)));
  const port = await new Promise((resolve, reject) => {
    let output = "";
    child.stdout.setEncoding("utf8").on("data", (text) => {
      output += text;
      const ready = /ready (\d+)/.exec(output);
      if (ready) resolve(ready[1]);
    });
    exited.then((code) => reject(new Error(`the server ended with ${code}`)));
  });
  return {
    folder: mkdtempSync(join(tmpdir(), "busbar-size-")),
    endpointUrl: `opc.tcp://127.0.0.1:${port}`,
    async stop() {
      child.kill("SIGTERM");
      rmSync(this.folder, { recursive: true, force: true });
      return exited;
    },
  };
}

const least = { micro: 10, embedded: 60, standard: 60, full: 60 };

for (const size of Object.keys(least)) {
  test(`${size}: no value below Objects is null and no Method is dead`, { timeout: 60_000 }, async () => {
    const server = await start(size);
    await withSession(server, modes.None, anonymous, async (session) => {
      const nodes = [...(await crawl(session, "i=84"))];
      const objects = [...(await crawl(session, "i=85"))];
      assert.ok(nodes.length > objects.length, `${nodes.length} nodes`);
      const of = (nodeClass) =>
        objects.filter(([, reference]) => reference?.nodeClass === nodeClass).map(([nodeId]) => nodeId);
      const variables = of(NodeClass.Variable);
      assert.ok(variables.length >= least[size], `${variables.length} Variables`);
      const values = await session.read(variables.map((nodeId) => ({ nodeId, attributeId: AttributeIds.Value })));
      values.forEach((value, i) => {
        const isNull = value.statusCode === StatusCodes.Good && value.value.dataType === DataType.Null;
        assert.ok(!isNull, `${variables[i]} is Good with null`);
      });
      for (const methodId of of(NodeClass.Method)) {
        const result = await session.call({ objectId: "i=2253", methodId, inputArguments: [] });
        assert.equal(result.statusCode, StatusCodes.BadArgumentsMissing, methodId);
      }
    }, server.endpointUrl);
    assert.equal(await server.stop(), 0, "it stops cleanly on SIGTERM");
  });
}
