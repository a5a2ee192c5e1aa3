// Browses all of a server with node-opcua.
import assert from "node:assert/strict";
import opcua from "./opcua.mjs";

const { BrowseDirection, StatusCodes } = opcua;

/** Every node that hierarchical references reach from `root`. */
export async function crawl(session, root) {
  const found = new Map([[root, null]]);
  let open = [root];
  while (open.length !== 0) {
    const batch = open.splice(0, 500).map((nodeId) => ({
      nodeId, browseDirection: BrowseDirection.Forward, referenceTypeId: "HierarchicalReferences",
      includeSubtypes: true, nodeClassMask: 0, resultMask: 63,
    }));
    for (let result of await session.browse(batch)) {
      assert.equal(result.statusCode, StatusCodes.Good);
      for (;;) {
        for (const reference of result.references) {
          const key = reference.nodeId.toString();
          if (!found.has(key)) {
            found.set(key, reference);
            open.push(key);
          }
        }
        if (!result.continuationPoint?.length) break;
        result = await session.browseNext(result.continuationPoint, false);
      }
    }
  }
  return found;
}
