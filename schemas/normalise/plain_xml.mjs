// A reader of the XML that write.mjs writes, without dependencies, so that check.mjs runs wherever
// Node.js is. It knows elements, attributes, text, comments and the five named entities; nothing else
// occurs.
import { readFileSync } from "node:fs";

const entities = { amp: "&", lt: "<", gt: ">", quot: '"', apos: "'" };
const unescape = (text) => text.replace(/&(\w+);/g, (whole, name) => entities[name] ?? whole);
const token = /<\?[^>]*\?>|<!--.*?-->|<(\/?)([\w:.-]+)((?:\s+[\w:.-]+="[^"]*")*)\s*(\/?)>|([^<]+)/gsy;

const lineOf = (text, offset) => text.slice(0, offset).split("\n").length;

/** The root element of `file` as {name, attributes, children, text}. */
export function readPlainXml(file) {
  const text = readFileSync(file, "utf8");
  const open = [{ children: [], text: "" }];
  token.lastIndex = 0;
  while (token.lastIndex < text.length) {
    const offset = token.lastIndex;
    const found = token.exec(text);
    if (!found)
      throw new Error(`${file}:${lineOf(text, offset)}: not a tag or text of a NodeSet2 file`);
    const [, close, name, list, empty, characters] = found;
    if (characters !== undefined) {
      open.at(-1).text += unescape(characters);
    } else if (close) {
      const closed = open.pop();
      if (closed.name !== name)
        throw new Error(`${file}:${lineOf(text, offset)}: </${name}> closes <${closed.name}>`);
    } else if (name) {
      const attributes = {};
      for (const [, key, value] of list.matchAll(/([\w:.-]+)="([^"]*)"/g))
        attributes[key] = unescape(value);
      const element = { name, attributes, children: [], text: "" };
      open.at(-1).children.push(element);
      if (!empty) open.push(element);
    }
  }
  if (open.length !== 1) throw new Error(`${file}: <${open.at(-1).name}> is not closed`);
  return open[0].children[0];
}
