// Model mode: the public PackML model and a machine of it, mapped to labels and written to a controller that runs with
// `busbar project`; then the node-opcua client works with the machine.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import opcua from "./opcua.mjs";
import { modes, named, withSession } from "./client.mjs";
import { openHouse, startController, user } from "./controller.mjs";

const { AttributeIds, ClientMonitoredItem, ClientSubscription, DataType, TimestampsToReturn } = opcua;
const { nodesets } = createRequire(import.meta.url)("node-opcua-nodesets");

const chief = { userName: "chief", password: "a third pass phrase", roles: ["SecurityAdmin"] };
const states = { idle: 4, execute: 6, held: 11 };

const declarations = `
TYPE LineType : STRUCT
  Tag : STRING[32] := 'line 4';
  Speed : LREAL := 10.0;
  SetSpeed : LREAL := 10.0;
  Mode : DINT := 1;
  RequestedMode : DINT := 1;
  State : UDINT := ${states.idle};
  StateText : STRING[16] := 'Idle';
  StartHandle : WORD;
  HoldHandle : WORD;
  ModeHandle : WORD;
END_STRUCT; END_TYPE
{attribute 'publish' := 'publish only'}
VAR_GLOBAL Line : LineType; END_VAR
`;
const programs = `
[[plc.program]]
kind = "acknowledge"
target = "Line.StartHandle"
period_ms = 200
sets = "Line.State"
to = ${states.execute}
[[plc.program]]
kind = "acknowledge"
target = "Line.HoldHandle"
sets = "Line.State"
to = ${states.held}
[[plc.program]]
kind = "acknowledge"
target = "Line.ModeHandle"
[[plc.program]]
kind = "copy"
source = "Line.SetSpeed"
target = "Line.Speed"
[[plc.program]]
kind = "copy"
source = "Line.RequestedMode"
target = "Line.Mode"
`;
const mapping = [
  ["i=2", "Line.Tag"], ["i=11", "Line.Speed"], ["i=12", "Line.SetSpeed"], ["i=13", "Line.Mode"],
  ["i=21", "Line.StateText"], ["i=22", "Line.State"], ["i=30", "Line.StartHandle"],
  ["i=23", "Line.StartHandle", "Handle"], ["i=24", "Line.HoldHandle", "Handle"],
  ["i=3", "Line.ModeHandle", "Handle"], ["i=3", "Line.RequestedMode", "Input[0]"],
];

let controller;
let index;

/** What busbar printed; a failure fails the test. */
function busbar(...args) {
  const { status, stdout, stderr } = spawnSync(process.env.BUSBAR_CLIENT, args, {
    cwd: controller.folder, encoding: "utf8", env: { ...process.env, XDG_DATA_HOME: join(controller.folder, "data") },
  });
  assert.equal(status, 0, `busbar ${args.join(" ")}: ${stdout}${stderr}`);
  return stdout;
}
const online = (command, ...args) => busbar("--user", chief.userName, "--password-file", "password", "--trust",
  "project", command, controller.endpointUrl, ...args);

const id = (text) => `ns=${index};${text}`;
const as = (who, action) => withSession(controller, modes.SignAndEncrypt, named(who), action);
const secured = (action) => as(user, action);
const read = async (session, node) => {
  const result = await session.read({ nodeId: id(node), attributeId: AttributeIds.Value });
  assert.equal(result.statusCode.name, "Good", node);
  return result.value.value;
};
const call = (session, objectId, methodId, inputArguments = []) =>
  session.call({ objectId: id(objectId), methodId: id(methodId), inputArguments });

/** Resolves when a MonitoredItem of the node has told of the value. */
function sees(session, node, value) {
  return new Promise((done, fail) => {
    const subscription = ClientSubscription.create(session, { requestedPublishingInterval: 50, requestedLifetimeCount: 1000, publishingEnabled: true });
    const timer = setTimeout(() => fail(new Error(`${node} did not become ${value}`)), 20_000);
    const item = ClientMonitoredItem.create(subscription, { nodeId: id(node), attributeId: AttributeIds.Value },
      { samplingInterval: 50, discardOldest: true, queueSize: 100 }, TimestampsToReturn.Both);
    item.on("changed", async (each) => {
      if (each.value.value !== value) return;
      clearTimeout(timer);
      await subscription.terminate();
      done();
    });
  });
}

async function becomesServed() {
  for (let i = 0; i < 100; ++i) {
    try {
      await secured(async (session) => { index = (await session.readNamespaceArray()).indexOf("urn:busbar:test:line"); });
      if (index > 0) return;
    } catch { /* it is being replaced */ }
    await new Promise((again) => setTimeout(again, 100));
  }
  assert.fail("the project is not served");
}

before(async () => {
  controller = await startController({ ...openHouse, accounts: [chief], labels: { declarations, programs } });
  writeFileSync(join(controller.folder, "password"), chief.password);
  const file = "line.busbar";
  busbar("project", "new", file, "--preset", "rd81opc96");
  busbar("project", "import", file, nodesets.packML);
  busbar("project", "import", file, resolve("line.NodeSet2.xml"));
  for (const [node, label, ...part] of mapping) {
    busbar("project", "map", file, `nsu=urn:busbar:test:line;${node}`, label, ...part);
  }
  busbar("project", "set", file, "security.trust_all_clients", "yes");
  assert.match(busbar("project", "check", file), /^0 errors/m);
  busbar("cert", "create");
  online("write", file, "--yes");
  online("update", "--yes");
  await becomesServed();
});
after(async () => { assert.equal(await controller?.stop(), 0, "the controller stops cleanly on SIGTERM"); });

test("the machine's states are read by their labels", () => secured(async (session) => {
  assert.equal(await read(session, "i=22"), states.idle);
  assert.equal((await read(session, "i=21")).text, "Idle");
  assert.equal(await read(session, "i=2"), "line 4");
  assert.equal(await read(session, "i=11"), 10);
}));

test("a Write reaches the program, and what the program does with it the clients", () => secured(async (session) => {
  const statusCode = await session.write({
    nodeId: id("i=12"), attributeId: AttributeIds.Value, value: { value: { dataType: DataType.Float, value: 37.5 } },
  });
  assert.equal(statusCode.name, "Good");
  await sees(session, "i=11", 37.5);
}));

test("a Method sets its Handle, and the program clears it and changes the state", () => secured(async (session) => {
  const seen = sees(session, "i=22", states.execute);
  const { statusCode } = await call(session, "i=20", "i=23");
  assert.equal(statusCode.name, "Good");
  await seen;
  await sees(session, "i=30", 0);
  assert.equal((await call(session, "i=20", "i=24")).statusCode.name, "Good");
  await sees(session, "i=22", states.held);
}));

test("an input argument is at its label before the Handle is set", () => secured(async (session) => {
  const { statusCode } = await call(session, "i=1", "i=3", [{ dataType: DataType.Int32, value: 3 }]);
  assert.equal(statusCode.name, "Good");
  await sees(session, "i=13", 3);
  const wrong = await call(session, "i=1", "i=3", [{ dataType: DataType.String, value: "three" }]);
  assert.equal(wrong.statusCode.name, "BadInvalidArgument");
  assert.equal(wrong.inputArgumentResults[0].name, "BadTypeMismatch");
}));

test("what runs is what was written", () => {
  assert.match(online("verify", "line.busbar"), /no differences/);
  assert.match(online("status"), /in use/);
});
