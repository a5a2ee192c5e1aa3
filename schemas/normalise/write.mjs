// Writes nodes as NodeSet2 XML: facts only, one element a line, in a fixed order.
import { attributes, escape } from "./xml.mjs";

const typesNamespace = "http://opcfoundation.org/UA/2008/02/Types.xsd";
const descriptive = new Set(["Description", "Documentation"]);

const idText = (id) => (typeof id === "number" ? `i=${id}` : id);

function valueXml(element, isRoot) {
  const open = `<${element.name}${isRoot ? ` xmlns="${typesNamespace}"` : ""}`;
  const inner = element.children
    .filter((c) => !descriptive.has(c.name))
    .map((c) => valueXml(c, false))
    .join("");
  const text = element.children.length === 0 ? escape(element.text) : "";
  return inner + text === "" ? `${open}/>` : `${open}>${inner}${text}</${element.name}>`;
}

function fieldXml(field) {
  const list = attributes([
    ["Name", field.name],
    ["Value", field.value],
    ["DataType", field.dataType],
    ["ValueRank", field.valueRank],
    ["ArrayDimensions", field.arrayDimensions],
    ["MaxStringLength", field.maxStringLength],
    ["IsOptional", field.optional ? "true" : ""],
    ["AllowSubTypes", field.allowSubTypes ? "true" : ""],
  ]);
  return `   <Field${list}/>\n`;
}

function definitionXml(node) {
  if (!node.definition) return "";
  const { union, optionSet, fields } = node.definition;
  const list = attributes([
    ["Name", node.browseName],
    ["IsUnion", union ? "true" : ""],
    ["IsOptionSet", optionSet ? "true" : ""],
  ]);
  return `  <Definition${list}>\n${fields.map(fieldXml).join("")}  </Definition>\n`;
}

function referencesXml(node) {
  const lines = node.references.map(
    ({ type, forward, target }) =>
      `   <Reference${attributes([
        ["ReferenceType", idText(type)],
        ["IsForward", forward ? "" : "false"],
      ])}>${escape(idText(target))}</Reference>\n`,
  );
  return lines.length === 0 ? "" : `  <References>\n${lines.join("")}  </References>\n`;
}

function permissionsXml({ rolePermissions }) {
  if (!rolePermissions) return "";
  const lines = rolePermissions.map(
    ({ role, permissions }) =>
      `   <RolePermission${attributes([["Permissions", permissions]])}>` +
      `${escape(idText(role))}</RolePermission>\n`,
  );
  return `  <RolePermissions>\n${lines.join("")}  </RolePermissions>\n`;
}

function nodeXml(node) {
  const list = attributes([
    ["NodeId", idText(node.id)],
    ["BrowseName", node.browseName],
    ...Object.entries(node.attributes),
  ]);
  const name = node.browseName.replace(/^\d+:/, "");
  const display =
    node.displayName && node.displayName !== name
      ? `  <DisplayName>${escape(node.displayName)}</DisplayName>\n`
      : "";
  const inverse = node.inverseName
    ? `  <InverseName>${escape(node.inverseName)}</InverseName>\n`
    : "";
  const value = node.value ? `  <Value>${valueXml(node.value, true)}</Value>\n` : "";
  const content =
    display + referencesXml(node) + permissionsXml(node) + inverse + definitionXml(node) + value;
  return ` <${node.element}${list}>\n${content} </${node.element}>\n`;
}

/** By namespace, numbers by their value, texts after them. */
function compareIds(a, b) {
  const parts = (id) => {
    const [, ns = 0, number = Infinity] = /^(?:ns=(\d+);)?(?:i=(\d+))?/.exec(idText(id));
    return [Number(ns), Number(number)];
  };
  const [x, y] = [parts(a), parts(b)];
  const difference = x[0] - y[0] || (x[1] === y[1] ? 0 : x[1] - y[1]);
  return difference || (idText(a) < idText(b) ? -1 : 1);
}

const modelAttributes = (model) =>
  attributes(
    ["ModelUri", "Version", "PublicationDate", "ModelVersion"].map((name) => [name, model[name]]),
  );

function namespacesXml(namespaces) {
  if (namespaces.length === 0) return "";
  const uris = namespaces.map((uri) => `  <Uri>${escape(uri)}</Uri>\n`).join("");
  return ` <NamespaceUris>\n${uris} </NamespaceUris>\n`;
}

function modelXml(model, required) {
  if (required.length === 0) return `  <Model${modelAttributes(model)}/>\n`;
  const models = required.map((each) => `   <RequiredModel${modelAttributes(each)}/>\n`).join("");
  return `  <Model${modelAttributes(model)}>\n${models}  </Model>\n`;
}

/** One NodeSet2 document of `model` with `nodes` in the order of their ids. */
export function nodeSetXml(nodes, model, required = [], namespaces = []) {
  const sorted = [...nodes].sort((a, b) => compareIds(a.id, b.id));
  return `<?xml version="1.0" encoding="utf-8"?>
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
${namespacesXml(namespaces)} <Models>
${modelXml(model, required)} </Models>
${sorted.map(nodeXml).join("")}</UANodeSet>
`;
}
