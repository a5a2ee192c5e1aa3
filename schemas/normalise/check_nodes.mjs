// Compares the nodes of namespace 0 with ns0_nodes.csv, column by column.
import { readFileSync } from "node:fs";
import { forwardReferences } from "./check_reader.mjs";

const classes = {
  O: "UAObject",
  V: "UAVariable",
  M: "UAMethod",
  OT: "UAObjectType",
  VT: "UAVariableType",
  DT: "UADataType",
  RT: "UAReferenceType",
};
// DataTypeDescriptionType, DataTypeDictionaryType: deprecated, not in schemas/.
const dictionaryTypes = [69, 72];

/** Rows of a CSV with a header line as objects; quotes as in RFC 4180. */
function readCsv(file) {
  const cells = [[]];
  for (const [, quoted, plain, end] of readFileSync(file, "utf8").matchAll(
    /(?:"((?:[^"]|"")*)"|([^",\n\r]*))(,|\r?\n|$)/g,
  )) {
    cells.at(-1).push(quoted === undefined ? plain : quoted.replace(/""/g, '"'));
    if (end !== ",") cells.push([]);
  }
  const [header, ...rows] = cells.filter((row) => row.length > 1);
  return rows.map((row) => Object.fromEntries(header.map((name, i) => [name, row[i] ?? ""])));
}

const referencesOf = (row) => row.References.split(" ").filter(Boolean);
const typeOf = (row) =>
  Number(
    referencesOf(row)
      .find((r) => r.startsWith("40>"))
      ?.slice(3),
  );

/** Without the encodings in XML and JSON, the type dictionaries and what belongs to them. */
function keptRows(rows) {
  const dropped = new Set();
  for (const row of rows) {
    const otherEncoding = typeOf(row) === 76 && row.BrowseName !== "Default Binary";
    if (otherEncoding || dictionaryTypes.includes(typeOf(row))) dropped.add(row.NodeId);
  }
  for (const row of rows.filter((r) => dropped.has(r.NodeId))) {
    for (const reference of referencesOf(row)) {
      const [type, target] = reference.split(">");
      if (type === "46" || type === "47") dropped.add(target);
    }
  }
  return rows.filter((row) => !dropped.has(row.NodeId));
}

/** A value as in the facts: XML children become members, those of one name an array. */
function jsonOf(element) {
  if (element.children.length === 0) return element.text;
  const members = new Map();
  for (const child of element.children) {
    members.set(child.name, [...(members.get(child.name) ?? []), jsonOf(child)]);
  }
  const [first] = members.values();
  if (members.size === 1 && first.length > 1) return first;
  return Object.fromEntries(
    [...members].map(([name, list]) => [name, list.length === 1 ? list[0] : list]),
  );
}

function fieldOf({ attributes: f }) {
  if (f.Value !== undefined) return `${f.Name}=${f.Value}`;
  const marks = (f.IsOptional === "true" ? "?" : "") + (f.AllowSubTypes === "true" ? "*" : "");
  return `${f.Name}:${(f.DataType ?? "i=24").slice(2)}${f.ValueRank === "1" ? "[]" : ""}${marks}`;
}

function fieldsOf(node) {
  const { attributes, children } = node.definition ?? { attributes: {}, children: [] };
  const kind =
    attributes.IsUnion === "true" ? ["U"] : attributes.IsOptionSet === "true" ? ["B"] : [];
  return [...kind, ...children.map(fieldOf)].join(";");
}

const flag = (value) => (value === "true" ? "1" : "");
const unless = (value, usual) => (value === undefined || value === usual ? "" : value);

const columns = {
  Class: (node) => Object.keys(classes).find((key) => classes[key] === node.class),
  BrowseName: (node) => node.BrowseName,
  DisplayName: (node) => node.displayName,
  DataType: (node) => unless(node.DataType?.slice(2), ""),
  ValueRank: (node) => unless(node.ValueRank, "-1"),
  ArrayDim: (node) => unless(node.ArrayDimensions, ""),
  AccessLevel: (node) => unless(node.AccessLevel, "1"),
  IsAbstract: (node) => flag(node.IsAbstract),
  Symmetric: (node) => flag(node.Symmetric),
  InverseName: (node) => node.inverseName,
  Fields: fieldsOf,
  Value: (node) => (node.value ? `${node.value.name}:${JSON.stringify(jsonOf(node.value))}` : ""),
};

function checkNode(node, row, report) {
  for (const [column, valueOf] of Object.entries(columns)) {
    const found = valueOf(node);
    if (found !== row[column])
      report(
        `${node.file}: i=${node.id} ${row.BrowseName}`,
        column,
        `"${found}"`,
        `"${row[column]}"`,
      );
  }
}

function checkReferences(nodes, rows, report) {
  const found = forwardReferences(nodes);
  const kept = new Set(rows.map((row) => row.NodeId));
  for (const row of rows) {
    const expected = new Set(referencesOf(row).filter((r) => kept.has(r.split(">")[1])));
    const actual = found.get(Number(row.NodeId)) ?? new Set();
    const where = `${nodes.get(Number(row.NodeId))?.file}: i=${row.NodeId} ${row.BrowseName}`;
    for (const r of expected) if (!actual.has(r)) report(where, "reference", "none", r);
    for (const r of actual) if (!expected.has(r)) report(where, "reference", r, "none");
  }
}

/** Reports every difference; answers how many nodes were compared. */
export function checkNodes(nodes, file, report) {
  const rows = keptRows(readCsv(file));
  const expected = new Set(rows.map((row) => Number(row.NodeId)));
  for (const row of rows) {
    const node = nodes.get(Number(row.NodeId));
    if (node) checkNode(node, row, report);
    else report(`i=${row.NodeId} ${row.BrowseName}`, "node", "none", classes[row.Class]);
  }
  for (const node of nodes.values()) {
    if (!expected.has(node.id))
      report(`${node.file}: i=${node.id} ${node.BrowseName}`, "node", node.class, "none");
  }
  checkReferences(nodes, rows, report);
  return rows.length;
}
