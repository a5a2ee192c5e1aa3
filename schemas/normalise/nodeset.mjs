// Reads a NodeSet2 file down to the facts that Busbar keeps.
import { childOf, childrenOf, readXml, textOf } from "./xml.mjs";

const classes = new Set([
  "UADataType",
  "UAReferenceType",
  "UAObjectType",
  "UAVariableType",
  "UAObject",
  "UAVariable",
  "UAMethod",
  "UAView",
]);
const keptAttributes = [
  "IsAbstract",
  "Symmetric",
  "DataType",
  "ValueRank",
  "ArrayDimensions",
  "AccessLevel",
  "UserAccessLevel",
  "MinimumSamplingInterval",
  "Historizing",
  "EventNotifier",
  "ContainsNoLoops",
  "AccessRestrictions",
];
const dataTypeEncodingType = 76;
const dataTypeDescriptionType = 69;
const dataTypeDictionaryType = 72;
const deprecatedTypes = new Set([dataTypeDescriptionType, dataTypeDictionaryType]);

/** The number of a node of namespace 0; of any other the text of its NodeId. */
const keyOf = (id) => {
  const number = /^i=(\d+)$/.exec(id)?.[1];
  return number === undefined ? id : Number(number);
};

function readReferences(element, resolve) {
  return childrenOf(childOf(element, "References") ?? { children: [] }, "Reference").map(
    (reference) => ({
      type: keyOf(resolve(reference.attributes.ReferenceType)),
      forward: reference.attributes.IsForward !== "false",
      target: keyOf(resolve(reference.text.trim())),
    }),
  );
}

/** Undefined where the file says nothing, which is not the same as nobody. */
function readPermissions(element, resolve) {
  const permissions = childOf(element, "RolePermissions");
  return (
    permissions &&
    childrenOf(permissions, "RolePermission").map((each) => ({
      role: keyOf(resolve(each.text.trim())),
      permissions: each.attributes.Permissions,
    }))
  );
}

function readDefinition(element, resolve) {
  const definition = childOf(element, "Definition");
  if (!definition) return undefined;
  return {
    union: definition.attributes.IsUnion === "true",
    optionSet: definition.attributes.IsOptionSet === "true",
    fields: childrenOf(definition, "Field").map(({ attributes }) => ({
      name: attributes.Name,
      dataType: attributes.DataType && resolve(attributes.DataType),
      valueRank: attributes.ValueRank,
      arrayDimensions: attributes.ArrayDimensions,
      maxStringLength: attributes.MaxStringLength,
      value: attributes.Value,
      optional: attributes.IsOptional === "true",
      allowSubTypes: attributes.AllowSubTypes === "true",
    })),
  };
}

function readNode(element, resolve) {
  const { attributes } = element;
  const kept = {};
  for (const name of keptAttributes) {
    if (attributes[name] !== undefined)
      kept[name] = name === "DataType" ? resolve(attributes[name]) : attributes[name];
  }
  return {
    element: element.name,
    id: keyOf(attributes.NodeId),
    browseName: attributes.BrowseName,
    displayName: textOf(element, "DisplayName"),
    inverseName: textOf(element, "InverseName"),
    attributes: kept,
    references: readReferences(element, resolve),
    rolePermissions: readPermissions(element, resolve),
    definition: readDefinition(element, resolve),
    value: childOf(element, "Value")?.children[0],
  };
}

/** All nodes of the file by id, with the aliases resolved; `model` is its first <Model>. */
export function readNodeSet(file, modules) {
  const root = readXml(file, modules);
  const aliases = new Map(
    childrenOf(childOf(root, "Aliases") ?? { children: [] }, "Alias").map((a) => [
      a.attributes.Alias,
      a.text.trim(),
    ]),
  );
  const resolve = (id) => aliases.get(id) ?? id;
  const nodes = new Map();
  for (const element of root.children) {
    if (classes.has(element.name)) {
      const node = readNode(element, resolve);
      nodes.set(node.id, node);
    }
  }
  const model = childOf(childOf(root, "Models") ?? { children: [] }, "Model")?.attributes ?? {};
  const texts = (parent, name) =>
    childrenOf(childOf(root, parent) ?? { children: [] }, name).map((e) => e.text.trim());
  const required = childrenOf(
    childOf(childOf(root, "Models") ?? { children: [] }, "Model") ?? { children: [] },
    "RequiredModel",
  ).map((e) => e.attributes);
  return { nodes, model, required, namespaces: texts("NamespaceUris", "Uri") };
}

export const typeDefinitionOf = (node) =>
  node.references.find((r) => r.forward && r.type === 40)?.target;

/**
 * Without the encodings other than Default Binary and without the deprecated type dictionaries. The
 * systems that these are parts of (i=92, i=93) stay: files with dictionaries have them below there.
 * References to nodes of other files, for which `isForeign` is true, stay.
 */
export function withoutDictionaries(nodes, isForeign = () => false) {
  const dropped = new Set();
  for (const node of nodes.values()) {
    const type = typeDefinitionOf(node);
    const isOtherEncoding = type === dataTypeEncodingType && node.browseName !== "Default Binary";
    if (isOtherEncoding || deprecatedTypes.has(type)) dropped.add(node.id);
  }
  for (const node of nodes.values()) {
    // Properties and components of what goes.
    const isPart = (r) => !r.forward && (r.type === 46 || r.type === 47);
    if (node.references.some((r) => isPart(r) && dropped.has(r.target))) dropped.add(node.id);
  }
  const kept = new Map([...nodes].filter(([id]) => !dropped.has(id)));
  for (const node of kept.values())
    node.references = node.references.filter((r) => kept.has(r.target) || isForeign(r.target));
  return kept;
}
