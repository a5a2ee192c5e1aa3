// The controller by address instead of by name: node-opcua's client and the program busbar, encrypted, over IPv4
// and IPv6. busbar trusts the controller's certificate and lets every step of its check pass or fail by itself.
import assert from "node:assert/strict";
import { X509Certificate } from "node:crypto";
import dns from "node:dns";
import { cpSync, mkdirSync } from "node:fs";
import { networkInterfaces } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import opcua from "./opcua.mjs";
import { anonymous, createClient, modes, withSession } from "./client.mjs";
import { openHouse, startController } from "./controller.mjs";
import { Busbar } from "./peer.mjs";

const state = "i=2259";
const own = Object.values(networkInterfaces()).flat();
const outward = own.find(({ family, internal }) => family === "IPv4" && !internal)?.address;
const hasIp6 = own.some(({ address }) => address === "::1");

const rows = [
  { address: "127.0.0.1" },
  { address: outward, what: "an interface's address", skip: outward ? false : "this machine has only itself" },
  { address: "::1", skip: hasIp6 ? false : "this machine has no IPv6 loopback address" },
];

// node-opcua leaves an IPv6 address in its brackets, as it stands in the URL, and looks it up as if it were a name.
const { lookup } = dns;
dns.lookup = (host, ...rest) => lookup(host.replace(/^\[(.*)\]$/, "$1"), ...rest);

let controller;

before(async () => {
  controller = await startController({ ...openHouse, endpoints: [["Basic256Sha256", "SignAndEncrypt"]] });
});
after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

const urlOf = (address) => `opc.tcp://${address.includes(":") ? `[${address}]` : address}:${controller.port}`;

/** busbar with a folder of its own, where the controller's certificate is trusted. */
function busbarAt(address) {
  const pki = join(controller.folder, "busbar-pki");
  mkdirSync(join(pki, "trusted"), { recursive: true });
  cpSync(join(controller.certificates, "own/certs"), join(pki, "trusted/certs"), { recursive: true });
  return new Busbar({ endpointUrl: urlOf(address) }, pki);
}

for (const { address, what = address, skip = false } of rows) {
  describe(`a controller at ${what}`, { skip }, () => {
    test("node-opcua reads, and is told that address and a certificate that names it", async () => {
      const client = await createClient(controller.folder, modes.SignAndEncrypt);
      await client.connect(urlOf(address));
      try {
        const endpoints = await client.getEndpoints();
        assert.equal(endpoints.length, 1);
        assert.equal(endpoints[0].endpointUrl, urlOf(address));
        const certificate = new X509Certificate(endpoints[0].serverCertificate);
        assert.ok(certificate.checkIP(address), certificate.subjectAltName);
      } finally {
        await client.disconnect();
      }
      await withSession(controller, modes.SignAndEncrypt, anonymous, async (session) => {
        const value = await session.read({ nodeId: state, attributeId: opcua.AttributeIds.Value });
        assert.equal(value.value.value, 0);
      }, urlOf(address));
    });

    test("busbar reads, with the names checked", async () => {
      const { code, json, errors } = await busbarAt(address).run(["read", state]);
      assert.equal(code, 0, `${JSON.stringify(json)} ${errors}`);
      assert.equal(json[0].value, 0);
      assert.equal(errors, "");
    });
  });
}

const hasMore = process.platform === "linux"; // all of 127.0.0.0/8 is this machine
test("busbar refuses an address that the certificate does not name",
  { skip: hasMore ? false : "127.0.0.2 is not everywhere this machine" }, async () => {
    const { code, json, errors } = await busbarAt("127.0.0.2").run(["read", state]);
    assert.equal(code, 4);
    assert.match(JSON.stringify(json) + errors, /Bad_CertificateHostNameInvalid/);
  });
