// A machine that publishes the variables of its program: the node-opcua client against busbar-controller.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import opcua from "./opcua.mjs";
import { anonymous, modes, named, withSession } from "./client.mjs";
import { openHouse, startController, user } from "./controller.mjs";

const { AttributeIds, DataType, StatusCodes, TimestampsToReturn } = opcua;

/** So many variables of a single value each. */
function scalars(count) {
  const lines = [...Array(count).keys()].map((i) => `V${String(i).padStart(5, "0")} : INT;`);
  return `{attribute 'publish' := 'input'}\nVAR_GLOBAL\n${lines.join("\n")}\nEND_VAR\n`;
}

/** So many variables of all kinds. */
function declarations(count) {
  const kinds = [
    (name) => `${name} : INT := 7;`,
    (name) => `${name} : LREAL;`,
    (name) => `${name} : Mode := Automatic;`,
    (name) => `${name} : STRING[16] := 'cover';`,
  ];
  const lines = [];
  for (let i = 0; i < count - 13; ++i) {
    lines.push(kinds[i % kinds.length](`V${String(i).padStart(5, "0")}`));
  }
  return `
TYPE
  Mode : (Idle, SetUp, Automatic);
  Point : STRUCT X : REAL := 1.5; Y : REAL := 2.5; END_STRUCT;
  Axis : STRUCT Place : Point; Name : STRING[8] := 'A'; Steps : ARRAY [0..2] OF INT := [1, 2, 3]; State : Mode; END_STRUCT;
END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
  ${lines.join("\n  ")}
  A_Axis : Axis;
  A_Axes : ARRAY [0..3] OF Axis;
  ${[...Array(9).keys()].map((i) => `A_Row${i} : ARRAY [0..1] OF INT := [${i}, 1];`).join("\n  ")}
  A_Count : DINT;
END_VAR
{attribute 'publish' := 'publish only'}
VAR_GLOBAL CONSTANT A_Fixed : INT := 5; END_VAR
VAR_GLOBAL Hidden : INT; END_VAR
`;
}

const programs = `
[[plc.program]]
kind = "increment"
target = "A_Count"
[[plc.program]]
kind = "increment"
target = "A_Axis.Place.X"
`;

let controller;
let namespaceIndex;

async function start(machine) {
  controller = await startController({ ...openHouse, machine, args: ["--preset", "nj501"] });
  await withSession(controller, modes.None, anonymous, async (session) => {
    namespaceIndex = (await session.readNamespaceArray()).indexOf("urn:busbar:machine");
  });
}

const id = (name) => `ns=${namespaceIndex};s=${name}`;
const valueOf = (name) => ({ nodeId: id(name), attributeId: AttributeIds.Value });
const secured = (action) => withSession(controller, modes.SignAndEncrypt, named(user), action);

async function readAll(session, nodes) {
  const values = [];
  const atOnce = 1000;
  for (let i = 0; i < nodes.length; i += atOnce) values.push(...await session.read(nodes.slice(i, i + atOnce)));
  return values;
}

async function browseAll(session, nodeId) {
  let result = await session.browse({ nodeId, browseDirection: 0, includeSubtypes: true, nodeClassMask: 2, resultMask: 63 });
  const references = [...result.references];
  while (result.continuationPoint) {
    result = await session.browseNext(result.continuationPoint, false);
    references.push(...result.references);
  }
  return references.filter((each) => each.nodeId.namespace === namespaceIndex);
}

function log() {
  const file = join(controller.folder, "medium/packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog.log");
  return existsSync(file) ? readFileSync(file, "utf8") : "";
}
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

