// A gateway as its user has it, in three processes: a simulated PLC, busbar-controller in front of it, and
// node-opcua's client, which subscribes to 10,000 registers.
import assert from "node:assert/strict";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { anonymous, createClient, modes, withSession } from "./client.mjs";
import { freePort, openHouse, startController } from "./controller.mjs";
import opcua from "./opcua.mjs";
import { hasProgram, Plc } from "./plc.mjs";

const { AttributeIds, DataType, StatusCodes, TimestampsToReturn } = opcua;
const count = 10_000;
const patience = 60_000;

/** Calls `look` until it returns true. */
async function until(look, what) {
  const end = Date.now() + patience;
  while (!(await look())) {
    assert.ok(Date.now() < end, `waited in vain until ${what()}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

describe("a gateway to Modbus TCP", { skip: !hasProgram("busbar-plc-responder") && "no simulated PLC" }, () => {
  let port;
  let plc;
  let controller;
  let client;
  let session;
  let namespaceIndex;
  /** The last value that came, by register. */
  const values = new Map();
  let notifications = 0;

  const id = (name) => `ns=${namespaceIndex};s=${name}`;
  const read = async (name) => (await session.read({ nodeId: id(name), attributeId: AttributeIds.Value }));
  const startPlc = () => Plc.start("busbar-plc-responder", "modbus", "--listen", `127.0.0.1:${port}`,
    "--set", "holding:0=17");
  const has = (register, statusCode) => values.get(register)?.statusCode.equals(statusCode);
  const all = (statusCode) => [...values.values()].filter((each) => each.statusCode.equals(statusCode)).length;

  before(async () => {
    port = await freePort();
    const folder = mkdtempSync(join(tmpdir(), "busbar-gateway-"));
    const table = join(folder, "line.csv");
    const lines = Array.from({ length: count }, (_, i) => `R${i},holding:${i},write`);
    writeFileSync(table, ["name,at,access", ...lines].join("\n"));
    plc = await startPlc();
    controller = await startController({ ...openHouse, backends: `
[[backend]]
name = "line"
protocol = "modbus"
address = "127.0.0.1:${port}"
under_way = 4
timeout_ms = 1000
longest_pause_ms = 500
table = "${table}"` });
    client = await createClient(controller.folder, modes.None);
    await client.connect(controller.endpointUrl);
    session = await client.createSession(anonymous);
    namespaceIndex = (await session.readNamespaceArray()).indexOf("urn:busbar:backends");
    await until(async () => (await read("line Connection.State")).value.value === 2, () => "the PLC is online");
  });
  after(async () => {
    await session?.close();
    await client?.disconnect();
    assert.equal(await controller?.stop(), 0);
    await plc?.stop();
  });

  test("serves 10,000 registers at 200 ms in as few requests as there can be", async () => {
    const subscription = await session.createSubscription2({ requestedPublishingInterval: 200,
      requestedMaxKeepAliveCount: 20, requestedLifetimeCount: 1000, publishingEnabled: true, maxNotificationsPerPublish: 0 });
    for (let first = 0; first < count; first += 1000) {
      const group = await subscription.monitorItems(
        Array.from({ length: 1000 }, (_, i) => ({ nodeId: id(`line.R${first + i}`), attributeId: AttributeIds.Value })),
        { samplingInterval: 200, queueSize: 1, discardOldest: true }, TimestampsToReturn.Both);
      group.on("changed", (_item, value, index) => {
        ++notifications;
        values.set(first + index, value);
      });
    }
    await until(() => values.size === count && all(StatusCodes.Good) === count, () => `${values.size} values are there`);
    assert.equal(values.get(0).value.value, 17);
    const before_ = Number((await read("line Connection.Requests")).value.value[1]);
    const start = Date.now();
    await new Promise((resolve) => setTimeout(resolve, 2_000));
    const requests = Number((await read("line Connection.Requests")).value.value[1]) - before_;
    const cycles = (Date.now() - start) / 200;
    console.log(`${(requests / cycles).toFixed(1)} requests in 200 ms, ${count / 125} are the least`);
    // Not more than what is needed, however slow the machine is: samples wait for each other.
    assert.ok(requests <= (cycles + 2) * (count / 125 + 1), `${requests} requests in ${cycles} cycles`);
  });

  test("a change in the PLC comes, and a write is in the PLC", async () => {
    assert.equal(await plc.say("set holding:9999 4711"), "ok");
    await until(() => values.get(9_999).value.value === 4_711, () => "the change comes");
    const written = await session.write({ nodeId: id("line.R5"), attributeId: AttributeIds.Value,
      value: { value: { dataType: DataType.UInt16, value: 99 } } });
    assert.ok(written.equals(StatusCodes.Good), written.toString());
    assert.equal(await plc.say("get holding:5"), "99");
  });

  test("one address that the PLC refuses costs the others nothing", async () => {
    assert.equal(await plc.say("refuse holding:1234"), "ok");
    await until(() => has(1_234, StatusCodes.BadConfigurationError), () => `it is ${values.get(1_234).statusCode}`);
    assert.equal(all(StatusCodes.Good), count - 1);
    assert.equal(await plc.say("allow"), "ok");
    await until(() => has(1_234, StatusCodes.Good), () => "it is read again");
  });

  test("a slow PLC is late, and no value says that it is newer than it is", async () => {
    assert.equal(await plc.say("set holding:7 1"), "ok");
    await until(() => values.get(7).value.value === 1, () => "the value is there");
    const last = values.get(7).sourceTimestamp;
    assert.equal(await plc.say("slow 3000"), "ok");
    await until(() => has(7, StatusCodes.BadTimeout) || has(7, StatusCodes.BadNoCommunication),
      () => `it is ${values.get(7).statusCode}`);
    // A batch that the whole machine was too slow for is answered by the server, which knows no time of a value.
    const { sourceTimestamp } = values.get(7);
    assert.ok(!sourceTimestamp || (sourceTimestamp >= last && sourceTimestamp <= new Date()), `${sourceTimestamp}`);
    assert.equal(await plc.say("slow 0"), "ok");
    await until(() => all(StatusCodes.Good) === count, () => `${all(StatusCodes.Good)} are good`);
  });

  test("a PLC that is killed is away at once, with the time of the last value, and comes back", async () => {
    const killed = new Date();
    plc.process.kill("SIGKILL");
    await plc.exit;
    await until(() => all(StatusCodes.BadNoCommunication) === count, () => `${all(StatusCodes.BadNoCommunication)} are bad`);
    for (const register of [0, 5_000, 9_999]) {
      const value = values.get(register);
      assert.equal(value.value.dataType, DataType.Null);
      assert.ok(value.sourceTimestamp <= new Date(killed.getTime() + 1_000), `${value.sourceTimestamp} is newer`);
    }
    assert.match((await read("line Connection.Trouble")).value.value, /refused|closed/);
    plc = await startPlc();
    await until(() => all(StatusCodes.Good) === count, () => `${all(StatusCodes.Good)} are good`);
    assert.equal(values.get(9_999).value.value, 0);
  });

  test("a connection that the PLC closes is made again", async () => {
    const before_ = Number((await read("line Connection.Connections")).value.value[1]);
    assert.equal(await plc.say("close"), "ok");
    await until(async () => Number((await read("line Connection.Connections")).value.value[1]) > before_,
      () => "there is another connection");
    await until(() => all(StatusCodes.Good) === count, () => `${all(StatusCodes.Good)} are good`);
  });
});

describe("a gateway to a PLC with SLMP", { skip: !hasProgram("busbar-plc-responder") && "no simulated PLC" }, () => {
  const words = 10_000;
  let port;
  let plc;
  let controller;
  let client;
  let session;
  let namespaceIndex;
  const values = new Map();

  const id = (name) => `ns=${namespaceIndex};s=${name}`;
  const read = async (name) => (await session.read({ nodeId: id(name), attributeId: AttributeIds.Value }));
  const startPlc = (password) => Plc.start("busbar-plc-responder", "slmp", "--listen", `127.0.0.1:${port}`,
    "--password", password, "--set", "D0=17");
  const all = (statusCode) => [...values.values()].filter((each) => each.statusCode.equals(statusCode)).length;

  before(async () => {
    port = await freePort();
    const folder = mkdtempSync(join(tmpdir(), "busbar-gateway-"));
    const table = join(folder, "mixer.csv");
    const password = join(folder, "password");
    writeFileSync(password, "secret1\n");
    writeFileSync(table, ["name,at", ...Array.from({ length: words }, (_, i) => `W${i},D${i}`)].join("\n"));
    plc = await startPlc("secret1");
    controller = await startController({ ...openHouse, backends: `
[[backend]]
name = "mixer"
protocol = "slmp"
address = "127.0.0.1:${port}"
under_way = 4
longest_pause_ms = 500
remote_password_file = "${password}"
table = "${table}"` });
    client = await createClient(controller.folder, modes.None);
    await client.connect(controller.endpointUrl);
    session = await client.createSession(anonymous);
    namespaceIndex = (await session.readNamespaceArray()).indexOf("urn:busbar:backends");
    await until(async () => (await read("mixer Connection.State")).value.value === 2, () => "the PLC is online");
    const subscription = await session.createSubscription2({ requestedPublishingInterval: 200,
      requestedMaxKeepAliveCount: 20, requestedLifetimeCount: 1000, publishingEnabled: true, maxNotificationsPerPublish: 0 });
    for (let first = 0; first < words; first += 1000) {
      const group = await subscription.monitorItems(
        Array.from({ length: 1000 }, (_, i) => ({ nodeId: id(`mixer.W${first + i}`), attributeId: AttributeIds.Value })),
        { samplingInterval: 200, queueSize: 1, discardOldest: true }, TimestampsToReturn.Both);
      group.on("changed", (_item, value, index) => values.set(first + index, value));
    }
    await until(() => values.size === words && all(StatusCodes.Good) === words, () => `${values.size} values are there`);
  });
  after(async () => {
    await session?.close();
    await client?.disconnect();
    assert.equal(await controller?.stop(), 0);
    await plc?.stop();
  });

  test("says what the PLC is", async () => {
    assert.equal(values.get(0).value.value, 17);
    assert.equal((await read("mixer Connection.Product")).value.value, "R08CPU");
    assert.equal((await read("mixer Connection.Family")).value.value, "iq-r");
    assert.equal((await read("mixer Connection.Mode")).value.value, 1);
  });

  test("values of a PLC in STOP are uncertain, and good again in RUN", async () => {
    assert.equal(await plc.say("stop"), "ok");
    await until(() => all(StatusCodes.UncertainLastUsableValue) === words,
      () => `${all(StatusCodes.UncertainLastUsableValue)} are uncertain`);
    assert.equal(values.get(0).value.value, 17);
    assert.equal((await read("mixer Connection.Mode")).value.value, 2);
    assert.equal(await plc.say("run"), "ok");
    await until(() => all(StatusCodes.Good) === words, () => `${all(StatusCodes.Good)} are good`);
  });

  test("one device that the PLC refuses costs the others nothing", async () => {
    assert.equal(await plc.say("refuse D1234"), "ok");
    await until(() => values.get(1_234).statusCode.equals(StatusCodes.BadConfigurationError),
      () => `it is ${values.get(1_234).statusCode}`);
    assert.equal(all(StatusCodes.Good), words - 1);
    assert.match((await read("mixer Connection.LastRefusal")).value.value, /^4031: /);
    assert.equal(await plc.say("allow"), "ok");
    await until(() => all(StatusCodes.Good) === words, () => `${all(StatusCodes.Good)} are good`);
  });

  test("a PLC that comes back with another password is away, and says why", async () => {
    plc.process.kill("SIGKILL");
    await plc.exit;
    await until(() => all(StatusCodes.BadNoCommunication) === words, () => `${all(StatusCodes.BadNoCommunication)} are bad`);
    plc = await startPlc("another1");
    await until(async () => (await read("mixer Connection.Trouble")).value.value
      .startsWith("C810: the remote password is wrong"), () => "it is told");
    assert.equal(all(StatusCodes.BadNoCommunication), words);
  });
});
