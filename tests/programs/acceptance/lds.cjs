// A discovery server of node-opcua for registrations, which is at its port until it is killed.
// usage: node lds.cjs NODE_MODULES PORT FOLDER
"use strict";
const { join, resolve } = require("node:path");

const [modules, port, folder] = process.argv.slice(2);
const { OPCUACertificateManager, OPCUADiscoveryServer } = require(join(resolve(modules), "node-opcua"));

async function serve() {
  const serverCertificateManager = new OPCUACertificateManager({
    rootFolder: resolve(folder), automaticallyAcceptUnknownCertificate: true,
  });
  await serverCertificateManager.initialize();
  const server = new OPCUADiscoveryServer({
    port: Number(port), hostname: "localhost", serverCertificateManager, automaticallyAcceptUnknownCertificate: true,
  });
  await server.start();
  console.log(`ready ${server.getDiscoveryUrls()[0]}`);
}
serve();
