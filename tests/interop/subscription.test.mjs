// Subscriptions and monitored items: the node-opcua client against busbar-controller.
import assert from "node:assert/strict";
import { once } from "node:events";
import { after, before, describe, test } from "node:test";
import { promisify } from "node:util";
import opcua from "./opcua.mjs";
import { anonymous, modes, named, withSession } from "./client.mjs";
import { openHouse, startController, user } from "./controller.mjs";
import { startProxy } from "./proxy.mjs";

const { AttributeIds, ClientSubscription, DataType, MonitoringMode, StatusCodes, TimestampsToReturn } = opcua;

let controller;
let namespaceIndex;

before(async () => {
  controller = await startController({ ...openHouse, bulk: 25_000 });
  await withSession(controller, modes.None, anonymous, async (session) => {
    const namespaces = await session.readNamespaceArray();
    namespaceIndex = namespaces.findIndex((uri) => /plc/i.test(uri));
  });
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

const id = (name) => `ns=${namespaceIndex};s=${name}`;
const valueOf = (name) => ({ nodeId: id(name), attributeId: AttributeIds.Value });
const write = (session, name, dataType, value) =>
  session.write({ nodeId: id(name), attributeId: AttributeIds.Value, value: { value: { dataType, value } } });
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

const usual = {
  requestedPublishingInterval: 100, requestedLifetimeCount: 100, requestedMaxKeepAliveCount: 5,
  maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1,
};

/** Runs `action` with a subscription that goes afterwards. */
const withSubscription = (options, action, security = modes.SignAndEncrypt, endpointUrl) =>
  withSession(controller, security, named(user), async (session, client) => {
    const subscription = await session.createSubscription2({ ...usual, ...options });
    try {
      return await action(subscription, session, client);
    } finally {
      await subscription.terminate();
    }
  }, endpointUrl);

/** Monitors a variable; what comes is collected in `values`. */
async function monitor(subscription, name, parameters = {}, mode = MonitoringMode.Reporting) {
  const item = await subscription.monitor(
    valueOf(name), { samplingInterval: 50, queueSize: 10, discardOldest: true, ...parameters },
    TimestampsToReturn.Both, mode);
  const values = [];
  item.on("changed", (dataValue) => values.push(dataValue));
  item.values = values;
  return item;
}

/** Waits until `condition` holds. */
async function until(condition, what, limit = 10_000) {
  const end = Date.now() + limit;
  while (!condition()) {
    assert.ok(Date.now() < end, `in vain waited for ${what}`);
    await sleep(10);
  }
}

/** The services by hand, without node-opcua's publishing engine. */
const services = (session) => Object.fromEntries(
  ["createSubscription", "deleteSubscriptions", "createMonitoredItems", "publish", "republish", "transferSubscriptions"]
    .map((name) => [name, promisify(session[name].bind(session))]));

async function subscribeByHand(session, options = {}) {
  const service = services(session);
  const { subscriptionId } = await service.createSubscription({ ...usual, ...options });
  await service.createMonitoredItems({
    subscriptionId, timestampsToReturn: TimestampsToReturn.Both,
    itemsToCreate: [{
      itemToMonitor: valueOf("Counter"), monitoringMode: MonitoringMode.Reporting,
      requestedParameters: { clientHandle: 7, samplingInterval: 0, queueSize: 100, discardOldest: true },
    }],
  });
  return { service, subscriptionId };
}

const numbersOf = (response) =>
  response.notificationMessage.notificationData.flatMap((data) => data.monitoredItems.map((m) => m.value.value.value));

// They wait most of the time, and do so together: each has a session of its own.
describe("subscriptions", { concurrency: true }, () => {
  for (const [mode, security] of Object.entries(modes)) {
    test(`${mode}: data changes at 200 ms`, () =>
      withSubscription({ requestedPublishingInterval: 200 }, async (subscription) => {
        const item = await monitor(subscription, "Counter", { samplingInterval: 200, queueSize: 1 });
        await until(() => item.values.length >= 5, "five values");
        const numbers = item.values.map((v) => v.value.value);
        assert.ok(numbers.every((n, i) => i === 0 || n > numbers[i - 1]), `growing: ${numbers}`);
        assert.ok(item.values.every((v) => v.statusCode === StatusCodes.Good && v.sourceTimestamp));
      }, security));
  }

  // These write the same variable, one after the other.
  describe("of a variable that clients write", { concurrency: 1 }, () => {
    describe("data change filters", () => {
      const filter = (deadbandType, deadbandValue, trigger = opcua.DataChangeTrigger.StatusValue) =>
        new opcua.DataChangeFilter({ deadbandType, deadbandValue, trigger });

      test("an absolute deadband holds small changes back", () =>
        withSubscription({}, async (subscription, session) => {
          await write(session, "Level", DataType.Double, 10);
          const item = await monitor(subscription, "Level", { filter: filter(opcua.DeadbandType.Absolute, 1) });
          await until(() => item.values.length === 1, "the first value");
          for (const value of [10.5, 11, 11.01, 12.5]) {
            await write(session, "Level", DataType.Double, value);
            await sleep(150);
          }
          await until(() => item.values.length === 3, "two changes");
          assert.deepEqual(item.values.map((v) => v.value.value), [10, 11.01, 12.5]);
        }));

      test("a percent deadband needs an EURange", () =>
        withSubscription({}, async (subscription, session) => {
          const results = await promisify(session.createMonitoredItems.bind(session))({
            subscriptionId: subscription.subscriptionId, timestampsToReturn: TimestampsToReturn.Both,
            itemsToCreate: [{
              itemToMonitor: valueOf("Level"), monitoringMode: MonitoringMode.Reporting,
              requestedParameters: { clientHandle: 1, samplingInterval: 100, queueSize: 1, filter: filter(opcua.DeadbandType.Percent, 10) },
            }],
          });
          assert.notEqual(results.results[0].statusCode, StatusCodes.Good);
        }));
    });

    test("a triggering item brings the queues of those it is linked to", () =>
      withSubscription({}, async (subscription, session) => {
        await write(session, "Level", DataType.Double, 1);
        const linked = await monitor(subscription, "Counter", {}, MonitoringMode.Sampling);
        const trigger = await monitor(subscription, "Level");
        const set = await promisify(session.setTriggering.bind(session))({
          subscriptionId: subscription.subscriptionId, triggeringItemId: trigger.monitoredItemId,
          linksToAdd: [linked.monitoredItemId], linksToRemove: [],
        });
        assert.deepEqual(set.addResults, [StatusCodes.Good]);
        await until(() => trigger.values.length === 1, "the trigger's first value");
        await sleep(300);
        const before = linked.values.length;
        await sleep(400);
        assert.equal(linked.values.length, before, "without a trigger nothing comes");
        await write(session, "Level", DataType.Double, 2);
        await until(() => linked.values.length > before, "the linked item's values");
      }));
  });

  test("every scan is seen by a queue that is long enough", () =>
    withSubscription({ requestedPublishingInterval: 200 }, async (subscription) => {
      const item = await monitor(subscription, "Counter", { samplingInterval: 0, queueSize: 50 });
      await until(() => item.values.length >= 60, "sixty values");
      const numbers = item.values.map((v) => v.value.value);
      assert.ok(numbers.every((n, i) => i === 0 || n === numbers[i - 1] + 1), `no scan left out: ${numbers}`);
    }));

  test("a lost response is published again until it is acknowledged", () =>
    withSession(controller, modes.SignAndEncrypt, named(user), async (session) => {
      const { service, subscriptionId } = await subscribeByHand(session);
      const first = await service.publish({ subscriptionAcknowledgements: [] });
      const { sequenceNumber } = first.notificationMessage;
      const again = await service.republish({ subscriptionId, retransmitSequenceNumber: sequenceNumber });
      assert.deepEqual(numbersOf(again), numbersOf(first));
      const second = await service.publish({ subscriptionAcknowledgements: [{ subscriptionId, sequenceNumber }] });
      assert.deepEqual(second.results, [StatusCodes.Good]);
      assert.ok(!second.availableSequenceNumbers.includes(sequenceNumber));
      await assert.rejects(service.republish({ subscriptionId, retransmitSequenceNumber: sequenceNumber }), /BadMessageNotAvailable/);
      await service.deleteSubscriptions({ subscriptionIds: [subscriptionId] });
    }));

  test("a subscription is transferred to another session after a cut", { timeout: 60_000 }, async () => {
    const proxy = await startProxy(controller.port);
    let subscriptionId;
    const lost = withSession(
      controller, { ...modes.SignAndEncrypt, connectionStrategy: { maxRetry: 0, initialDelay: 10, maxDelay: 10 } }, named(user),
      async (session, client) => {
        const made = await subscribeByHand(session, { requestedLifetimeCount: 1000 });
        subscriptionId = made.subscriptionId;
        await made.service.publish({ subscriptionAcknowledgements: [] });
        const gone = once(client, "close");
        await proxy.stop();
        await gone;
      }, `opc.tcp://localhost:${proxy.port}`).catch(() => {});
    await lost;
    await withSession(controller, modes.SignAndEncrypt, named(user), async (session) => {
      const service = services(session);
      const moved = await service.transferSubscriptions({ subscriptionIds: [subscriptionId], sendInitialValues: true });
      assert.equal(moved.results[0].statusCode, StatusCodes.Good);
      assert.ok(moved.results[0].availableSequenceNumbers.length > 0, "what was not acknowledged is still there");
      const next = await service.publish({ subscriptionAcknowledgements: [] });
      assert.equal(next.subscriptionId, subscriptionId);
      assert.ok(numbersOf(next).length > 0);
      await service.deleteSubscriptions({ subscriptionIds: [subscriptionId] });
    });
  });

  test("without changes keep-alives come", () =>
    withSubscription({ requestedPublishingInterval: 100, requestedMaxKeepAliveCount: 3 }, async (subscription) => {
      let count = 0;
      subscription.on("keepalive", () => ++count);
      await until(() => count >= 3, "three keep-alives");
    }));

  test("a subscription that nobody asks for ends after its lifetime", { timeout: 30_000 }, () =>
    withSession(controller, modes.SignAndEncrypt, named(user), async (session) => {
      const { service, subscriptionId } = await subscribeByHand(session, {
        requestedPublishingInterval: 100, requestedLifetimeCount: 15, requestedMaxKeepAliveCount: 5,
      });
      await sleep(4000);
      const last = await service.publish({ subscriptionAcknowledgements: [] });
      const [change] = last.notificationMessage.notificationData;
      assert.equal(change?.status, StatusCodes.BadTimeout, "a StatusChangeNotification says so");
      const deleted = await service.deleteSubscriptions({ subscriptionIds: [subscriptionId] });
      assert.deepEqual(deleted.results, [StatusCodes.BadSubscriptionIdInvalid]);
    }));
});

// By itself: where node-opcua had little processor time, values have come twice after the cut.
test("a connection that is cut loses no value", { timeout: 60_000 }, async () => {
  const proxy = await startProxy(controller.port);
  try {
    await withSubscription({ requestedPublishingInterval: 100 }, async (subscription, session, client) => {
      const item = await monitor(subscription, "Counter", { samplingInterval: 0, queueSize: 1000 });
      await until(() => item.values.length >= 20, "twenty values");
      const back = once(client, "connection_reestablished");
      const restored = once(session, "session_restored");
      proxy.cut();
      await Promise.all([back, restored]);
      const count = item.values.length;
      await until(() => item.values.length >= count + 100, "a hundred more");
      const numbers = item.values.map((v) => v.value.value);
      assert.ok(numbers.every((n, i) => i === 0 || n === numbers[i - 1] + 1), `no scan left out: ${numbers}`);
    }, modes.SignAndEncrypt, `opc.tcp://localhost:${proxy.port}`);
  } finally {
    await proxy.stop();
  }
});

test("10,000 items in one subscription", { timeout: 60_000 }, () =>
  withSubscription({ requestedPublishingInterval: 200 }, async (subscription) => {
    const items = Array.from({ length: 10_000 }, (_, i) => valueOf(`Bulk${i}`));
    const group = await subscription.monitorItems(items, { samplingInterval: 200, queueSize: 1, discardOldest: true },
      TimestampsToReturn.Both);
    const seen = new Set();
    group.on("changed", (_item, _value, index) => seen.add(index));
    await until(() => seen.size === items.length, "the first value of each", 30_000);
  }));
