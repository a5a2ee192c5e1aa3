// node check_companion.mjs <schemas/companion> <reference folder>...: compares each file with the
// published NodeSet2 file of the same name, fact by fact, without what normalise/ has in common
// with it. 77 if no folder has a reference.
import { existsSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { readPlainXml } from "./plain_xml.mjs";

const [companions, ...folders] = process.argv.slice(2);
const childrenOf = (element, name) => element?.children.filter((c) => c.name === name) ?? [];
const childOf = (element, name) => childrenOf(element, name)[0];
const textOf = (element, name) => childOf(element, name)?.text.trim() ?? "";

const usual = {
  IsAbstract: "false",
  Symmetric: "false",
  DataType: "i=24",
  ValueRank: "-1",
  ArrayDimensions: "",
  AccessLevel: "1",
  MinimumSamplingInterval: "0",
  Historizing: "false",
  EventNotifier: "0",
  ContainsNoLoops: "false",
};
const fieldUsual = {
  Name: "",
  Value: "",
  DataType: "i=24",
  ValueRank: "-1",
  ArrayDimensions: "",
  MaxStringLength: "0",
  IsOptional: "false",
  AllowSubTypes: "false",
};

/** Type dictionaries and the encodings in XML and JSON, which schemas/ leaves out. */
function leftOut(elements, resolve) {
  const typeOf = (element) =>
    childrenOf(childOf(element, "References"), "Reference")
      .filter((r) => resolve(r.attributes.ReferenceType) === "i=40")
      .map((r) => resolve(r.text.trim()))[0];
  const out = new Set();
  for (const element of elements) {
    const isEncoding = typeOf(element) === "i=76";
    const isOther = isEncoding && element.attributes.BrowseName !== "Default Binary";
    if (isOther || ["i=69", "i=72"].includes(typeOf(element)))
      out.add(element.attributes.NodeId);
  }
  for (const element of elements) {
    for (const r of childrenOf(childOf(element, "References"), "Reference")) {
      const isPart = ["i=46", "i=47"].includes(resolve(r.attributes.ReferenceType));
      if (isPart && r.attributes.IsForward === "false" && out.has(resolve(r.text.trim())))
        out.add(element.attributes.NodeId);
    }
  }
  return out;
}

function valueOf(element) {
  if (!element) return "";
  const inner = element.children
    .filter((c) => c.name !== "Description" && c.name !== "Documentation")
    .map(valueOf);
  return `${element.name.replace(/^\w+:/, "")}(${inner.join(",") || element.text.trim()})`;
}

/** Each fact as one line of text. */
function factsOf(file) {
  const root = readPlainXml(file);
  const aliases = new Map(
    childrenOf(childOf(root, "Aliases"), "Alias").map((a) => [a.attributes.Alias, a.text.trim()]),
  );
  const resolve = (id) => aliases.get(id) ?? id;
  const attributeOf = ({ attributes }, name, standard) =>
    name === "DataType" ? resolve(attributes[name] ?? standard) : (attributes[name] ?? standard);
  const elements = root.children.filter((e) => e.attributes.NodeId);
  const out = leftOut(elements, resolve);
  const facts = new Set();
  for (const uri of childrenOf(childOf(root, "NamespaceUris"), "Uri")) facts.add(`uri ${uri.text}`);
  for (const element of elements) {
    const { NodeId: id, BrowseName: name } = element.attributes;
    if (out.has(id)) continue;
    facts.add(`${id} is a ${element.name} called ${name}`);
    facts.add(`${id} shows ${textOf(element, "DisplayName") || name.replace(/^\d+:/, "")}`);
    facts.add(`${id} inverse ${textOf(element, "InverseName")}`);
    for (const [attribute, standard] of Object.entries(usual))
      facts.add(`${id} ${attribute} ${attributeOf(element, attribute, standard)}`);
    for (const r of childrenOf(childOf(element, "References"), "Reference")) {
      const [type, target] = [resolve(r.attributes.ReferenceType), resolve(r.text.trim())];
      if (out.has(target)) continue;
      const [from, to] = r.attributes.IsForward === "false" ? [target, id] : [id, target];
      facts.add(`${from} ${type}> ${to}`);
    }
    const definition = childOf(element, "Definition");
    const kind = ["IsUnion", "IsOptionSet"].map((a) => definition?.attributes[a] ?? "false");
    childrenOf(definition, "Field").forEach((field, i) => {
      const parts = Object.entries(fieldUsual).map(([a, standard]) =>
        attributeOf(field, a, standard),
      );
      facts.add(`${id} ${kind} field ${i} ${parts}`);
    });
    facts.add(`${id} value ${valueOf(childOf(element, "Value")?.children[0])}`);
  }
  return facts;
}

let compared = 0;
let differences = 0;
for (const name of readdirSync(companions).filter((file) => file.endsWith(".xml"))) {
  const reference = folders.map((folder) => join(folder, name)).find(existsSync);
  if (!reference) {
    console.log(`${name}: no reference file, not compared`);
    continue;
  }
  const [found, expected] = [factsOf(join(companions, name)), factsOf(reference)];
  const wrong = [
    ...[...expected].filter((fact) => !found.has(fact)).map((fact) => `missing: ${fact}`),
    ...[...found].filter((fact) => !expected.has(fact)).map((fact) => `not so: ${fact}`),
  ];
  for (const line of wrong.slice(0, 50)) console.error(`${name}: ${line}`);
  console.log(`${name}: ${expected.size} facts compared, ${wrong.length} differences`);
  compared += 1;
  differences += wrong.length;
}
process.exit(compared === 0 ? 77 : differences === 0 ? 0 : 1);
