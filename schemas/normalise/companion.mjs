// node companion.mjs <node_modules with saxes> <output folder> <NodeSet2 file>...: keeps the facts
// of companion specifications, each in a file of the same name.
import { writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { readNodeSet, withoutDictionaries } from "./nodeset.mjs";
import { nodeSetXml } from "./write.mjs";

const [modules, output, ...files] = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node companion.mjs <node_modules> <output folder> <NodeSet2 file>...");
  process.exit(2);
}
for (const file of files) {
  const source = readNodeSet(file, resolve(modules));
  const own = `ns=${source.namespaces.indexOf(source.model.ModelUri) + 1};`;
  const isForeign = (id) => typeof id === "number" || !id.startsWith(own);
  const nodes = withoutDictionaries(source.nodes, isForeign);
  const text = nodeSetXml(nodes.values(), source.model, source.required, source.namespaces);
  writeFileSync(join(output, basename(file)), text);
  console.log(`${basename(file)}: ${nodes.size} of ${source.nodes.size} nodes`);
}
