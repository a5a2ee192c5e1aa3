// The node-opcua client against busbar-controller.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { join } from "node:path";
import { after, before, test } from "node:test";
import opcua from "./opcua.mjs";
import { anonymous, createClient, modes, named, withSession } from "./client.mjs";
import { openHouse, startController, user } from "./controller.mjs";
import { crawl } from "./crawl.mjs";
import { startProxy } from "./proxy.mjs";

const { AttributeIds, BrowseDirection, DataType, NodeId, StatusCodes, VariantArrayType } = opcua;

let controller;
let namespaceIndex;

before(async () => {
  controller = await startController({ ...openHouse, bulk: 25_000 });
  await withSession(controller, modes.None, anonymous, async (session) => {
    const namespaces = await session.readNamespaceArray();
    namespaceIndex = namespaces.findIndex((uri) => /plc/i.test(uri));
    assert.ok(namespaceIndex > 0, `no namespace of the PLC among ${namespaces}`);
  });
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

const id = (name) => `ns=${namespaceIndex};s=${name}`;
const valueOf = (name) => ({ nodeId: id(name), attributeId: AttributeIds.Value });
const write = (session, name, dataType, value, more = {}) =>
  session.write({
    nodeId: id(name), attributeId: AttributeIds.Value, value: { value: { dataType, value, ...more } },
  });

for (const [mode, options] of Object.entries(modes)) {
  for (const [kind, identity] of [["anonymous", anonymous], ["user name", named(user)]]) {
    test(`${mode}, ${kind}: reads and writes`, () =>
      withSession(controller, options, identity, async (session) => {
        assert.equal(await write(session, "Level", DataType.Double, 42.5), StatusCodes.Good);
        const level = await session.read(valueOf("Level"));
        assert.equal(level.value.value, 42.5);
        assert.equal(level.statusCode, StatusCodes.Good);
        assert.ok(level.sourceTimestamp);
        const first = (await session.read(valueOf("Counter"))).value.value;
        let next = first;
        for (let i = 0; i < 200 && next === first; ++i) next = (await session.read(valueOf("Counter"))).value.value;
        assert.notEqual(next, first, "the PLC runs");
      }));
  }
}

test("a wrong password is refused", async () => {
  const attempt = withSession(controller, modes.SignAndEncrypt, named({ ...user, password: "wrong" }), async () => {});
  await assert.rejects(attempt, /BadIdentityTokenRejected|BadUserAccessDenied/);
});

test("wrong types, read-only and unknown nodes are refused with the right code", () =>
  withSession(controller, modes.SignAndEncrypt, named(user), async (session) => {
    assert.equal(await write(session, "Level", DataType.String, "no"), StatusCodes.BadTypeMismatch);
    assert.equal(await write(session, "Recipe", DataType.Int16, 1), StatusCodes.BadTypeMismatch);
    assert.equal(await write(session, "Serial", DataType.String, "no"), StatusCodes.BadNotWritable);
    assert.equal(await write(session, "Nothing", DataType.Double, 1), StatusCodes.BadNodeIdUnknown);
    assert.equal((await session.read(valueOf("Nothing"))).statusCode, StatusCodes.BadNodeIdUnknown);
  }));

test("arrays are written whole and read in part", () =>
  withSession(controller, modes.Sign, anonymous, async (session) => {
    const array = { arrayType: VariantArrayType.Array };
    const values = Int16Array.from([1, 2, 3, 4, 5, 6, 7, 8]);
    assert.equal(await write(session, "Recipe", DataType.Int16, values, array), StatusCodes.Good);
    const part = await session.read({ ...valueOf("Recipe"), indexRange: new opcua.NumericRange("2:4") });
    assert.deepEqual([...part.value.value], [3, 4, 5]);
    const beyond = await session.read({ ...valueOf("Recipe"), indexRange: new opcua.NumericRange("8") });
    assert.equal(beyond.statusCode, StatusCodes.BadIndexRangeNoData);
  }));

test("registered Variables are read, written and browsed by their aliases", () =>
  withSession(controller, modes.SignAndEncrypt, named(user), async (session) => {
    const names = ["Level", "Counter", "Nothing"];
    const aliases = await session.registerNodes(names.map(id));
    assert.equal(aliases.length, names.length);
    const known = aliases.map((alias, i) => alias.toString() === NodeId.resolveNodeId(id(names[i])).toString());
    assert.deepEqual(known, [false, false, true], "what there is not stays as it is");
    const [level] = aliases;
    const status = await session.write({
      nodeId: level, attributeId: AttributeIds.Value, value: { value: { dataType: DataType.Double, value: 17.5 } },
    });
    assert.equal(status, StatusCodes.Good);
    const read = await session.read(aliases.map((nodeId) => ({ nodeId, attributeId: AttributeIds.Value })));
    assert.equal(read[0].value.value, 17.5);
    assert.deepEqual(read.map((each) => each.statusCode.isGood()), [true, true, false]);
    const browsed = await session.browse({ nodeId: level, browseDirection: BrowseDirection.Both, resultMask: 63 });
    assert.ok(browsed.references.length > 0);
    await session.unregisterNodes(aliases);
    const after = await session.read({ nodeId: level, attributeId: AttributeIds.Value });
    assert.equal(after.statusCode, StatusCodes.BadNodeIdUnknown);
    assert.equal((await session.read(valueOf("Level"))).value.value, 17.5);
  }));

/** Attributes every node of a class has (Part 3, 5). */
const mandatory = {
  Object: [AttributeIds.EventNotifier],
  Variable: [AttributeIds.DataType, AttributeIds.ValueRank, AttributeIds.AccessLevel, AttributeIds.UserAccessLevel, AttributeIds.Historizing],
  Method: [AttributeIds.Executable, AttributeIds.UserExecutable],
  ObjectType: [AttributeIds.IsAbstract],
  VariableType: [AttributeIds.IsAbstract, AttributeIds.DataType, AttributeIds.ValueRank],
  ReferenceType: [AttributeIds.IsAbstract, AttributeIds.Symmetric],
  DataType: [AttributeIds.IsAbstract],
};

test("everything from Root is browsed and every attribute of every node read", { timeout: 120_000 }, () =>
  withSession(controller, modes.None, anonymous, async (session) => {
    const nodes = await crawl(session, "i=84");
    assert.ok(nodes.size > 29_000, `only ${nodes.size} nodes`);
    const allowed = new Set([
      StatusCodes.Good, StatusCodes.BadAttributeIdInvalid, StatusCodes.BadNotReadable, StatusCodes.BadUserAccessDenied,
    ].map((code) => code.value));
    const check = (value, nodeId, attributeId, reference) => {
      const where = () => `${nodeId} ${AttributeIds[attributeId]} ${value.statusCode}`;
      const isMandatory = attributeId <= 4 ||
        (reference && mandatory[opcua.NodeClass[reference.nodeClass]]?.includes(attributeId));
      if (isMandatory && value.statusCode.value !== StatusCodes.Good.value) assert.fail(where());
      const isBadValue = attributeId === AttributeIds.Value;
      if (!isBadValue && !allowed.has(value.statusCode.value)) assert.fail(where());
    };
    const attributes = Array.from({ length: 27 }, (_, i) => i + 1);
    const waiting = [...nodes];
    let count = 0;
    const readPart = async () => {
      while (waiting.length !== 0) {
        const part = waiting.splice(-400);
        const values = await session.read(part.flatMap(([key]) => {
          const nodeId = opcua.resolveNodeId(key);
          return attributes.map((attributeId) => ({ nodeId, attributeId }));
        }));
        part.forEach(([nodeId, reference], i) => attributes.forEach((attributeId, k) =>
          check(values[i * attributes.length + k], nodeId, attributeId, reference)));
        count += values.length;
      }
    };
    await Promise.all([readPart(), readPart()]); // the server answers one while the other is looked at
    assert.equal(count, nodes.size * attributes.length);
  }));

test("25,000 variables are read in one request", { timeout: 60_000 }, () =>
  withSession(controller, modes.SignAndEncrypt, named(user), async (session) => {
    const items = Array.from({ length: 25_000 }, (_, i) => valueOf(`Bulk${i}`));
    const values = await session.read(items);
    assert.equal(values.length, 25_000);
    assert.ok(values.every((value) => value.statusCode === StatusCodes.Good && value.value.dataType === DataType.Int16));
  }));

test("the channel is renewed while values are read", { timeout: 60_000 }, () =>
  withSession(
    controller, { ...modes.SignAndEncrypt, defaultSecureTokenLifetime: 1_000 }, named(user),
    async (session, client) => {
      let renewals = 0;
      client.on("security_token_renewed", () => ++renewals);
      while (renewals < 3) {
        const value = await session.read(valueOf("Level"));
        assert.equal(value.statusCode, StatusCodes.Good);
      }
    }));

test("a client comes back after its connection was cut", { timeout: 60_000 }, async () => {
  const proxy = await startProxy(controller.port);
  try {
    await withSession(
      controller, modes.SignAndEncrypt, named(user),
      async (session, client) => {
        assert.equal((await session.read(valueOf("Level"))).statusCode, StatusCodes.Good);
        const sessionId = session.sessionId.toString();
        const restored = new Promise((resolve) => session.once("session_restored", resolve));
        const back = new Promise((resolve) => client.once("connection_reestablished", resolve));
        proxy.cut();
        await Promise.all([back, restored]);
        assert.equal((await session.read(valueOf("Level"))).statusCode, StatusCodes.Good);
        assert.equal(session.sessionId.toString(), sessionId, "the session was kept");
      },
      `opc.tcp://localhost:${proxy.port}`);
  } finally {
    await proxy.stop();
  }
});

test("tshark decodes a captured session without a malformed packet", { timeout: 60_000 }, async (t) => {
  if (spawnSync("tshark", ["--version"]).error) {
    t.skip("tshark is not installed");
    return;
  }
  const proxy = await startProxy(controller.port);
  await withSession(
    controller, modes.None, anonymous,
    async (session) => {
      await session.browse({ nodeId: "i=2253", browseDirection: BrowseDirection.Both, resultMask: 63 });
      await session.read([valueOf("Counter"), valueOf("Serial"), valueOf("Recipe"), valueOf("Nothing")]);
      await session.read(Array.from({ length: 2_000 }, (_, i) => valueOf(`Bulk${i}`)));
      await write(session, "Level", DataType.Double, 7.5);
    },
    `opc.tcp://localhost:${proxy.port}`);
  const file = join(controller.folder, "session.pcap");
  await proxy.stop(file);
  const fields = ["-T", "fields", "-e", "opcua.transport.type", "-e", "_ws.malformed", "-e", "_ws.expert.message"];
  const { status, stdout, stderr } = spawnSync("tshark", ["-r", file, "-d", "tcp.port==4840,opcua", ...fields],
    { encoding: "utf8", maxBuffer: 1 << 28 });
  assert.equal(status, 0, stderr);
  const types = stdout.match(/\b(HEL|ACK|OPN|MSG|CLO)/g) ?? [];
  assert.deepEqual([...new Set(types)].sort(), ["ACK", "CLO", "HEL", "MSG", "OPN"]);
  assert.doesNotMatch(stdout, /malformed/i);
});

test("endpoints and the application description are found without a session", async () => {
  const client = await createClient(controller.folder, modes.None);
  await client.connect(controller.endpointUrl);
  try {
    const endpoints = await client.getEndpoints();
    const found = endpoints.map((e) => `${e.securityPolicyUri.split("#")[1]} ${opcua.MessageSecurityMode[e.securityMode]}`);
    assert.deepEqual(found.sort(), ["Basic256Sha256 Sign", "Basic256Sha256 SignAndEncrypt", "None None"]);
    const servers = await client.findServers();
    assert.equal(servers.length, 1);
    assert.equal(servers[0].applicationUri, endpoints[0].server.applicationUri);
  } finally {
    await client.disconnect();
  }
});

test("a NodeId of another namespace is unknown, not a crash", () =>
  withSession(controller, modes.None, anonymous, async (session) => {
    const strange = [new NodeId(NodeId.NodeIdType.STRING, "x".repeat(4000), 9), "g=00000000-0000-0000-0000-000000000001", "b=AA=="];
    for (const nodeId of strange) {
      const value = await session.read({ nodeId, attributeId: AttributeIds.Value });
      assert.equal(value.statusCode, StatusCodes.BadNodeIdUnknown);
    }
  }));