describe("10,000 published variables (6-2-2)", () => {
  // Values count, too: an Axis has seven, a row two. Fewer variables keep all of them below both limits.
  before(async () => { await start({ declarations: declarations(9950), programs }); });
  after(async () => { assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM"); });

  test("are found and read, whatever their types", () => secured(async (session) => {
    const variables = (await browseAll(session, id("Controller/GlobalVars")))
      .filter((each) => each.browseName.name !== "NodeVersion");
    assert.equal(variables.length, 9950);
    const values = await readAll(session, variables.map((each) => ({ nodeId: each.nodeId, attributeId: AttributeIds.Value })));
    assert.ok(values.every((each) => each.statusCode.equals(StatusCodes.Good)));
    assert.ok(!variables.some((each) => each.browseName.name === "Hidden"));
  }));

  test("structures and arrays of them are read whole, of one scan", () => secured(async (session) => {
    const axis = await session.read(valueOf("A_Axis"));
    assert.ok(axis.statusCode.equals(StatusCodes.Good), axis.statusCode.toString());
    await session.extractNamespaceDataType();
    const [one, all] = await session.read([valueOf("A_Axis"), valueOf("A_Axes")]);
    assert.equal(one.value.value.name ?? one.value.value.Name, "A");
    assert.deepEqual([...(one.value.value.steps ?? one.value.value.Steps)], [1, 2, 3]);
    assert.equal(all.value.value.length, 4);
  }));

  test("a structure is written whole, and a constant not at all (6-2-2)", () => secured(async (session) => {
    await session.extractNamespaceDataType();
    const axes = await session.read(valueOf("A_Axes"));
    axes.value.value[1].name = "B7";
    const done = await session.write({ ...valueOf("A_Axes"), value: { value: axes.value } });
    assert.ok(done.equals(StatusCodes.Good), done.toString());
    const again = await session.read(valueOf("A_Axes"));
    assert.deepEqual(again.value.value.map((each) => each.name), ["A", "B7", "A", "A"]);
    const refused = await session.write({ ...valueOf("A_Fixed"), value: { value: { dataType: DataType.Int16, value: 6 } } });
    assert.ok(refused.equals(StatusCodes.BadNotWritable), refused.toString());
  }));

  test("are monitored, structures too", () => secured(async (session) => {
    const subscription = await session.createSubscription2({
      requestedPublishingInterval: 100, requestedLifetimeCount: 100, requestedMaxKeepAliveCount: 5,
      maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1 });
    let changes = 0;
    const item = await subscription.monitor(valueOf("A_Axis"),
      { samplingInterval: 100, queueSize: 10, discardOldest: true }, TimestampsToReturn.Both);
    item.on("changed", () => { ++changes; });
    for (let i = 0; i < 100 && changes < 5; ++i) await sleep(50);
    assert.ok(changes >= 5, `${changes} changes`);
    await subscription.terminate();
  }));

  test("the state of the controller is shown (6-2-1)", () => secured(async (session) => {
    const state = (name) => valueOf(`Controller/DeviceState/${name}`);
    const [mode, error, bits, count] = await session.read(
      ["Mode", "ErrorState", "UnpublishedVariablesStatus", "NumberOfPublishedVariables"].map(state));
    assert.equal(mode.value.value, "RUN");
    assert.equal(error.value.value, "NoError");
    assert.equal(bits.value.value, 0);
    assert.equal(count.value.value, 9950);
  }));
});

describe("10,001 variables (6-2-2)", () => {
  before(async () => { await start({ declarations: scalars(10001) }); });
  after(async () => { assert.equal(await controller.stop(), 0); });

  test("bit 0 is set, and the last one is left out", () => secured(async (session) => {
    const [bits, count, last, out] = await session.read([
      valueOf("Controller/DeviceState/UnpublishedVariablesStatus"),
      valueOf("Controller/DeviceState/NumberOfPublishedVariables"), valueOf("V09999"), valueOf("V10000")]);
    assert.equal(bits.value.value, 1);
    assert.equal(count.value.value, 10000);
    assert.ok(last.statusCode.equals(StatusCodes.Good));
    assert.ok(out.statusCode.equals(StatusCodes.BadNodeIdUnknown), out.statusCode.toString());
  }));

  test("both logs say so (7-1-6, 9-2-2)", async () => {
    const events = join(controller.folder, "state/events/events.log");
    // It has other events before.
    const told = () => (existsSync(events) ? readFileSync(events, "utf8") : "");
    for (let i = 0; i < 100 && !(/\t35D30000\t/.test(told()) && /\t0005\tRun/.test(log())); ++i) await sleep(100);
    const text = log();
    assert.match(text, /\tSERVER\t0100\tMaxVariables\tMaxVariables\r\n/);
    assert.match(text, /\tSERVER\t0110\tNumOfVariables\tVariables=10000, Values=10000, DataTypes=0\r\n/);
    assert.ok(text.split("\r\n").every((line) => Buffer.byteLength(line) <= 254));
    assert.match(told(), /\t35D30000\t/);
  });
});

describe("the 10,001st variable is added online (4-2-5)", () => {
  before(async () => { await start({ declarations: scalars(10000) }); });
  after(async () => { assert.equal(await controller.stop(), 0); });

  test("a client sees the event and the bit (6-2-2, 9-2-2)", () => secured(async (session) => {
    const subscription = await session.createSubscription2({
      requestedPublishingInterval: 100, requestedLifetimeCount: 100, requestedMaxKeepAliveCount: 5,
      maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1 });
    const heard = [];
    const events = await subscription.monitor(
      { nodeId: opcua.resolveNodeId("Server"), attributeId: AttributeIds.EventNotifier },
      { samplingInterval: 0, queueSize: 100, discardOldest: true,
        filter: opcua.constructEventFilter(["Message", "Severity", "SourceName"]) }, TimestampsToReturn.Both);
    events.on("changed", (fields) => { heard.push(fields.map((each) => each.value)); });
    const status = valueOf("Controller/DeviceState/UnpublishedVariablesStatus");
    assert.equal((await session.read(status)).value.value, 0);

    controller.edit(scalars(10001));
    const unpublished = () => heard.find(([message]) => message?.text?.startsWith("35D30000"));
    for (let i = 0; i < 200 && !unpublished(); ++i) await sleep(50);
    assert.ok(unpublished(), controller.output());
    assert.equal((await session.read(status)).value.value, 1);
    const record = /\tSERVER\t0100\tMaxVariables\tMaxVariables\r\n/;
    for (let i = 0; i < 100 && !record.test(log()); ++i) await sleep(100);
    assert.match(log(), record);
    await subscription.terminate();
  }));
});
