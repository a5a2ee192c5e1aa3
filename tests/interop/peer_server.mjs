// A node-opcua server for our client to meet, as a process of its own that can be killed. FOLDER has its certificate;
// what it makes itself goes there too. Each line of its standard input says how it behaves from then on: some of
// "forget-sessions", "refuse-transfer" and "without-subscriptions", or nothing. It ends with its standard input.
// usage: node peer_server.mjs PORT FOLDER TYPES [signing=PORT] [later]
// signing: it is at this port, too, without encryption
// later: it loads what it needs, and starts with the first line
import { join } from "node:path";
import { createInterface } from "node:readline";
import opcua from "./opcua.mjs";
import { tellLogins } from "./logins.mjs";
import { separatePorts } from "./two_ports.mjs";

const {
  DataType, MessageSecurityMode, OPCUACertificateManager, OPCUAServer, SecurityPolicy, ServiceFault, StatusCodes,
  VariantArrayType, nodesets,
} = opcua;

const [port, folder, types, ...options] = process.argv.slice(2);

const certificates =
  new OPCUACertificateManager({ rootFolder: join(folder, "server"), automaticallyAcceptUnknownCertificate: true });

const hostname = "machine.invalid"; // of another network: it is reached by the name that the client knows
const securityPolicies = [
  SecurityPolicy.None, SecurityPolicy.Basic256Sha256, SecurityPolicy.Aes128_Sha256_RsaOaep,
  SecurityPolicy.Aes256_Sha256_RsaPss,
];
const signing = options.find((each) => each.startsWith("signing="))?.slice("signing=".length);

const server = new OPCUAServer({
  port: Number(port),
  hostname,
  nodeset_filename: [nodesets.standard, types],
  certificateFile: join(folder, "peer.pem"),
  privateKeyFile: join(folder, "peer_key.pem"),
  serverInfo: { applicationUri: "urn:interop:peer" },
  serverCertificateManager: certificates,
  userCertificateManager: certificates,
  securityPolicies,
  securityModes: [MessageSecurityMode.None, MessageSecurityMode.Sign, MessageSecurityMode.SignAndEncrypt],
  alternateEndpoints: signing === undefined ? []
    : [{ port: Number(signing), hostname, securityPolicies, securityModes: [MessageSecurityMode.Sign] }],
  allowAnonymous: true,
  userManager: { isValidUser: (name, password) => name === "operator" && password === "a pass phrase" },
  serverCapabilities: {
    minSupportedSampleRate: 0, // or node-opcua tells of the last change only in each so many milliseconds
    operationLimits: {
      maxNodesPerRead: 100, maxNodesPerWrite: 50, maxNodesPerBrowse: 20, maxMonitoredItemsPerCall: 30,
      maxNodesPerTranslateBrowsePathsToNodeIds: 10,
    },
  },
});

function answerWith(serviceResult, message, channel) {
  const { requestHandle } = message.request.requestHeader;
  const responseHeader = { requestHandle, serviceResult, timestamp: new Date() };
  channel.send_response("MSG", new ServiceFault({ responseHeader }), message, () => {});
}

/** No more references in one answer than this: the rest is for BrowseNext. */
function limitBrowse(count) {
  const browse = server._on_BrowseRequest.bind(server);
  server._on_BrowseRequest = (message, channel) => {
    message.request.requestedMaxReferencesPerNode = count;
    browse(message, channel);
  };
}

let behaviour = []; // what the last line of standard input says

/** While it behaves like that, it has no such service. */
function leaveOut(service, option) {
  const serve = server[`_on_${service}Request`].bind(server);
  server[`_on_${service}Request`] = (message, channel) =>
    behaviour.includes(option) ? answerWith(StatusCodes.BadServiceUnsupported, message, channel) : serve(message, channel);
}

/** While it behaves like that, no session outlives its channel, but its subscriptions do. */
function forgetSessions() {
  const activate = server._on_ActivateSessionRequest.bind(server);
  server._on_ActivateSessionRequest = (message, channel) => {
    const session = server.getSession(message.request.requestHeader.authenticationToken);
    const isLost =
      behaviour.includes("forget-sessions") && session?.status === "active" && session.channel !== channel;
    isLost ? answerWith(StatusCodes.BadSessionIdInvalid, message, channel) : activate(message, channel);
  };
}

