// What the server tells of itself is so: node-opcua's client against busbar-controller.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import opcua from "./opcua.mjs";
import { anonymous, modes, named, withSession } from "./client.mjs";
import { openHouse, startController, user } from "./controller.mjs";
import { crawl } from "./crawl.mjs";

const { AttributeIds, BrowseDirection, DataType, NodeClass, StatusCodes, TimestampsToReturn } = opcua;

const admin = { userName: "admin", password: "another pass phrase", roles: ["ConfigureAdmin", "SecurityAdmin"] };
const enabledFlag = "i=2294";
const securityOfSessions = "i=3708";
let controller;

before(async () => {
  controller = await startController({
    ...openHouse, users: 'anonymous = "read"', accounts: [admin],
    nodesets: [fileURLToPath(new URL("truth.NodeSet2.xml", import.meta.url))],
  });
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

const as = (who, mode, action) => withSession(controller, modes[mode], who, action);
const valueOf = (nodeId) => ({ nodeId, attributeId: AttributeIds.Value });
const writeFlag = (session, flag) =>
  session.write({ ...valueOf(enabledFlag), value: { value: { dataType: DataType.Boolean, value: flag } } });

// The Object that has the Method.
const ownerOf = async (session, methodId) =>
  (await session.browse({ nodeId: methodId, browseDirection: BrowseDirection.Inverse, referenceTypeId: "HasComponent" }))
    .references[0].nodeId;

test("below Objects no value is null and no Method is dead", { timeout: 60_000 }, () =>
  as(named(admin), "SignAndEncrypt", async (session) => {
    const nodes = [...(await crawl(session, "i=85"))].filter(([nodeId]) => nodeId.startsWith("ns=0") || /^i=/.test(nodeId));
    const of = (nodeClass) => nodes.filter(([, reference]) => reference?.nodeClass === nodeClass).map(([nodeId]) => nodeId);
    const variables = of(NodeClass.Variable);
    assert.ok(variables.length > 60, `${variables.length} Variables`);
    (await session.read(variables.map(valueOf))).forEach((value, i) => {
      const isNull = value.statusCode === StatusCodes.Good && value.value.dataType === DataType.Null;
      assert.ok(!isNull, `${variables[i]} is Good with null`);
    });
    for (const methodId of of(NodeClass.Method)) {
      const result = await session.call({ objectId: await ownerOf(session, methodId), methodId, inputArguments: [] });
      assert.equal(result.statusCode, StatusCodes.BadArgumentsMissing, methodId);
    }
  }));

test("settings of security are an administrator's", async () => {
  await as(anonymous, "None", async (session) =>
    assert.equal(await writeFlag(session, false), StatusCodes.BadUserAccessDenied));
  await as(named(user), "SignAndEncrypt", async (session) => {
    assert.equal(await writeFlag(session, false), StatusCodes.BadUserAccessDenied);
    const role = { nodeId: "i=15428", attributeId: AttributeIds.Value, value: { value: { dataType: DataType.Boolean, value: true } } };
    assert.notEqual(await session.write(role), StatusCodes.Good, "a role's ApplicationsExclude");
    assert.equal((await session.read(valueOf(securityOfSessions))).statusCode, StatusCodes.BadNodeIdUnknown);
  });
  await as(named(admin), "Sign", async (session) =>
    assert.equal((await session.read(valueOf(securityOfSessions))).statusCode, StatusCodes.BadSecurityModeInsufficient));
  await as(named(admin), "SignAndEncrypt", async (session) => {
    assert.equal(await writeFlag(session, true), StatusCodes.Good);
    const sessions = (await session.read(valueOf(securityOfSessions))).value.value;
    assert.equal(sessions.length, 1);
    assert.equal(sessions[0].clientUserIdOfSession, admin.userName);
    assert.deepEqual([...sessions[0].clientUserIdHistory], [admin.userName]);
  });
});

test("a percent deadband goes by the EURange of a file, and the file's version is told", { timeout: 30_000 }, () =>
  as(named(user), "SignAndEncrypt", async (session) => {
    const ns = (await session.readNamespaceArray()).indexOf("urn:busbar:test:truth");
    const level = `ns=${ns};s=Level`;
    const write = (value) => session.write({ ...valueOf(level), value: { value: { dataType: DataType.Double, value } } });
    const subscription = await session.createSubscription2({
      requestedPublishingInterval: 50, requestedLifetimeCount: 100, requestedMaxKeepAliveCount: 5, publishingEnabled: true,
    });
    const filter = new opcua.DataChangeFilter({
      trigger: opcua.DataChangeTrigger.StatusValue, deadbandType: opcua.DeadbandType.Percent, deadbandValue: 10,
    });
    const item = await subscription.monitor(
      valueOf(level), { samplingInterval: 20, queueSize: 10, discardOldest: true, filter }, TimestampsToReturn.Both);
    assert.equal(item.statusCode, StatusCodes.Good);
    const values = [];
    item.on("changed", (change) => values.push(change.value.value));
    const until = async (count) => {
      for (let i = 0; i < 200 && values.length < count; ++i) await new Promise((resolve) => setTimeout(resolve, 20));
    };
    await until(1);
    assert.equal(await write(15), StatusCodes.Good); // of 0 to 200: 20 are 10 %
    assert.equal(await write(31), StatusCodes.Good);
    await until(2);
    await subscription.terminate();
    assert.deepEqual(values, [0, 31]);
    const read = await session.read(valueOf(level));
    assert.ok(read.sourceTimestamp, "what was written has a time");

    const metadata = [...(await crawl(session, "i=11715"))];
    const version = metadata.filter(([, reference]) => reference?.browseName.name === "NamespaceVersion");
    const versions = await session.read(version.map(([nodeId]) => valueOf(nodeId)));
    assert.ok(versions.some((each) => each.value.value === "2.5"), "of the file's Model");
  }));

test("a continuation point outlasts sessions that come and go", { timeout: 60_000 }, () =>
  as(anonymous, "None", async (session) => {
    session.requestedMaxReferencesPerNode = 1;
    const first = (await session.browse([{ nodeId: "i=2253", browseDirection: 0, resultMask: 63 }]))[0];
    assert.ok(first.continuationPoint?.length, "there is more");
    for (let i = 0; i < 50; ++i) await as(anonymous, "None", async () => {});
    const rest = await session.browseNext(first.continuationPoint, false);
    assert.equal(rest.statusCode, StatusCodes.Good);
    assert.equal(rest.references.length, 1);
  }));
