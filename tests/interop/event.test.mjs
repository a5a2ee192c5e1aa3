// Events: the node-opcua client filters what happens in busbar-controller.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import opcua from "./opcua.mjs";
import { modes, named, withSession } from "./client.mjs";
import { startController, user } from "./controller.mjs";

const {
  AttributeIds, ContentFilter, DataType, ElementOperand, EventFilter, FilterOperator, LiteralOperand,
  MonitoringMode, SimpleAttributeOperand, StatusCodes, TimestampsToReturn, resolveNodeId,
} = opcua;

let controller;
let namespaceIndex;
let heard; // by each listener

before(async () => {
  controller = await startController();
  await withSession(controller, modes.None, named(user), async (session) => {
    const namespaces = await session.readNamespaceArray();
    namespaceIndex = namespaces.findIndex((uri) => /plc/i.test(uri));
  });
  heard = await hear();
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

const id = (name) => `ns=${namespaceIndex};s=${name}`;
const server = "ns=0;i=2253";
const fieldNames = ["EventId", "EventType", "SourceNode", "SourceName", "Time", "Message", "Severity"];
const field = (name) => new SimpleAttributeOperand({
  typeDefinitionId: "ns=0;i=2041", browsePath: [{ name }], attributeId: AttributeIds.Value,
});
const literal = (dataType, value) => new LiteralOperand({ value: { dataType, value } });
const element = (filterOperator, ...filterOperands) => ({ filterOperator, filterOperands });
const index = (number) => new ElementOperand({ index: number });

const write = (session, name, dataType, value) =>
  session.write({ nodeId: id(name), attributeId: AttributeIds.Value, value: { value: { dataType, value } } });
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** The machine goes through all of its events, each in a scan of its own. */
async function makeThingsHappen(session) {
  for (const [name, dataType, value] of [
    ["Temperature", DataType.Float, 20], ["Door", DataType.Boolean, false],
    ["Temperature", DataType.Float, 100], ["Door", DataType.Boolean, true],
    ["Temperature", DataType.Float, 130],
  ]) {
    assert.equal(await write(session, name, dataType, value), StatusCodes.Good);
    await sleep(50);
  }
}

/** Collects in `events` what an item at `notifier` is told from now on. */
async function listen(session, { notifier, where }) {
  const subscription = await session.createSubscription2({
    requestedPublishingInterval: 100, requestedLifetimeCount: 100, requestedMaxKeepAliveCount: 5,
    maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1,
  });
  const filter = new EventFilter({
    selectClauses: fieldNames.map(field), whereClause: new ContentFilter({ elements: where }),
  });
  const item = await subscription.monitor(
    { nodeId: notifier, attributeId: AttributeIds.EventNotifier },
    { samplingInterval: 0, queueSize: 100, discardOldest: true, filter },
    TimestampsToReturn.Neither, MonitoringMode.Reporting);
  assert.equal(item.statusCode ?? StatusCodes.Good, StatusCodes.Good);
  const events = [];
  item.on("changed", (values) =>
    events.push(Object.fromEntries(values.map((variant, i) => [fieldNames[i], variant.value]))));
  return { subscription, events };
}

const ofType = (type) => [element(FilterOperator.OfType, literal(DataType.NodeId, resolveNodeId(type)))];
const whatIsHeard = () => ({
  atServer: { notifier: server, where: [] },
  below: { notifier: id("PLC"), where: [] },
  severe: {
    notifier: server,
    where: [element(FilterOperator.GreaterThanOrEqual, field("Severity"), literal(DataType.UInt16, 500))],
  },
  chosen: {
    notifier: id("PLC"),
    where: [
      element(FilterOperator.And, index(1), index(2)),
      element(FilterOperator.Like, field("SourceName"), literal(DataType.String, "Temp%")),
      element(FilterOperator.Not, index(3)),
      element(FilterOperator.Between, field("Severity"), literal(DataType.UInt16, 300), literal(DataType.UInt16, 500)),
    ],
  },
  base: { notifier: server, where: ofType("i=2041") },
  system: { notifier: server, where: ofType("i=2130") },
});

/** What each of them is told while the machine goes through its events, once for all. */
const hear = () =>
  withSession(controller, modes.SignAndEncrypt, named(user), async (session) => {
    await write(session, "Temperature", DataType.Float, 20);
    await write(session, "Door", DataType.Boolean, false);
    await sleep(100);
    const listeners = [];
    for (const [name, what] of Object.entries(whatIsHeard())) listeners.push([name, await listen(session, what)]);
    await makeThingsHappen(session);
    await sleep(500);
    for (const [, { subscription }] of listeners) await subscription.terminate();
    return Object.fromEntries(listeners.map(([name, { events }]) => [name, events]));
  });

const messages = (events) => events.map((event) => event.Message.text);

test("all fields of events, at the Server object and below it", () => {
  for (const events of [heard.atServer, heard.below]) {
    assert.deepEqual(messages(events), ["Temperature is high", "The door was opened", "Temperature is dangerous"]);
    const [, door] = events;
    assert.equal(door.EventType.toString(), "ns=0;i=2041");
    assert.equal(door.SourceNode.toString(), id("Door"));
    assert.equal(door.SourceName, "Door");
    assert.equal(door.Severity, 600);
    assert.ok(Math.abs(Date.now() - door.Time.getTime()) < 60_000, `just now: ${door.Time}`);
    assert.equal(new Set(events.map((event) => event.EventId.toString("hex"))).size, 3, "each its EventId");
  }
});

test("a where clause lets pass what is severe", () =>
  assert.deepEqual(messages(heard.severe), ["The door was opened", "Temperature is dangerous"]));

test("a where clause of several elements", () =>
  assert.deepEqual(messages(heard.chosen), ["Temperature is dangerous"]));

test("a where clause by type", () => {
  assert.equal(heard.base.length, 3, "BaseEventType");
  assert.equal(heard.system.length, 0, "SystemEventType");
});