/** Follows the lines of standard input; resolves with the first one. */
const obey = () =>
  new Promise((resolve) => {
    createInterface({ input: process.stdin }).on("close", () => process.exit()).on("line", (line) => {
      behaviour = line.split(" ");
      process.stdout.write(`behaves: ${line}\n`);
      resolve();
    });
  });

function addVariables(ns, machine) {
  const add = (name, dataType, value, more = {}) =>
    ns.addVariable({
      browseName: name, nodeId: `s=${name}`, componentOf: machine, dataType, value: { dataType, value }, ...more,
    });
  const counter = add("Counter", DataType.Int32, 0);
  let count = (Math.floor(Date.now() / 1_000) % 1_000_000) * 1_000; // more than the server before it had
  setInterval(() => counter.setValueFromSource({ dataType: DataType.Int32, value: ++count }), 50);
  add("Setpoint", DataType.Double, 21.5);
  add("Name", DataType.String, "Press \u{1b}[31m4");
  add("Serial", DataType.String, "P-4", { accessLevel: "CurrentRead", userAccessLevel: "CurrentRead" });
  const recipe = { dataType: DataType.Int16, arrayType: VariantArrayType.Array, value: new Int16Array([1, 2, 3, 4]) };
  add("Recipe", DataType.Int16, null, { valueRank: 1, value: recipe });
  const many = ns.addObject({
    browseName: "Many", nodeId: "s=Many", componentOf: machine, typeDefinition: "FolderType",
  });
  for (let i = 0; i < 300; ++i) add(`V${i}`, DataType.UInt32, i, { componentOf: undefined, organizedBy: many });
}

function addStructures(ns, machine) {
  const space = ns.addressSpace;
  const part = space.findDataType("Part", space.getNamespaceIndex("urn:interop:types"));
  const add = (name, fields) =>
    ns.addVariable({
      browseName: name, nodeId: `s=${name}`, componentOf: machine, dataType: part,
      value: { dataType: DataType.ExtensionObject, value: space.constructExtensionObject(part, fields) },
    });
  const fields = { serial: "P-4711", grade: 1, size: { width: 2.5, height: 4 }, holes: [3, 5, 8] };
  add("Part", { ...fields, note: "drilled" });
  add("Blank", { ...fields, grade: 0, holes: [] }); // without the optional field
}

function addMethod(ns, machine) {
  const multiply = ns.addMethod(machine, {
    browseName: "Multiply", nodeId: "s=Multiply",
    inputArguments: ["a", "b"].map((name) => ({ name, dataType: DataType.Double })),
    outputArguments: [{ name: "product", dataType: DataType.Double }],
  });
  multiply.bindMethod(async ([a, b], _context) => ({
    statusCode: StatusCodes.Good, outputArguments: [{ dataType: DataType.Double, value: a.value * b.value }],
  }));
}

function raiseEvents(ns, machine) {
  const type = ns.addEventType({ browseName: "MachineEvent", subtypeOf: "BaseEventType" });
  let raised = 0;
  setInterval(() => {
    ++raised;
    machine.raiseEvent(type, {
      sourceNode: { dataType: DataType.NodeId, value: machine.nodeId },
      message: { dataType: DataType.LocalizedText, value: { text: `event ${raised}` } },
      severity: { dataType: DataType.UInt16, value: raised % 2 ? 800 : 200 },
    });
  }, 200);
}

const firstLine = obey();
forgetSessions();
leaveOut("TransferSubscriptions", "refuse-transfer");
leaveOut("CreateSubscription", "without-subscriptions");
tellLogins(server);
limitBrowse(50);
separatePorts(server, Number(port));
await server.initialize();
if (options.includes("later")) {
  process.stdout.write("loaded\n");
  await firstLine;
}
const space = server.engine.addressSpace;
const ns = space.registerNamespace("urn:interop:machine");
const machine = ns.addObject({
  browseName: "Machine", nodeId: "s=Machine", organizedBy: space.rootFolder.objects, eventNotifier: 1,
  notifierOf: space.rootFolder.objects.server,
});
addVariables(ns, machine);
addStructures(ns, machine);
addMethod(ns, machine);
raiseEvents(ns, machine);
await server.start();
process.stdout.write("ready\n");
