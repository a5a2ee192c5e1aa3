// node check.mjs [facts folder] [schemas folder]: compares schemas/ with facts that were made
// independently (ns0_nodes.csv, types.json). The facts' folder may come from BUSBAR_FACTS.
import { existsSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { checkNodes } from "./check_nodes.mjs";
import { checkTypes } from "./check_types.mjs";
import { readNodes } from "./check_reader.mjs";

const [
  facts = process.env.BUSBAR_FACTS,
  schemas = join(dirname(fileURLToPath(import.meta.url)), ".."),
] = process.argv.slice(2);
if (!facts) {
  console.error("usage: node check.mjs <facts folder> [schemas folder]");
  process.exit(2);
}
for (const name of ["ns0_nodes.csv", "types.json"]) {
  if (!existsSync(join(facts, name))) {
    console.error(`${join(facts, name)}: not found; expected the folder of the schema's facts`);
    process.exit(2);
  }
}

process.on("uncaughtException", (error) => {
  console.error(error.message);
  process.exit(1);
});

const isServices = (name) => name === "Opc.Ua.Services.NodeSet2.xml";
const files = readdirSync(schemas)
  .filter((name) => /^Opc\.Ua\..*NodeSet2\.xml$/.test(name))
  .sort();
const nodes = readNodes(
  files.filter((name) => !isServices(name)).map((name) => join(schemas, name)),
);
const services = readNodes(files.filter(isServices).map((name) => join(schemas, name)));

const errors = [];
const report = (where, what, found, expected) =>
  errors.push(`${where}: ${what}: found ${found}, expected ${expected}`);
const rows = checkNodes(nodes, join(facts, "ns0_nodes.csv"), report);
for (const [id, node] of services) {
  if (nodes.has(id))
    report(`${node.file}: i=${id}`, "node", "also in " + nodes.get(id).file, "one definition");
}
const types = checkTypes(new Map([...nodes, ...services]), join(facts, "types.json"), report);

const shown = 50;
for (const error of errors.slice(0, shown)) console.error(error);
if (errors.length > shown) console.error(`... and ${errors.length - shown} more`);
console.log(`${rows} nodes, ${types} types compared: ${errors.length} differences`);
process.exit(errors.length === 0 ? 0 : 1);
