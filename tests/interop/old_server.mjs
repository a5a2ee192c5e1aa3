// A node-opcua server as they were before OPC UA 1.04: no node has a DataTypeDefinition, and what lies in structures
// is said by a type dictionary. It ends with its standard input; FOLDER has its certificate.
// usage: node old_server.mjs PORT FOLDER unused [small=PORT]
// small: it is at this port, too, where it has room for one connection
import { createRequire } from "node:module";
import { join } from "node:path";
import opcua from "./opcua.mjs";
import { tellLogins } from "./logins.mjs";
import { separatePorts } from "./two_ports.mjs";

const {
  AttributeIds, DataType, DataValue, MessageSecurityMode, OPCUACertificateManager, OPCUAServer, SecurityPolicy,
  StatusCodes, Variant, nodesets,
} = opcua;

const { OpaqueStructure } = createRequire(import.meta.url)("node-opcua-extension-object");

/** Bytes in an ExtensionObject, which node-opcua copies by giving its constructor another one. */
class Raw extends OpaqueStructure {
  constructor(from, bytes) {
    from instanceof Raw ? super(from.nodeId, from.buffer) : super(from, bytes);
  }
}

const [port, folder, , ...options] = process.argv.slice(2);
const small = options.find((each) => each.startsWith("small="))?.slice("small=".length);

const certificates =
  new OPCUACertificateManager({ rootFolder: join(folder, "server"), automaticallyAcceptUnknownCertificate: true });

const endpoint = (number) => ({
  port: Number(number),
  hostname: "machine.invalid", // of another network: it is reached by the name that the client knows
  securityPolicies: [SecurityPolicy.None, SecurityPolicy.Basic256Sha256],
  securityModes: [MessageSecurityMode.None, MessageSecurityMode.SignAndEncrypt],
  allowAnonymous: true,
});

const server = new OPCUAServer({
  ...endpoint(port),
  alternateEndpoints: small === undefined ? [] : [endpoint(small)],
  nodeset_filename: [nodesets.standard],
  certificateFile: join(folder, "peer.pem"),
  privateKeyFile: join(folder, "peer_key.pem"),
  serverInfo: { applicationUri: "urn:interop:peer" },
  serverCertificateManager: certificates,
  userCertificateManager: certificates,
});

const uri = "urn:interop:old";
const dictionary = `<?xml version="1.0" encoding="utf-8"?>
<opc:TypeDictionary xmlns:opc="http://opcfoundation.org/BinarySchema/" xmlns:ua="http://opcfoundation.org/UA/"
    xmlns:tns="${uri}" TargetNamespace="${uri}" DefaultByteOrder="LittleEndian">
  <opc:Import Namespace="http://opcfoundation.org/UA/"/>
  <opc:EnumeratedType Name="Phase" LengthInBits="32">
    <opc:EnumeratedValue Name="Open" Value="0"/>
    <opc:EnumeratedValue Name="Closed" Value="4"/>
  </opc:EnumeratedType>
  <opc:StructuredType Name="Point" BaseType="ua:ExtensionObject">
    <opc:Field Name="X" TypeName="opc:Double"/>
    <opc:Field Name="Y" TypeName="opc:Double"/>
  </opc:StructuredType>
  <opc:StructuredType Name="Stroke" BaseType="ua:ExtensionObject">
    <opc:Field Name="Name" TypeName="opc:String"/>
    <opc:Field Name="Phase" TypeName="tns:Phase"/>
    <opc:Field Name="Allowed" TypeName="ua:Range"/>
    <opc:Field Name="NoOfPath" TypeName="opc:Int32"/>
    <opc:Field Name="Path" TypeName="tns:Point" LengthField="NoOfPath"/>
  </opc:StructuredType>
  <opc:StructuredType Name="Remark" BaseType="ua:ExtensionObject">
    <opc:Field Name="AuthorSpecified" TypeName="opc:Bit"/>
    <opc:Field Name="TextSpecified" TypeName="opc:Bit"/>
    <opc:Field Name="Reserved1" TypeName="opc:Bit" Length="30"/>
    <opc:Field Name="Author" TypeName="opc:CharArray" SwitchField="AuthorSpecified"/>
    <opc:Field Name="Text" TypeName="opc:CharArray" SwitchField="TextSpecified"/>
  </opc:StructuredType>
  <opc:StructuredType Name="Frame">
    <opc:Field Name="Bytes" TypeName="opc:Byte" Length="4"/>
  </opc:StructuredType>
</opc:TypeDictionary>`;

