// The reduced sizes of namespace 0: what is asked for by name, closed over what it needs.
import { typeDefinitionOf } from "./nodeset.mjs";

const hasSubtype = 45;
const components = new Set([46, 47, 49]); // HasProperty, HasComponent, HasOrderedComponent
const hierarchical = new Set([33, 34, 35, 36, 44, 46, 47, 48, 49, hasSubtype]);
const hasEncoding = 38;

const builtInTypes = Array.from({ length: 25 }, (_, i) => i + 1).concat([26, 27, 28, 29, 290, 294, 295, 296, 338, 852]);

const micro = {
  nodes: [
    ...builtInTypes,
    31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 44, 45, 46, 47, 48, 49, // references
    84, 85, 86, 87, 88, 89, 90, 91, // folders
    58, 61, 62, 63, 68, 2004, 2013, 2137, 3051, // types
    2253, 2254, 2255, 2267, 2994, 2268, 2269, 2271, 2272, 2735, 2736, 2737, 11702, 11703, 11704, 12885,
    2296, 3709, 2295, 2033, 2034, 11715,
  ],
  trees: [2256, 11704],
};

const diagnostics = [
  2020, 2026, 2029, 2150, 2164, 2165, 2171, 2172, 2196, 2197, 2243, 2244, 2274, 12816,
];
const embedded = {
  nodes: [...micro.nodes, 2012, 2330, 11492, 12873, 11616, 11645],
  trees: [...micro.trees, 2004, 2013, 2033, 2034, 11564, 2137, 3051, 2253, 2138, ...diagnostics, 11616, 11645],
  allOf: ["UAReferenceType"],
  types: ["BaseEventType", "ModellingRuleType", "DataTypeEncodingType", "OptionSetType"],
};
const standard = {
  ...embedded,
  types: [
    ...embedded.types, "AuditEventType", "SystemEventType", "BaseModelChangeEventType", "SemanticChangeEventType",
    "EventQueueOverflowEventType", "ProgressEventType", "DataItemType", "SelectionListType", "AggregateFunctionType",
    "NamespacesType", "NamespaceMetadataType", "ServerRedundancyType", "AddressSpaceFileType",
  ],
  subtypes: ["AuditEventType", "SystemEventType", "BaseModelChangeEventType", "DataItemType"],
};
/** Parts of the Server object that only larger servers have: configuration, PubSub, logs, ... */
const optionalParts = new Set([
  12637, 14443, 15668, 15669, 23518, 17594, 17634, 24226, 25726, 31375, 32416, 19380, 15606, 16290, 16301,
]);

function childrenMap(nodes) {
  const children = new Map();
  const add = (from, type, to) => {
    if (!children.has(from)) children.set(from, []);
    children.get(from).push({ type, to });
  };
  for (const node of nodes.values()) {
    for (const r of node.references) r.forward ? add(node.id, r.type, r.target) : add(r.target, r.type, node.id);
  }
  return children;
}

function addTree(nodes, children, id, list, depth) {
  if (!nodes.has(id) || optionalParts.has(id) || depth > 8) return;
  list.add(id);
  for (const { type, to } of children.get(id) ?? []) {
    if (components.has(type)) addTree(nodes, children, to, list, depth + 1);
  }
}

function addTypes(nodes, children, wanted, list) {
  const byName = new Map([...nodes.values()].filter((n) => /Type$/.test(n.element)).map((n) => [n.browseName, n.id]));
  const visit = (id, withSubtypes) => {
    addTree(nodes, children, id, list, 0);
    if (!withSubtypes) return;
    for (const { type, to } of children.get(id) ?? []) if (type === hasSubtype) visit(to, true);
  };
  for (const name of wanted.types ?? []) {
    if (byName.has(name)) visit(byName.get(name), wanted.subtypes?.includes(name) ?? false);
  }
}

/** What a node cannot stand without: types, a parent, modelling rules, its properties. */
function needs(nodes, children, id) {
  const node = nodes.get(id);
  const needed = [];
  const isType = /Type$/.test(node.element);
  const parent = (children.inverse.get(id) ?? []).find(({ type }) => (isType ? type === hasSubtype : hierarchical.has(type)));
  if (parent) needed.push(parent.to);
  if (typeDefinitionOf(node)) needed.push(typeDefinitionOf(node));
  if (node.attributes.DataType) needed.push(Number(node.attributes.DataType.slice(2)));
  for (const { type, to } of children.get(id) ?? []) {
    const isEnumText = node.element === "UADataType" && type === 46;
    if (isEnumText || (node.element === "UADataType" && type === hasEncoding) || (node.element === "UAMethod" && type === 46)) {
      needed.push(to);
    }
    if (type === 37) needed.push(to);
  }
  for (const field of node.definition?.fields ?? []) if (field.dataType) needed.push(Number(field.dataType.slice(2)));
  return needed;
}

function close(nodes, children, list) {
  const open = [...list];
  while (open.length !== 0) {
    for (const id of needs(nodes, children, open.pop())) {
      if (nodes.has(id) && !list.has(id)) {
        list.add(id);
        open.push(id);
      }
    }
  }
}

/** Sorted node ids by size name. */
export function sizeLists(nodes) {
  const children = childrenMap(nodes);
  children.inverse = new Map();
  for (const [from, list] of children) {
    for (const { type, to } of list) {
      if (!children.inverse.has(to)) children.inverse.set(to, []);
      children.inverse.get(to).push({ type, to: from });
    }
  }
  const result = {};
  for (const [name, wanted] of Object.entries({ micro, embedded, standard })) {
    const list = new Set(wanted.nodes.filter((id) => nodes.has(id)));
    for (const id of wanted.trees) addTree(nodes, children, id, list, 0);
    for (const node of nodes.values()) if (wanted.allOf?.includes(node.element)) list.add(node.id);
    addTypes(nodes, children, wanted, list);
    close(nodes, children, list);
    result[name] = [...list].sort((a, b) => a - b);
  }
  return result;
}
