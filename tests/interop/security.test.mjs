// Policies, certificates and users: the node-opcua client against a controller that trusts nobody by itself.
import assert from "node:assert/strict";
import { mkdirSync, readdirSync, renameSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import opcua from "./opcua.mjs";
import {
  clientOptions, derOf, keyPemOf, makeAuthority, makeCertificate, makeRevocationList,
} from "./certificates.mjs";
import { named, withSession } from "./client.mjs";
import { startController, user } from "./controller.mjs";

const { MessageSecurityMode, SecurityPolicy, UserTokenType } = opcua;

const policies = ["Basic256Sha256", "Aes128_Sha256_RsaOaep", "Aes256_Sha256_RsaPss"];
const modes = ["Sign", "SignAndEncrypt"];
const encrypted = {
  securityMode: MessageSecurityMode.SignAndEncrypt, securityPolicy: SecurityPolicy.Basic256Sha256,
};
const uri = "urn:busbar:interop:client";

let controller;
let clients; // name → certificate and key
let people;

/** Puts a certificate or revocation list into a list of a store. */
function put(store, list, file, bytes) {
  mkdirSync(join(store, list), { recursive: true });
  writeFileSync(join(store, list, file), bytes);
}

before(async () => {
  const root = await makeAuthority("Plant root");
  const issuing = await makeAuthority("Plant issuing", root);
  const make = (name, issuer) => makeCertificate(name, { issuer, applicationUri: uri });
  clients = {
    known: await make("Known client"), stranger: await make("Stranger"),
    issued: await make("Issued client", issuing), revoked: await make("Revoked client", issuing),
  };
  people = {
    known: await makeCertificate("maintainer"), stranger: await makeCertificate("intruder"),
    issued: await makeCertificate("engineer", { issuer: issuing }),
    revoked: await makeCertificate("leaver", { issuer: issuing }),
  };
  const lists = async (store, revoked) => {
    put(store, "trusted/certs", "issuing.der", derOf(issuing));
    put(store, "trusted/crl", "issuing.crl", await makeRevocationList(issuing, revoked));
    put(store, "issuers/certs", "root.der", derOf(root));
    put(store, "issuers/crl", "root.crl", await makeRevocationList(root));
  };
  controller = await startController({
    endpoints: policies.flatMap((policy) => modes.map((mode) => [policy, mode])),
    users: 'anonymous = "no"\ncertificates = "read"',
    async prepare(store) {
      put(store, "trusted/certs", "known.der", derOf(clients.known));
      await lists(store, [clients.revoked]);
      const users = join(store, "users");
      put(users, "trusted/certs", "known.der", derOf(people.known));
      await lists(users, [people.revoked]);
    },
  });
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

const optionsOf = async (name, more = {}) => ({
  ...encrypted, ...more, ...(await clientOptions(join(controller.folder, "clients"), name, clients[name])),
});
const certified = async (made) => ({
  type: UserTokenType.Certificate, certificateData: derOf(made), privateKey: await keyPemOf(made),
});
const noRetry = { connectionStrategy: { maxRetry: 0, initialDelay: 10, maxDelay: 10 } };

/** Logs in and reads the state of the server. */
async function use(name, identity = named(user), more = {}) {
  const options = await optionsOf(name, more);
  return withSession(controller, options, identity, async (session) => {
    const state = await session.read({ nodeId: "i=2259", attributeId: opcua.AttributeIds.Value });
    assert.equal(state.value.value, 0);
  });
}

/** What the controller logged while `action` ran. */
async function logOf(action) {
  const start = controller.output().length;
  await action();
  await new Promise((resolve) => setTimeout(resolve, 50));
  return controller.output().slice(start);
}

describe("every policy and mode", () => {
  for (const policy of policies) {
    for (const mode of modes) {
      const security = { securityPolicy: SecurityPolicy[policy], securityMode: MessageSecurityMode[mode] };
      test(`${policy}, ${mode}, user name`, () => use("known", named(user), security));
      test(`${policy}, ${mode}, user certificate`, async () =>
        use("known", await certified(people.known), security));
    }
  }
});

describe("certificates of clients", () => {
  test("issued by a trusted authority: accepted", () => use("issued"));

  test("revoked: refused, and the log says by which check", async () => {
    const log = await logOf(() => assert.rejects(use("revoked", named(user), noRetry)));
    assert.match(log, /Bad_CertificateRevoked/);
    assert.match(log, /CN=Revoked client/);
  });

  test("unknown: refused, moved to trusted, accepted", async () => {
    const log = await logOf(() => assert.rejects(use("stranger", named(user), noRetry)));
    assert.match(log, /Bad_CertificateUntrusted/);
    assert.match(log, /CN=Stranger/);
    const rejected = join(controller.certificates, "rejected/certs");
    const file = readdirSync(rejected).find((name) => name.includes("Stranger"));
    assert.ok(file, `the certificate lies in rejected: ${readdirSync(rejected)}`);
    renameSync(join(rejected, file), join(controller.certificates, "trusted/certs", file));
    await use("stranger");
  });
});

describe("certificates of users", () => {
  test("issued by a trusted authority: accepted", async () => use("known", await certified(people.issued)));

  for (const [name, code] of [["revoked", "Bad_CertificateRevoked"], ["stranger", "Bad_CertificateUntrusted"]]) {
    test(`${name}: refused, and the log says by which check`, async () => {
      const identity = await certified(people[name]);
      const log = await logOf(() =>
        assert.rejects(use("known", identity), /BadIdentityTokenRejected|BadUserAccessDenied|BadIdentityTokenInvalid/));
      assert.match(log, new RegExp(code));
    });
  }

  test("with another's key: refused", async () => {
    const identity = { ...(await certified(people.known)), privateKey: await keyPemOf(people.stranger) };
    await assert.rejects(use("known", identity), /BadUserSignatureInvalid|BadIdentityTokenRejected/);
  });
});

test("a wrong password and an anonymous user are refused", async () => {
  await assert.rejects(use("known", named({ ...user, password: "wrong" })), /BadIdentityTokenRejected|BadUserAccessDenied/);
  await assert.rejects(use("known", { type: UserTokenType.Anonymous }), /BadIdentityToken|anonymous/i);
});
