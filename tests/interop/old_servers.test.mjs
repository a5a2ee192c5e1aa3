// The program busbar against servers that have little: one connection, no DataTypeDefinition, an address for a name.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { startGate } from "./gate.mjs";
import { Busbar, makeFolder, removeFolder, startPeer } from "./peer.mjs";

const id = (name) => `nsu=urn:interop:old;s=${name}`;
const state = "i=2259";
const program = "old_server.mjs";

let folder;
let peer;

before(async () => {
  folder = await makeFolder(["127.0.0.1", "::1"]);
  peer = await startPeer({ folder, program, second: "small" });
  await good(clientOf(peer), ["read", state, "--trust"]); // all have the same certificate
});
after(async () => {
  await peer?.kill();
  removeFolder(folder);
});

const clientOf = (server, options = []) => new Busbar(server, join(folder, "pki"), options);

async function good(client, words) {
  const { code, json, errors } = await client.run(words);
  assert.equal(code, 0, `${words}: ${JSON.stringify(json)} ${errors}`);
  return json;
}

describe("a server with one connection", () => {
  async function throughGate(settings, options, check) {
    const gate = await startGate(peer.port, settings);
    try {
      const [{ value }] = await good(clientOf(gate, options), ["read", state]);
      assert.equal(value, 0);
      check(gate.counts);
    } finally {
      await gate.stop();
    }
  }
  const counted = (expected) => (counts) => assert.deepEqual(counts, expected);

  test("without security one is enough", () =>
    throughGate({ releaseMs: 5_000 }, ["--insecure", "--policy", "None"], counted({ admitted: 1, refused: 0 })));

  test("with security the second waits for the end of the first", () =>
    throughGate({}, [], counted({ admitted: 2, refused: 0 })));

  test("a server that takes its time to have room again is asked again", () =>
    throughGate({ releaseMs: 700 }, [], ({ admitted, refused }) => {
      assert.equal(admitted, 2);
      assert.ok(refused > 0, `${refused} refused`);
    }));

  test("node-opcua with maxConnectionsPerEndpoint: 1", async () => {
    for (const options of [["--insecure", "--policy", "None"], []]) {
      const [{ value }] = await good(clientOf({ endpointUrl: peer.secondUrl }, options), ["read", state]);
      assert.equal(value, 0);
    }
  });
});

describe("a server without DataTypeDefinition", () => {
  const valueOf = async (node) => (await good(clientOf(peer), ["read", node]))[0].value;

  test("structures of namespace 0 are known", async () => {
    const status = await valueOf("i=2256");
    assert.equal(status.State, 0);
    assert.equal(typeof status.BuildInfo.ProductName, "string");
    assert.ok(Date.parse(status.StartTime) <= Date.parse(status.CurrentTime));
  });

  test("structures of its own are found in its type dictionary", async () => {
    assert.deepEqual(await valueOf(id("Stroke")), {
      UaTypeId: "ns=2;s=type Stroke",
      Name: "down", Phase: 4, Allowed: { Low: -1, High: 9.5 }, Path: [{ X: 1, Y: 2 }, { X: 3, Y: 4 }],
    });
    const { Author, Text } = await valueOf(id("Remark"));
    assert.equal(Author, undefined);
    assert.equal(Text, "too hot");
  });

  test("for people they have the names of fields and values", async () => {
    const reading = clientOf(peer).startForPeople(["read", id("Stroke")]);
    assert.equal(await reading.end(), 0, reading.errors);
    assert.match(reading.lines.join("\n"), /Phase +Closed \(4\)/);
  });

  test("what OPC UA Binary does not have stays encoded", async () => {
    const value = JSON.stringify(await valueOf(id("Frame")));
    assert.match(value, /AQIDBA==/);
  });
});

describe("servers by address", () => {
  for (const [name, host] of [["IPv4", "127.0.0.1"], ["IPv6", "[::1]"]]) {
    test(`${name}, SignAndEncrypt: the certificate names it`, async () => {
      const endpointUrl = `opc.tcp://${host}:${peer.port}`;
      const [{ value }] = await good(clientOf({ endpointUrl }), ["read", state]);
      assert.equal(value, 0);
      await peer.login("Basic256Sha256 SignAndEncrypt AnonymousIdentityToken");
    });
  }
});
