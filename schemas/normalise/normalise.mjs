// node normalise.mjs <node_modules> [output]: makes schemas/ from the published packages.
import { mkdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { readNodeSet, withoutDictionaries } from "./nodeset.mjs";
import { readServiceTypes } from "./services.mjs";
import { sizeLists } from "./sizes.mjs";
import { nodeSetXml } from "./write.mjs";

const [given, output = join(dirname(fileURLToPath(import.meta.url)), "..")] = process.argv.slice(2);
if (!given) {
  console.error("usage: node normalise.mjs <node_modules> [output folder]");
  process.exit(2);
}
const modules = resolve(given);
const require = createRequire(`${modules}/index.js`);
const constants = require("node-opcua-constants");
const folder = join(modules, "node-opcua-nodesets", "nodesets");

const write = (name, text) => writeFileSync(join(output, name), text);

const source = readNodeSet(join(folder, "Opc.Ua.NodeSet2.xml"), modules);
const nodes = withoutDictionaries(source.nodes);
const services = readServiceTypes(join(folder, "Opc.Ua.Types.bsd"), modules, nodes, constants);

/** Files by node class; the variables are too many for one. */
function partOf(node) {
  if (/Type$/.test(node.element)) return "Types";
  return node.element === "UAVariable" ? `Variables${node.id < 16000 ? 1 : 2}` : "Objects";
}
const parts = new Map();
for (const node of nodes.values()) {
  if (!parts.has(partOf(node))) parts.set(partOf(node), []);
  parts.get(partOf(node)).push(node);
}
for (const [part, list] of parts)
  write(`Opc.Ua.${part}.NodeSet2.xml`, nodeSetXml(list, source.model));
write("Opc.Ua.Services.NodeSet2.xml", nodeSetXml(services.values(), source.model));

mkdirSync(join(output, "sizes"), { recursive: true });
for (const [name, ids] of Object.entries(sizeLists(nodes)))
  write(`sizes/${name}.txt`, ids.join("\n") + "\n");

const statusCodes = require("node-opcua-status-code").StatusCodes;
const statusRows = Object.values(statusCodes)
  // Not those with info bits, which are the package's own: "Good#InfoTypeDataValue|Overflow".
  .filter((code) => typeof code?.value === "number" && /^\w+$/.test(code.name))
  .map((code) => [code.name.replace(/^(Good|Uncertain|Bad)(?=[A-Z])/, "$1_"), code.value])
  .sort((a, b) => a[1] - b[1] || (a[0] < b[0] ? -1 : 1))
  .map(([name, value]) => `${name},0x${value.toString(16).toUpperCase().padStart(8, "0")}\n`);
write("StatusCode.csv", statusRows.join(""));

const attributeIds = require("node-opcua-basic-types").AttributeIds;
const attributeRows = Object.entries(attributeIds)
  .filter(([name, id]) => typeof id === "number" && id >= 1 && id <= 27)
  .sort((a, b) => a[1] - b[1])
  .map(([name, id]) => `${name},${id}\n`);
write("AttributeId.csv", attributeRows.join(""));

const groups = [
  "DataType",
  "ReferenceType",
  "ObjectType",
  "VariableType",
  "Object",
  "Variable",
  "Method",
];
const isKept = (id) => typeof id === "number" && (nodes.has(id) || services.has(id));
const idRows = groups.flatMap((group) =>
  Object.entries(constants[`${group}Ids`])
    .filter(([, id]) => isKept(id))
    .map(([name, id]) => [id, `${name},${id},${group}\n`]),
);
write(
  "NodeIds.csv",
  idRows
    .sort((a, b) => a[0] - b[0])
    .map(([, row]) => row)
    .join(""),
);
console.log(`${nodes.size} nodes, ${services.size} nodes of service types`);
console.log(`${idRows.length} ids, ${statusRows.length} status codes`);
