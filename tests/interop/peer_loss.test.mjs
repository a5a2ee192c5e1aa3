// busbar subscribe against a server of node-opcua that goes away, forgets, or has no subscriptions.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Busbar, makeFolder, removeFolder, startPeer } from "./peer.mjs";
import { startProxy } from "./proxy.mjs";

const counter = "nsu=urn:interop:machine;s=Counter";
const words = ["subscribe", counter, "--interval", "100", "--sampling", "0", "--queue", "1000", "--verbose"];

let folder;
let server;
let successor; // a promise of a server that may take its port
before(async () => {
  folder = await makeFolder();
  server = await startPeer({ folder });
  successor = startPeer({ folder, port: server.port, isLater: true });
});
after(async () => {
  await Promise.all([server?.kill(), successor?.then((next) => next.kill())]);
  removeFolder(folder);
});

const busbarFor = (server) => new Busbar(server, join(folder, "pki"), ["--trust"]);
const valuesOf = (lines) => lines.filter(({ gap }) => !gap);
const gapsOf = (lines) => lines.filter(({ gap }) => gap).map(({ gap }) => gap);

/** No value twice or backwards, and none left out but where a gap was told. */
function checkCounter(lines) {
  const values = valuesOf(lines);
  for (let i = 1; i < values.length; ++i) {
    const [one, next] = [values[i - 1], values[i]];
    const isInGap = ({ from, to }) => from < next.sourceTimestamp && to > one.sourceTimestamp;
    assert.ok(next.value > one.value, `${next.value} after ${one.value}`);
    const around = JSON.stringify(values.slice(Math.max(i - 3, 0), i + 3));
    assert.ok(next.value === one.value + 1 || gapsOf(lines).some(isInGap),
      `${next.value} after ${one.value} in ${around}, gaps: ${JSON.stringify(gapsOf(lines))}`);
  }
}

/** Waits for ten more values, and until `condition` holds as well. */
async function goesOn(subscriber, condition = () => true) {
  const count = valuesOf(subscriber.lines).length + 10;
  await subscriber.until((lines) => valuesOf(lines).length >= count && condition(lines), "ten more values");
}

/** Runs `action` with a subscriber that has its first values; what it wrote in all. */
async function follow(server, action) {
  const subscriber = busbarFor(server).start(words);
  try {
    await goesOn(subscriber);
    await action(subscriber);
    assert.equal(await subscriber.kill("SIGINT"), 130, subscriber.errors); // as shells say it
    return subscriber;
  } finally {
    await subscriber.kill("SIGKILL");
  }
}

/** The same through a connection that is cut while it runs. */
async function followThroughCut(options, condition) {
  await server.behave(options);
  const proxy = await startProxy(server.port);
  try {
    return await follow({ endpointUrl: `opc.tcp://localhost:${proxy.port}` }, async (subscriber) => {
      proxy.cut();
      await subscriber.until((_, errors) => errors.includes("no connection"), "the loss");
      await goesOn(subscriber, condition);
    });
  } finally {
    await proxy.stop();
  }
}

const isAnotherSession = /does not resume the session: Bad_SessionIdInvalid/;

test("the connection is cut: the session goes on, and nothing is missing", async () => {
  const { lines, errors } = await followThroughCut([]);
  checkCounter(lines);
  assert.deepEqual(gapsOf(lines), []);
  assert.doesNotMatch(errors, isAnotherSession);
});

test("the session is forgotten: the subscription is transferred, and nothing is missing", async () => {
  const { lines, errors } = await followThroughCut(["forget-sessions"]);
  checkCounter(lines);
  assert.deepEqual(gapsOf(lines), []);
  assert.match(errors, isAnotherSession);
});

test("the transfer is refused: another subscription goes on after a gap", async () => {
  const { lines, errors } = await followThroughCut(["forget-sessions", "refuse-transfer"],
    (all) => gapsOf(all).length !== 0);
  checkCounter(lines);
  assert.deepEqual(gapsOf(lines).map(({ reason }) => reason.symbol), ["Bad_ServiceUnsupported"]);
  assert.match(errors, isAnotherSession);
});

test("a server without subscriptions is read instead, after a cut too", async () => {
  const { lines } = await followThroughCut(["without-subscriptions"]);
  const values = valuesOf(lines).map(({ value }) => value);
  assert.ok(values.every((value, i) => i === 0 || value > values[i - 1]), `${values}`);
  assert.deepEqual(gapsOf(lines).map(({ reason }) => reason.symbol), ["Bad_NoSubscription"]);
});

// The last one, since it takes the server away.
test("the server is killed and comes again: values go on after a gap, which people hear of too", async () => {
  const next = await successor;
  await server.behave([]); // whatever the test before had it do
  const person = busbarFor(server).startForPeople(words);
  try {
    await person.until((lines) => lines.length >= 10, "ten values");
    const { lines } = await follow(server, async (subscriber) => {
      await server.kill();
      await person.until((_, errors) => errors.includes("connection lost"), "the loss");
      await next.start();
      await goesOn(subscriber, (all) => gapsOf(all).length !== 0);
    });
    checkCounter(lines);
    const [gap, ...others] = gapsOf(lines);
    assert.deepEqual(others, []);
    assert.ok(gap.from < gap.to, JSON.stringify(gap));
    assert.equal(gap.reason.symbol, "Bad_SubscriptionIdInvalid");
    await person.until((_, errors) => /connected again[^]*may be missing/.test(errors), "the gap");
  } finally {
    await person.kill("SIGKILL");
  }
});
