// Push management (Part 12, 7.10) by node-opcua's own client for it, while another client stays subscribed.
import assert from "node:assert/strict";
import { randomBytes } from "node:crypto";
import { mkdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { after, before, test } from "node:test";
import opcua from "./opcua.mjs";
import { clientOptions, derOf, makeAuthority, makeCertificate, makeRevocationList, signRequest } from "./certificates.mjs";
import { createClient, modes, named, withSession } from "./client.mjs";
import { startController, user } from "./controller.mjs";

const { AttributeIds, ClientMonitoredItem, ClientSubscription, DataType, TimestampsToReturn } = opcua;

// The client for push management has an older node-opcua of its own, and takes the sessions of that alone.
const require = createRequire(import.meta.url);
const inPush = createRequire(require.resolve("node-opcua-server-configuration"));
const { ClientPushCertificateManagement } = require("node-opcua-server-configuration");
const { BinaryStream } = inPush("node-opcua-binary-stream");
const olderLibrary = { ...inPush("node-opcua-client"), ...inPush("node-opcua-certificate-manager") };

const admin = { userName: "admin", password: "another pass phrase", roles: ["ConfigureAdmin", "SecurityAdmin"] };
const trustList = "i=12642"; // of DefaultApplicationGroup
const uri = "urn:busbar:interop:client";

let controller;
let authority;
const clients = {};

const isGood = (statusCode, message) => assert.equal(statusCode.name, "Good", message);
const optionsOf = async (name) => ({
  ...modes.SignAndEncrypt, ...(await clientOptions(join(controller.folder, "clients"), name, clients[name])),
});
const as = async (name, who, action) => withSession(controller, await optionsOf(name),
  named(who), action, controller.endpointUrl, olderLibrary);
/** For clients' own lists, before they are read: the server will have a certificate of the authority's. */
async function trustAuthority() {
  const pem = (label, der) => `-----BEGIN ${label}-----\n${der.toString("base64").replace(/(.{64})/g, "$1\n")}\n-----END ${label}-----\n`;
  for (const list of ["issuers", "trusted"]) {
    const folder = join(controller.folder, "client-pki", list);
    mkdirSync(join(folder, "certs"), { recursive: true });
    mkdirSync(join(folder, "crl"), { recursive: true });
    writeFileSync(join(folder, "certs", "plant.pem"), pem("CERTIFICATE", derOf(authority)));
    writeFileSync(join(folder, "crl", "plant.pem"), pem("X509 CRL", await makeRevocationList(authority)));
  }
}
const isRefused = async (name) => {
  const client = await createClient(controller.folder, {
    ...(await optionsOf(name)), connectionStrategy: { initialDelay: 10, maxDelay: 20, maxRetry: 0 },
  });
  try {
    await client.connect(controller.endpointUrl);
    await client.disconnect();
    return false;
  } catch {
    return true;
  }
};

/**
 * What its own writeTrustedCertificateList does not do: it opens without EraseExisting, which Part 12, 7.8.2.2
 * forbids, writes nothing, and gives CloseAndUpdate two arguments.
 */
async function writeList(session, lists) {
  const onList = async (methodId, ...inputs) => {
    const inputArguments = inputs.map(([dataType, value]) => ({ dataType: DataType[dataType], value }));
    const { statusCode, outputArguments } = await session.call({ objectId: trustList, methodId, inputArguments });
    isGood(statusCode, methodId);
    return outputArguments?.[0]?.value;
  };
  const handle = ["UInt32", await onList("i=12647", ["Byte", 6])];
  const stream = new BinaryStream(lists.binaryStoreSize());
  lists.encode(stream);
  await onList("i=12655", handle, ["ByteString", stream.buffer]);
  return onList("i=12666", handle);
}

before(async () => {
  authority = await makeAuthority("Plant CA");
  for (const name of ["engineer", "watcher", "stranger"]) {
    clients[name] = await makeCertificate(name, { applicationUri: uri });
  }
  controller = await startController({
    endpoints: [["Basic256Sha256", "SignAndEncrypt"]],
    users: 'anonymous = "no"',
    accounts: [admin],
    async prepare(store) {
      const trusted = join(store, "trusted/certs");
      mkdirSync(trusted, { recursive: true });
      for (const name of ["engineer", "watcher"]) writeFileSync(join(trusted, `${name}.der`), derOf(clients[name]));
    },
  });
  await trustAuthority();
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

test("a stranger is found in the rejected list and trusted", { timeout: 60_000 }, async () => {
  assert.ok(await isRefused("stranger"));
  await as("engineer", admin, async (session) => {
    const push = new ClientPushCertificateManagement(session);
    assert.deepEqual(await push.getSupportedPrivateKeyFormats(), ["PEM"]);
    const rejected = await push.getRejectedList();
    isGood(rejected.statusCode);
    assert.ok(rejected.certificates.some((der) => der.equals(derOf(clients.stranger))));
    const list = await (await push.getApplicationGroup()).getTrustList();
    assert.equal((await list.readTrustedCertificateList()).trustedCertificates.length, 2);
    isGood(await list.addCertificate(derOf(clients.stranger), true));
    assert.equal((await list.readTrustedCertificateList()).trustedCertificates.length, 3);
  });
  assert.ok(!(await isRefused("stranger")));
});

test("a request is signed and the certificate renewed while a client stays subscribed", { timeout: 60_000 }, async () => {
  const client = await createClient(controller.folder, await optionsOf("watcher"));
  await client.connect(controller.endpointUrl);
  const session = await client.createSession(named(user));
  const subscription = ClientSubscription.create(session, {
    requestedPublishingInterval: 50, requestedLifetimeCount: 1000, requestedMaxKeepAliveCount: 10, publishingEnabled: true,
  });
  const plc = (await session.readNamespaceArray()).findIndex((name) => /plc/i.test(name));
  const item = ClientMonitoredItem.create(subscription, { nodeId: `ns=${plc};s=Counter`, attributeId: AttributeIds.Value },
    { samplingInterval: 50, discardOldest: true, queueSize: 1 }, TimestampsToReturn.Both);
  let changes = 0;
  item.on("changed", () => { ++changes; });
  const more = async () => {
    const before = changes;
    for (let i = 0; i < 200 && changes < before + 3; ++i) await new Promise((resolve) => setTimeout(resolve, 100));
    assert.ok(changes >= before + 3, "values go on");
  };
  try {
    await more();
    const subscriptionId = subscription.subscriptionId;
    let issued;
    await as("engineer", admin, async (adminSession) => {
      const push = new ClientPushCertificateManagement(adminSession);
      const list = await (await push.getApplicationGroup()).getTrustList();
      const lists = await list.readTrustedCertificateList();
      lists.issuerCertificates = [derOf(authority)];
      assert.equal(await writeList(adminSession, lists), true);
      const request = await push.createSigningRequest("DefaultApplicationGroup",
        ClientPushCertificateManagement.rsaSha256ApplicationCertificateType, "CN=Press 4/O=Works", true, randomBytes(32));
      isGood(request.statusCode);
      issued = await signRequest(authority, request.certificateSigningRequest);
      const updated = await push.updateCertificate("DefaultApplicationGroup",
        ClientPushCertificateManagement.rsaSha256ApplicationCertificateType, issued, [derOf(authority)]);
      isGood(updated.statusCode);
      assert.equal(updated.applyChangesRequired, true);
      isGood(await push.applyChanges());
    });
    await new Promise((resolve) => setTimeout(resolve, 1500)); // channels with the old one are closed
    await more();
    assert.equal(subscription.subscriptionId, subscriptionId, "it is the same subscription");
    await as("engineer", admin, async (_, again) => {
      assert.ok(again.serverCertificate.subarray(0, issued.length).equals(issued));
    });
  } finally {
    await session.close();
    await client.disconnect();
  }
});

test("a client sees what its role may see and no more", { timeout: 60_000 }, async () => {
  const childrenOf = async (session, nodeId) => (await session.browse(nodeId)).references.length;
  await as("watcher", user, async (session) => {
    const push = new ClientPushCertificateManagement(session);
    const rejected = await push.getRejectedList();
    assert.notEqual(rejected.statusCode.name, "Good");
    assert.equal((await session.browse(trustList)).statusCode.name, "BadNodeIdUnknown");
  });
  await as("engineer", admin, async (session) => {
    assert.ok((await childrenOf(session, trustList)) > 10);
  });
});
