// Methods: the node-opcua client against busbar-controller.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import opcua from "./opcua.mjs";
import { anonymous, modes, named, withSession } from "./client.mjs";
import { startController, user } from "./controller.mjs";

const { AttributeIds, DataType, MonitoringMode, StatusCodes, TimestampsToReturn, VariantArrayType } = opcua;

const server = "ns=0;i=2253";
const serverArray = "ns=0;i=2254"; // never changes
const getMonitoredItems = "ns=0;i=11492";
const resendData = "ns=0;i=12873";

let controller;
let folder;
let resetCounters;
let counter;

before(async () => {
  controller = await startController();
  await withSession(controller, modes.None, anonymous, async (session) => {
    const index = (await session.readNamespaceArray()).findIndex((uri) => /plc/i.test(uri));
    const id = (name) => `ns=${index};s=${name}`;
    [folder, resetCounters, counter] = ["PLC", "ResetCounters", "Counter"].map(id);
  });
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

const asUser = (action, security = modes.SignAndEncrypt) =>
  withSession(controller, security, named(user), action);
const uint32 = (value) => ({ dataType: DataType.UInt32, value });
const call = (session, objectId, methodId, inputArguments = []) =>
  session.call({ objectId, methodId, inputArguments });
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const valueOf = async (session, nodeId, attributeId = AttributeIds.Value) =>
  (await session.read({ nodeId, attributeId })).value.value;

/** Waits until `condition` holds. */
async function until(condition, what) {
  const end = Date.now() + 10_000;
  while (!condition()) {
    assert.ok(Date.now() < end, `in vain waited for ${what}`);
    await sleep(10);
  }
}

/** Runs `action` with a subscription of one variable and the values that come. */
const withItem = (nodeId, action, security) =>
  asUser(async (session) => {
    const subscription = await session.createSubscription2({
      requestedPublishingInterval: 100, requestedLifetimeCount: 100, requestedMaxKeepAliveCount: 5,
      maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1,
    });
    try {
      const item = await subscription.monitor(
        { nodeId, attributeId: AttributeIds.Value }, { samplingInterval: 20, queueSize: 100, discardOldest: true },
        TimestampsToReturn.Both, MonitoringMode.Reporting);
      const values = [];
      item.on("changed", (dataValue) => values.push(dataValue));
      await until(() => values.length > 0, "the first value");
      return await action(session, subscription, item, values);
    } finally {
      await subscription.terminate();
    }
  }, security);

describe("a method of the machine", () => {
  for (const [mode, security] of Object.entries(modes)) {
    test(`${mode}: is called and has its effect`, () =>
      withItem(counter, async (session, subscription, item, values) => {
        const result = await call(session, folder, resetCounters);
        assert.equal(result.statusCode, StatusCodes.Good);
        assert.deepEqual(result.outputArguments.map((v) => [v.dataType, v.value]), [[DataType.UInt32, 1]]);
        const began = () => values.some((v, i) => i > 0 && v.value.value < values[i - 1].value.value);
        await until(began, "the counter to begin again");
      }, security));
  }

  test("is described by its properties", () =>
    asUser(async (session) => {
      const { inputArguments, outputArguments } = await session.getArgumentDefinition(resetCounters);
      assert.deepEqual(inputArguments, []);
      assert.deepEqual(outputArguments.map((a) => [a.name, a.dataType.toString(), a.valueRank]), [["count", "ns=0;i=7", -1]]);
      assert.equal(await valueOf(session, resetCounters, AttributeIds.Executable), true);
      assert.equal(await valueOf(session, resetCounters, AttributeIds.UserExecutable), true);
    }));

  test("what cannot be called answers why", () =>
    asUser(async (session) => {
      const status = async (...args) => (await call(session, ...args)).statusCode;
      assert.equal(await status(folder, resetCounters, [uint32(1)]), StatusCodes.BadTooManyArguments);
      assert.equal(await status(server, resetCounters), StatusCodes.BadMethodInvalid);
      assert.equal(await status(folder, counter), StatusCodes.BadMethodInvalid);
      assert.equal(await status(counter, resetCounters), StatusCodes.BadNodeIdInvalid);
      assert.equal(await status("ns=1;s=nothing", resetCounters), StatusCodes.BadNodeIdUnknown);
    }));
});

describe("the methods of the Server object", () => {
  test("GetMonitoredItems gives the handles", () =>
    withItem(serverArray, async (session, subscription, item) => {
      const result = await session.getMonitoredItems(subscription.subscriptionId);
      assert.deepEqual([...result.serverHandles], [item.monitoredItemId]);
      assert.equal(result.clientHandles.length, 1);
      const raw = await call(session, server, getMonitoredItems, [uint32(subscription.subscriptionId)]);
      assert.ok(raw.outputArguments.every((v) => v.dataType === DataType.UInt32 && v.arrayType === VariantArrayType.Array));
    }));

  test("ResendData brings a value again that has not changed", () =>
    withItem(serverArray, async (session, subscription, item, values) => {
      await sleep(300);
      assert.equal(values.length, 1);
      const result = await call(session, server, resendData, [uint32(subscription.subscriptionId)]);
      assert.equal(result.statusCode, StatusCodes.Good);
      await until(() => values.length === 2, "the value again");
      assert.deepEqual(values[1].value, values[0].value);
    }));

  test("are only for the session that has the subscription, and check their argument", () =>
    withItem(serverArray, async (session, subscription) => {
      await asUser(async (other) => {
        for (const method of [getMonitoredItems, resendData]) {
          const status = async (...args) => (await call(other, server, method, args)).statusCode;
          assert.equal(await status(uint32(subscription.subscriptionId)), StatusCodes.BadUserAccessDenied);
          assert.equal(await status(uint32(4_000_000_000)), StatusCodes.BadSubscriptionIdInvalid);
          assert.equal(await status(), StatusCodes.BadArgumentsMissing);
          const wrong = await call(other, server, method, [{ dataType: DataType.String, value: "one" }]);
          assert.equal(wrong.statusCode, StatusCodes.BadInvalidArgument);
          assert.deepEqual(wrong.inputArgumentResults, [StatusCodes.BadTypeMismatch]);
        }
      });
    }));
});
