// node-opcua's client against the examples in C.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readdirSync, renameSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { describe, test } from "node:test";
import { createClient, modes, named } from "./client.mjs";
import { freePort, user } from "./controller.mjs";
import opcua from "./opcua.mjs";

const { AttributeIds, DataType, StatusCodes } = opcua;
const valueOf = (nodeId) => ({ nodeId, attributeId: AttributeIds.Value });

/** Starts an example in a folder of its own. */
async function start(name) {
  const folder = mkdtempSync(join(tmpdir(), "busbar-c-"));
  const port = await freePort();
  const env = { ...process.env, FIRST_SERVER_PASSWORD: user.password, EXAMPLE_PASSWORD: user.password };
  const child = spawn(join(process.env.BUSBAR_PROGRAMS, name), [String(port)], { cwd: folder, env });
  const end = new Promise((ended) => child.on("exit", (code) => ended(code)));
  await new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`${name} is not ready`)), 30_000);
    createInterface({ input: child.stderr }).on("line", (line) => {
      if (line.startsWith("ready at")) {
        clearTimeout(timer);
        resolve();
      }
    });
    child.on("error", reject);
  });
  const stop = () => (child.kill("SIGTERM"), end);
  return { folder, url: `opc.tcp://localhost:${port}`, pki: join(folder, `${name.replaceAll("-", "_")}_pki`), stop };
}

/** A session of the example's user. The server meets the client's certificate first, and then trusts it. */
async function inSession(server, action) {
  const rejected = join(server.pki, "rejected", "certs");
  const client = await createClient(server.folder, { ...modes.SignAndEncrypt, connectionStrategy: { maxRetry: 0 } });
  await client.connect(server.url).catch(() => {});
  await client.disconnect().catch(() => {});
  for (const file of existsSync(rejected) ? readdirSync(rejected) : []) {
    renameSync(join(rejected, file), join(server.pki, "trusted", "certs", file));
  }
  const trusted = await createClient(server.folder, modes.SignAndEncrypt);
  await trusted.connect(server.url);
  try {
    const session = await trusted.createSession(named(user));
    try {
      return await action(session);
    } finally {
      await session.close();
    }
  } finally {
    await trusted.disconnect();
  }
}

describe("examples in C", { skip: !existsSync(join(process.env.BUSBAR_PROGRAMS, "plc-in-c")) }, () => {
  test("first_server_c: reads and writes over an encrypted channel", async () => {
    const server = await start("first-server-c");
    try {
      await inSession(server, async (session) => {
        const speed = "ns=2;s=Speed";
        assert.equal((await session.read(valueOf(speed))).value.value, 1480);
        const write = (dataType, value) =>
          session.write({ ...valueOf(speed), value: { value: { dataType, value } } });
        assert.equal(await write(DataType.Double, 1200), StatusCodes.Good);
        assert.equal(await write(DataType.String, "fast"), StatusCodes.BadTypeMismatch);
        assert.equal((await session.read(valueOf(speed))).value.value, 1200);
      });
    } finally {
      assert.equal(await server.stop(), 0);
    }
  });

  test("plc_in_c: an image scan by scan, a structure, a Write at the scan's edge and a Method", async () => {
    const server = await start("plc-in-c");
    try {
      await inSession(server, async (session) => {
        const read = async (name) => (await session.read(valueOf(`ns=2;s=${name}`))).value.value;
        const first = await read("Scans");
        for (let i = 0; i < 500 && (await read("Scans")) === first; ++i);
        assert.notEqual(await read("Scans"), first, "the PLC scans");
        const write = (name, dataType, value) =>
          session.write({ ...valueOf(`ns=2;s=${name}`), value: { value: { dataType, value } } });
        assert.equal(await write("SetPoint", DataType.Double, 20), StatusCodes.Good);
        assert.equal(await read("SetPoint"), 20);
        assert.equal(await write("Recipe", DataType.String, "x".repeat(33)), StatusCodes.BadOutOfRange);
        assert.notEqual(await write("Scans", DataType.UInt32, 0), StatusCodes.Good);
        // Scans and positions of one Read are of one scan.
        const [scans, positions, setPoint] = await session.read(["Scans", "Positions", "SetPoint"].map((name) => valueOf(`ns=2;s=${name}`)));
        const expected = setPoint.value.value * Math.sin(0.01 * (scans.value.value - 1));
        assert.ok(Math.abs(positions.value.value[0] - expected) < 1e-9, `${positions.value.value[0]} is not ${expected}`);
        const called = await session.call({ objectId: "i=85", methodId: "ns=2;s=StopDrive", inputArguments: [] });
        assert.equal(called.statusCode, StatusCodes.Good);
        assert.equal(called.outputArguments[0].dataType, DataType.UInt32);
        const dataTypes = await session.read({ nodeId: "ns=2;s=Drive", attributeId: AttributeIds.DataType });
        assert.match(dataTypes.value.value.toString(), /DriveType/);
      });
    } finally {
      assert.equal(await server.stop(), 0);
    }
  });
});
