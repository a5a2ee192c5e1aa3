// The reduced sizes of namespace 0: what is asked for, closed over what it needs.
import { typeDefinitionOf } from "./nodeset.mjs";

const hasSubtype = 45;
const hasProperty = 46;
const hasEncoding = 38;
const hasModellingRule = 37;
const components = new Set([hasProperty, 47, 49]); // HasComponent, HasOrderedComponent
const hierarchical = new Set([33, 34, 35, 36, 44, hasProperty, 47, 48, 49]);

const isType = (node) => /Type$/.test(node.element);

/**
 * Parts of the Server object and its types that no reduced size has. All are optional: UrisVersion,
 * LocalTime, RedundantServerArray; HistoryServerCapabilities, RoleSet, NamespaceFile, ServerLog;
 * what belongs to configuration, PubSub and dictionaries.
 */
const leftOut = new Set([
  15003, 15004, 17612, 17634, 11313, 32410, 11192, 2330, 15606, 16295, 11624, 19372, 12637, 14443,
  15668, 15669, 23518, 17594, 24226, 25726, 31375, 32416, 16290, 16301,
]);

const micro = {
  nodes: [
    ...Array.from({ length: 29 }, (_, i) => i + 1),
    290,
    294,
    295,
    296,
    338,
    852,
    884, // data types
    31,
    32,
    33,
    34,
    35,
    36,
    37,
    38,
    39,
    40,
    44,
    45,
    46,
    47,
    48,
    49, // reference types
    84,
    85,
    86,
    87,
    88,
    89,
    90,
    91, // folders
    58,
    61,
    62,
    63,
    68,
    2004,
    2013,
    2137,
    3051, // object and variable types
    2253,
    2268,
    2295,
    2296,
    2996,
    2997,
    11715, // Server and its objects
  ],
  trees: [2256, 11704], // ServerStatus, OperationLimits
  bareTypes: true,
};

const embedded = {
  nodes: micro.nodes,
  // Besides those of micro: ServerType and what it consists of, the diagnostics, the rules for
  // modelling, NamespacesType.
  trees: [
    ...micro.trees,
    2253,
    2004,
    2013,
    2033,
    2034,
    2137,
    2138,
    3051,
    11564,
    11616,
    11645,
    2020,
    2026,
    2029,
    2150,
    2164,
    2165,
    2171,
    2172,
    2196,
    2197,
    2243,
    2244,
  ],
  allOf: ["UAReferenceType"],
  types: ["BaseEventType", "ModellingRuleType", "DataTypeEncodingType", "OptionSetType"],
  // SetSubscriptionDurable, RequestServerStateChange
  without: [12746, 12749, 12883, 12886],
};

const standard = {
  ...embedded,
  types: [
    ...embedded.types,
    "EventQueueOverflowEventType",
    "ProgressEventType",
    "SelectionListType",
    "AggregateFunctionType",
    "TransitionVariableType",
    "FiniteTransitionVariableType",
  ],
  withSubtypes: [
    "AuditEventType",
    "SystemEventType",
    "BaseModelChangeEventType",
    "SemanticChangeEventType",
    "DataItemType",
  ],
  without: [],
};

/** References of each node in forward direction, and against it, as [{type, to}]. */
function referenceMaps(nodes) {
  const forward = new Map([...nodes.keys()].map((id) => [id, []]));
  const inverse = new Map([...nodes.keys()].map((id) => [id, []]));
  for (const node of nodes.values()) {
    for (const { type, forward: isForward, target } of node.references) {
      const [from, to] = isForward ? [node.id, target] : [target, node.id];
      if (forward.get(from).some((r) => r.type === type && r.to === to)) continue;
      forward.get(from).push({ type, to });
      inverse.get(to).push({ type, to: from });
    }
  }
  return { forward, inverse };
}

class Selection {
  constructor(nodes, { forward, inverse }, wanted) {
    Object.assign(this, { nodes, forward, inverse, ids: new Set() });
    this.bareTypes = wanted.bareTypes ?? false;
    this.without = new Set([...leftOut, ...(wanted.without ?? [])]);
  }

  add(id) {
    if (!this.nodes.has(id) || this.without.has(id) || this.ids.has(id)) return false;
    this.ids.add(id);
    return true;
  }

  /** A node with its properties and components, theirs and so on. */
  addTree(id, seen = new Set()) {
    if (seen.has(id) || this.without.has(id) || !this.nodes.has(id)) return;
    seen.add(id);
    this.add(id);
    for (const { type, to } of this.forward.get(id))
      if (components.has(type)) this.addTree(to, seen);
  }

  addType(id, withSubtypes) {
    this.addTree(id);
    if (!withSubtypes) return;
    for (const { type, to } of this.forward.get(id))
      if (type === hasSubtype) this.addType(to, true);
  }

  /** What a node cannot stand without. */
  needs(id) {
    const node = this.nodes.get(id);
    const isParent = isType(node)
      ? ({ type }) => type === hasSubtype
      : ({ type }) => hierarchical.has(type);
    const needed = this.inverse
      .get(id)
      .filter(isParent)
      .slice(0, 1)
      .map(({ to }) => to);
    const dataTypes = [
      node.attributes.DataType,
      ...(node.definition?.fields ?? []).map((f) => f.dataType),
    ];
    for (const dataType of dataTypes) if (dataType) needed.push(Number(dataType.slice(2)));
    if (typeDefinitionOf(node)) needed.push(typeDefinitionOf(node));
    const hasBareProperties = this.bareTypes && /^UA(Object|Variable)Type$/.test(node.element);
    for (const { type, to } of this.forward.get(id)) {
      if (
        type === hasEncoding ||
        type === hasModellingRule ||
        (type === hasProperty && !hasBareProperties)
      ) {
        needed.push(to);
      }
    }
    return needed;
  }

  close() {
    // A set's iterator also visits what is added on the way.
    for (const id of this.ids) for (const needed of this.needs(id)) this.add(needed);
  }
}

function select(nodes, references, wanted) {
  const selection = new Selection(nodes, references, wanted);
  for (const id of wanted.nodes) selection.add(id);
  for (const id of wanted.trees) selection.addTree(id);
  for (const node of nodes.values()) {
    if (wanted.allOf?.includes(node.element)) selection.add(node.id);
    if (!isType(node)) continue;
    if (wanted.types?.includes(node.browseName)) selection.addType(node.id, false);
    if (wanted.withSubtypes?.includes(node.browseName)) selection.addType(node.id, true);
  }
  selection.close();
  return [...selection.ids].sort((a, b) => a - b);
}

/** Sorted node ids by size name. */
export function sizeLists(nodes) {
  const references = referenceMaps(nodes);
  return Object.fromEntries(
    Object.entries({ micro, embedded, standard }).map(([name, wanted]) => [
      name,
      select(nodes, references, wanted),
    ]),
  );
}
