// Compares structures, enumerations and option sets, resolved to the wire, with types.json.
import { readFileSync } from "node:fs";

const structure = 22;
const enumeration = 29;
const builtInNames = [
  "",
  "Boolean",
  "SByte",
  "Byte",
  "Int16",
  "UInt16",
  "Int32",
  "UInt32",
  "Int64",
  "UInt64",
  "Float",
  "Double",
  "String",
  "DateTime",
  "Guid",
  "ByteString",
  "XmlElement",
  "NodeId",
  "ExpandedNodeId",
  "StatusCode",
  "QualifiedName",
  "LocalizedText",
  "ExtensionObject",
  "DataValue",
  "Variant",
  "DiagnosticInfo",
];

/** The type hierarchy and the encodings of `nodes`. */
class Types {
  constructor(nodes) {
    this.nodes = new Map([...nodes].filter(([, node]) => node.class === "UADataType"));
    this.base = new Map();
    this.binaryId = new Map();
    for (const node of nodes.values()) {
      for (const { type, forward, target } of node.references) {
        const [from, to] = forward ? [node.id, target] : [target, node.id];
        if (type === 45) this.base.set(to, from);
        if (type === 38) this.binaryId.set(from, to);
      }
    }
  }

  isA(id, ancestor) {
    for (let at = id; at !== undefined; at = this.base.get(at)) if (at === ancestor) return true;
    return false;
  }

  isStructure(id) {
    return this.isA(id, structure);
  }

  /** Fields of the supertypes first. */
  allFields(node) {
    return node
      ? [...this.allFields(this.nodes.get(this.base.get(node.id))), ...ownFields(node)]
      : [];
  }

  /** Part 6, 5.1.2: the built-in type in whose form values of the data type are encoded. */
  builtIn(id) {
    if (this.isA(id, enumeration)) return "Int32";
    for (let at = id; at !== undefined; at = this.base.get(at)) {
      if (at === 26 || at === 27 || at === 28 || at === 24) return "Variant";
      if (at <= 25) return builtInNames[at];
    }
    return "none";
  }
}

const ownFields = (node) => node?.definition?.children ?? [];

/** Of the service types the facts have no supertypes: all fields are with the type itself. */
const isFlat = (expected) => expected.src.startsWith("bsd");

function wireType(types, { DataType = "i=24", AllowSubTypes }) {
  const id = Number(DataType.slice(2));
  if (types.isStructure(id)) {
    if (id === structure || AllowSubTypes === "true") return ["ExtensionObject", null];
    return ["struct", types.nodes.get(id).BrowseName];
  }
  if (AllowSubTypes === "true") return ["Variant", null];
  const ref =
    types.isA(id, enumeration) || types.nodes.get(id)?.definition
      ? types.nodes.get(id).BrowseName
      : null;
  return [types.builtIn(id), ref];
}

function checkFields(types, node, expected, report) {
  const where = `${node.file}: ${node.BrowseName}`;
  const fields = isFlat(expected) ? types.allFields(node) : ownFields(node);
  if (fields.length !== expected.fields.length) {
    report(where, "number of fields", fields.length, expected.fields.length);
    return;
  }
  fields.forEach(({ attributes }, i) => {
    const fact = expected.fields[i];
    const [type, ref] = wireType(types, attributes);
    const compare = (what, found, wanted) => {
      if (found !== wanted) report(`${where}.${fact.name}`, what, found, wanted);
    };
    compare("name", attributes.Name, fact.name);
    compare("wire type", type, fact.type);
    compare("type", ref, fact.ref);
    compare("array", attributes.ValueRank === "1", fact.array);
    compare("optional", attributes.IsOptional === "true", fact.optional);
  });
}

const nameOf = (types, id) => types.nodes.get(id)?.BrowseName ?? "none";

function checkStructure(types, node, expected, report) {
  const where = `${node.file}: ${node.BrowseName}`;
  const compare = (what, found, wanted) => {
    if (wanted !== undefined && found !== wanted) report(where, what, found, wanted);
  };
  const base = types.base.get(node.id);
  compare("id", node.id, expected.id);
  compare("Default Binary", types.binaryId.get(node.id) ?? null, expected.binaryId);
  compare("abstract", node.IsAbstract === "true", expected.abstract ?? undefined);
  if (!isFlat(expected))
    compare("supertype", base === structure ? null : nameOf(types, base), expected.base);
  if (node.definition)
    compare("union", node.definition.attributes.IsUnion === "true", expected.union);
  checkFields(types, node, expected, report);
}

function checkEnumeration(types, node, expected, report) {
  const where = `${node.file}: ${node.BrowseName}`;
  const found = ownFields(node)
    .map(({ attributes: f }) => `${f.Name}=${f.Value}`)
    .join(";");
  const wanted = Object.entries(expected.values)
    .map(([name, value]) => `${name}=${value}`)
    .join(";");
  if (node.id !== expected.id) report(where, "id", node.id, expected.id);
  if (types.builtIn(node.id) !== expected.builtin)
    report(where, "wire type", types.builtIn(node.id), expected.builtin);
  if (found !== wanted) report(where, "values", found, wanted);
}

/** Reports every difference; answers how many types were compared. */
export function checkTypes(nodes, file, report) {
  const types = new Types(nodes);
  const facts = JSON.parse(readFileSync(file, "utf8"));
  const byName = new Map([...types.nodes.values()].map((node) => [node.BrowseName, node]));
  const each = (list, check) => {
    for (const [name, expected] of Object.entries(list)) {
      if (expected.id === null) continue; // only in the binary schema, no DataType
      const node = byName.get(name);
      if (node) check(types, node, expected, report);
      else report(name, "data type", "none", `i=${expected.id}`);
    }
  };
  each(facts.structs, checkStructure);
  each(facts.enums, checkEnumeration);
  each(facts.simple, (_, node, expected) => {
    if (node.id !== expected.id)
      report(`${node.file}: ${node.BrowseName}`, "id", node.id, expected.id);
    const found = types.builtIn(node.id);
    if (found !== expected.builtin)
      report(`${node.file}: ${node.BrowseName}`, "wire type", found, expected.builtin);
  });
  const known = new Set([
    ...Object.keys(facts.structs),
    ...Object.keys(facts.enums),
    ...Object.keys(facts.simple),
  ]);
  for (const node of types.nodes.values()) {
    if (!known.has(node.BrowseName) && node.definition) {
      report(`${node.file}: ${node.BrowseName}`, "data type", "with a definition", "none");
    }
  }
  return known.size;
}
