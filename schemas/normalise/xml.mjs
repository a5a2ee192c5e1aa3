// A small tree over saxes: elements are {name, attributes, children, text}.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

/** Reads one XML file; `modules` is the node_modules folder that has saxes. */
export function readXml(file, modules) {
  const { SaxesParser } = createRequire(`${modules}/index.js`)("saxes");
  const parser = new SaxesParser({ fileName: file });
  const root = { name: "", attributes: {}, children: [], text: "" };
  const open = [root];
  parser.on("error", (error) => {
    throw error;
  });
  parser.on("opentag", (tag) => {
    const element = { name: tag.name, attributes: tag.attributes, children: [], text: "" };
    open.at(-1).children.push(element);
    open.push(element);
  });
  parser.on("text", (text) => {
    open.at(-1).text += text;
  });
  parser.on("closetag", () => open.pop());
  parser.write(readFileSync(file, "utf8")).close();
  return root.children[0];
}

export const childrenOf = (element, name) => element.children.filter((c) => c.name === name);
export const childOf = (element, name) => element.children.find((c) => c.name === name);
export const textOf = (element, name) => childOf(element, name)?.text.trim() ?? "";

export const escape = (text) =>
  String(text)
    .replace(/&/g, "&amp;")
    .replace(/</g, "&lt;")
    .replace(/>/g, "&gt;")
    .replace(/"/g, "&quot;");

/** Attributes with a value, in the order given. */
export const attributes = (pairs) =>
  pairs
    .filter(([, value]) => value !== undefined && value !== "")
    .map(([name, value]) => ` ${name}="${escape(value)}"`)
    .join("");
