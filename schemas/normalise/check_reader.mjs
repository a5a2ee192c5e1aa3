// The nodes of the schema files, as check.mjs compares them.
import { basename } from "node:path";
import { readPlainXml } from "./plain_xml.mjs";

const childOf = (element, name) => element?.children.find((c) => c.name === name);
const numberOf = (id, where) => {
  const match = /^i=(\d+)$/.exec(id ?? "");
  if (!match) throw new Error(`${where}: found "${id}", expected a NodeId i=<number>`);
  return Number(match[1]);
};

function readNode(element, file) {
  const where = `${file}: ${element.attributes.NodeId}`;
  return {
    ...element.attributes,
    file,
    class: element.name,
    id: numberOf(element.attributes.NodeId, where),
    displayName: childOf(element, "DisplayName")?.text ?? "",
    inverseName: childOf(element, "InverseName")?.text ?? "",
    references: (childOf(element, "References")?.children ?? []).map((r) => ({
      type: numberOf(r.attributes.ReferenceType, where),
      forward: r.attributes.IsForward !== "false",
      target: numberOf(r.text, where),
    })),
    definition: childOf(element, "Definition"),
    value: childOf(element, "Value")?.children[0],
  };
}

/** The nodes of all `files` by id; a node that occurs twice is an error. */
export function readNodes(files) {
  const nodes = new Map();
  for (const path of files) {
    const file = basename(path);
    for (const element of readPlainXml(path).children) {
      if (!element.attributes.NodeId) continue;
      const node = readNode(element, file);
      if (nodes.has(node.id))
        throw new Error(`${file}: i=${node.id} is also in ${nodes.get(node.id).file}`);
      nodes.set(node.id, node);
    }
  }
  return nodes;
}

/** All references as source, type and target in forward direction, once each. */
export function forwardReferences(nodes) {
  const result = new Map([...nodes.keys()].map((id) => [id, new Set()]));
  const add = (source, type, target) => {
    if (!result.has(source)) result.set(source, new Set());
    result.get(source).add(`${type}>${target}`);
  };
  for (const node of nodes.values()) {
    for (const { type, forward, target } of node.references) {
      if (forward) add(node.id, type, target);
      else add(target, type, node.id);
    }
  }
  return result;
}
