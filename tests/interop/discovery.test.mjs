// busbar-controller registers with node-opcua's discovery server (Part 4, 5.5.6).
import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { hostname, tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import opcua from "./opcua.mjs";
import { freePort, openHouse, startController } from "./controller.mjs";

const applicationUri = `urn:${hostname()}:busbar:controller`;

let folder;
let discovery;
let discoveryUrl;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "busbar-discovery-"));
  const serverCertificateManager = new opcua.OPCUACertificateManager({
    rootFolder: folder, automaticallyAcceptUnknownCertificate: true,
  });
  await serverCertificateManager.initialize();
  discovery = new opcua.OPCUADiscoveryServer({
    port: await freePort(),
    serverCertificateManager,
    automaticallyAcceptUnknownCertificate: true,
  });
  await discovery.start();
  discoveryUrl = discovery.getDiscoveryUrls()[0];
});

after(async () => {
  await discovery.shutdown();
  rmSync(folder, { recursive: true, force: true });
});

async function registeredUrls() {
  const { servers } = await opcua.findServers(discoveryUrl);
  return servers.find((server) => server.applicationUri === applicationUri)?.discoveryUrls ?? [];
}

/** What `ask` gives once it is true, within ten seconds. */
async function eventually(ask) {
  for (let i = 0; i < 100; ++i) {
    const answer = await ask();
    if (answer) return answer;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  return ask();
}

test("the controller is found while it runs, and no longer", async () => {
  const controller = await startController({ ...openHouse, discoveryUrl });
  const registered = () => controller.output().includes(`${applicationUri} is registered`);
  assert.ok(await eventually(registered), controller.output());
  assert.doesNotMatch(controller.output(), /INSECURE/);
  assert.deepEqual(await registeredUrls(), [`opc.tcp://${hostname()}:${controller.port}`]);
  assert.equal(await controller.stop(), 0);
  assert.deepEqual(await registeredUrls(), []);
});
