// node-opcua, by require: with import, Node first reads all of its 1,500 files for the names that they export, which
// takes a quarter of a second in each process.
import { createRequire } from "node:module";

export default createRequire(import.meta.url)("node-opcua");
