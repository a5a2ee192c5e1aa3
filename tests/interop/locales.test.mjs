// Texts in two locales: node-opcua's client against busbar-controller.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import opcua from "./opcua.mjs";
import { createClient, modes, named } from "./client.mjs";
import { openHouse, startController, user } from "./controller.mjs";

const { AttributeIds, coerceLocalizedText, DataType, StatusCodes } = opcua;

let controller;

before(async () => {
  controller = await startController({
    ...openHouse, nodesets: [fileURLToPath(new URL("truth.NodeSet2.xml", import.meta.url))],
  });
});

after(async () => {
  assert.equal(await controller.stop(), 0, "the controller stops cleanly on SIGTERM");
});

/** A session that asks for texts in `localeIds`, which node-opcua itself has no option for. */
async function readingIn(localeIds, action) {
  const client = await createClient(controller.folder, modes.SignAndEncrypt);
  const send = client.performMessageTransaction.bind(client);
  client.performMessageTransaction = (request, callback) => {
    if (request.schema.name === "ActivateSessionRequest") request.localeIds = localeIds;
    return send(request, callback);
  };
  await client.connect(controller.endpointUrl);
  try {
    const session = await client.createSession(named(user));
    try {
      return await action(session);
    } finally {
      await session.close();
    }
  } finally {
    await client.disconnect();
  }
}

async function nodeId(session, name) {
  return `ns=${(await session.readNamespaceArray()).indexOf("urn:busbar:test:truth")};s=${name}`;
}

const textOf = async (session, name, attributeId) => {
  const value = await session.read({ nodeId: await nodeId(session, name), attributeId });
  assert.equal(value.statusCode, StatusCodes.Good);
  return [value.value.value.locale ?? "", value.value.value.text ?? ""];
};

test("the DisplayName of a file is told in the session's locale", { timeout: 30_000 }, async () => {
  const name = (session) => textOf(session, "Level", AttributeIds.DisplayName);
  assert.deepEqual(await readingIn(["de-AT", "en"], name), ["de", "Pegel"]);
  assert.deepEqual(await readingIn(["fr"], name), ["", "Level"]);
  await readingIn(["de"], async (session) => {
    const { references } = await session.browse("i=85");
    assert.ok(references.some((each) => each.displayName.text === "Pegel"));
    const array = await session.read({ nodeId: "i=2271", attributeId: AttributeIds.Value });
    assert.deepEqual([...array.value.value], ["en", "de"]);
  });
});

test("a Write replaces the text of its locale", { timeout: 30_000 }, async () => {
  const label = (session) => textOf(session, "Label", AttributeIds.Value);
  const write = (locale, text) => readingIn([], async (session) => session.write({
    nodeId: await nodeId(session, "Label"), attributeId: AttributeIds.Value,
    value: { value: { dataType: DataType.LocalizedText, value: coerceLocalizedText({ locale, text }) } },
  }));
  assert.equal(await write("de", "heiss"), StatusCodes.Good);
  assert.deepEqual(await readingIn(["en"], label), ["en", "hot"]);
  assert.deepEqual(await readingIn(["de"], label), ["de", "heiss"]);
  const refused = await write("xx-ZZ", "x");
  assert.equal(refused.value, 0x80ed0000, "Bad_LocaleNotSupported");
});