const int32 = (value) => { const b = Buffer.alloc(4); b.writeInt32LE(value); return b; };
const double = (value) => { const b = Buffer.alloc(8); b.writeDoubleLE(value); return b; };
const text = (value) => Buffer.concat([int32(Buffer.byteLength(value)), Buffer.from(value)]);

const bodies = {
  Stroke: Buffer.concat([
    text("down"), int32(4), double(-1), double(9.5), int32(2), double(1), double(2), double(3), double(4),
  ]),
  Remark: Buffer.concat([int32(2), text("too hot")]),
  Frame: Buffer.from([1, 2, 3, 4]),
};

/** No node has the attribute, as if the server were of 2016. */
function leaveOutDefinitions(space) {
  const prototype = Object.getPrototypeOf(space.findDataType("Structure"));
  const readAttribute = prototype.readAttribute;
  prototype.readAttribute = function (context, attribute, ...rest) {
    return attribute === AttributeIds.DataTypeDefinition
      ? new DataValue({ statusCode: StatusCodes.BadAttributeIdInvalid })
      : readAttribute.call(this, context, attribute, ...rest);
  };
}

function addDictionary(ns, space) {
  return ns.addVariable({
    browseName: "Old", nodeId: "s=dictionary", componentOf: space.findNode("i=93"),
    typeDefinition: "DataTypeDictionaryType", dataType: DataType.ByteString,
    value: { dataType: DataType.ByteString, value: Buffer.from(dictionary) },
  });
}

/** A DataType, its encoding, the description of that in the dictionary, and a Variable with a value. */
function addStructure(ns, space, owner, machine, name) {
  const type = ns.createDataType({ browseName: name, nodeId: `s=type ${name}`, isAbstract: false, subtypeOf: "Structure" });
  const encoding = ns.addObject({
    browseName: { name: "Default Binary", namespaceIndex: 0 }, nodeId: `s=encoding ${name}`,
    typeDefinition: "DataTypeEncodingType",
  });
  type.addReference({ referenceType: "HasEncoding", nodeId: encoding.nodeId, isForward: true });
  const description = ns.addVariable({
    browseName: name, nodeId: `s=description ${name}`, componentOf: owner, typeDefinition: "DataTypeDescriptionType",
    dataType: DataType.String, value: { dataType: DataType.String, value: name },
  });
  encoding.addReference({ referenceType: "HasDescription", nodeId: description.nodeId, isForward: true });
  const value = new Raw(encoding.nodeId, bodies[name]);
  ns.addVariable({
    browseName: `The${name}`, nodeId: `s=${name}`, componentOf: machine, dataType: type.nodeId,
    value: { get: () => new Variant({ dataType: DataType.ExtensionObject, value }) },
  });
}

tellLogins(server);
separatePorts(server, Number(port));
await server.initialize();
if (small !== undefined) {
  // As maxConnectionsPerEndpoint: 1, which would hold for both. The endpoints are there from initialize() on.
  const endpointAtSmall = server.endpoints.find((each) => each.port === Number(small));
  endpointAtSmall.maxConnections = 1;
}
const space = server.engine.addressSpace;
const ns = space.registerNamespace(uri);
const machine = ns.addObject({ browseName: "Machine", nodeId: "s=Machine", organizedBy: space.rootFolder.objects });
const owner = addDictionary(ns, space);
for (const name of Object.keys(bodies)) addStructure(ns, space, owner, machine, name);
leaveOutDefinitions(space);
await server.start();
process.stdin.resume().on("end", () => process.exit());
process.stdout.write("ready\n");
