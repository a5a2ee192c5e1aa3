// busbar-controller connects to a node-opcua client that listens (Part 6, 7.1.2.6).
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import opcua from "./opcua.mjs";
import { createClient, modes } from "./client.mjs";
import { freePort, openHouse, startController } from "./controller.mjs";

const stateNode = "i=2259"; // Server_ServerStatus_State

let listener;
let controller;

before(async () => {
  listener = new opcua.ClientReverseConnect(`opc.tcp://127.0.0.1:${await freePort()}`);
  await listener.start();
  // The listener knows the server by the URL that it announces, which follows its address.
  controller = await startController({
    ...openHouse, address: "127.0.0.1", reverseUrls: [listener.connectionUrl],
  });
});

after(async () => {
  await listener.stop();
  assert.equal(await controller.stop(), 0);
});

async function readState(client) {
  const session = await client.createSession();
  const value = await session.read({ nodeId: stateNode, attributeId: opcua.AttributeIds.Value });
  assert.equal(value.value.value, 0);
  await session.close();
}

test("several clients use connections that the server made", async () => {
  const clients = [];
  for (let i = 0; i < 3; ++i) {
    const client = await createClient(controller.folder, modes.None);
    await client.connectReverse(listener, { endpointUrl: controller.endpointUrl });
    clients.push(client); // and keeps its connection, so that the next needs another one
  }
  for (const client of clients) await readState(client);
  for (const client of clients) await client.disconnect();
});

test("after a client has gone there is a connection for the next one", async () => {
  for (let i = 0; i < 3; ++i) {
    const client = await createClient(controller.folder, modes.None);
    await client.connectReverse(listener, { endpointUrl: controller.endpointUrl });
    await readState(client);
    await client.disconnect();
  }
});
