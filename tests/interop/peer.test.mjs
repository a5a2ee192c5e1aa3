// The program busbar against a server of node-opcua: all but losses, which are in peer_loss.test.mjs.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { clientOptions, makeCertificate } from "./certificates.mjs";
import { openHouse, startController, user } from "./controller.mjs";
import { Busbar, makeFolder, removeFolder, startPeer } from "./peer.mjs";

const policies = ["Basic256Sha256", "Aes128_Sha256_RsaOaep", "Aes256_Sha256_RsaPss"];
const policyUri = (name) => `http://opcfoundation.org/UA/SecurityPolicy#${name}`;
const id = (name) => `nsu=urn:interop:machine;s=${name}`;
const range = (count) => Array.from({ length: count }, (_, i) => i);

let folder;
let peer;
let signing; // the same at another port, without encryption
let busbar; // trusts both, they have the same certificate
let logins; // kind of user → options

before(async () => {
  folder = await makeFolder();
  peer = await startPeer({ folder, second: "signing" });
  signing = { ...peer, endpointUrl: peer.secondUrl };
  busbar = new Busbar(peer, join(folder, "pki"));
  const person = await clientOptions(folder, "person", await makeCertificate("maintainer"));
  const password = join(folder, "password");
  writeFileSync(password, user.password);
  logins = {
    anonymous: [],
    name: ["--user", user.userName, "--password-file", password],
    certificate: ["--user-certificate", person.certificateFile, "--user-key", person.privateKeyFile],
  };
  await good(["read", "i=2258", "--trust"]);
});

after(async () => {
  await peer?.kill();
  removeFolder(folder);
});

/** What the program says where it has to succeed. */
async function good(words, program = busbar) {
  const { code, json, errors } = await program.run(words);
  assert.equal(code, 0, `${words}: ${JSON.stringify(json)} ${errors}`);
  return json;
}

/** Where it has to fail: `exit` as --help documents it, and the status. */
async function refused(words, exit, symbol, program = busbar) {
  const { code, json } = await program.run(words);
  assert.equal(code, exit, JSON.stringify(json));
  assert.equal(json.error.exit, exit);
  assert.match(json.error.status.symbol, symbol);
}

const valueOf = async (node) => (await good(["read", node]))[0].value;

describe("security", () => {
  const tokens = {
    anonymous: "AnonymousIdentityToken", name: "UserNameIdentityToken", certificate: "X509IdentityToken",
  };
  const eachUserLogsIn = async (server, policy, mode, options) => {
    const program = new Busbar(server, join(folder, "pki"), ["--policy", policy, ...options]);
    await Promise.all(Object.keys(tokens).map(async (kind) => {
      const [state] = await good(["read", "i=2259", ...logins[kind]], program);
      assert.equal(state.value, 0);
      await server.login(`${policy} ${mode} ${tokens[kind]}`);
    }));
  };

  test("endpoints: every policy and mode, for all kinds of users", async () => {
    const endpoints = await good(["endpoints"]);
    const offered = endpoints.map(({ policy, mode }) => `${policy} ${mode}`);
    const secure = policies.flatMap((name) => ["Sign", "SignAndEncrypt"].map((mode) => `${policyUri(name)} ${mode}`));
    assert.deepEqual(offered.sort(), [`${policyUri("None")} None`, ...secure].sort());
    for (const { users, thumbprint } of endpoints) {
      assert.deepEqual([...new Set(users)].sort(), Object.keys(tokens).sort());
      assert.match(thumbprint, /^[0-9A-F]{40}$/);
    }
  });

  for (const policy of policies) {
    test(`${policy}, SignAndEncrypt: each kind of user`, () => eachUserLogsIn(peer, policy, "SignAndEncrypt", []));
    test(`${policy}, Sign: each kind of user`, () => eachUserLogsIn(signing, policy, "Sign", ["--mode", "Sign"]));
  }
  test("None: each kind of user", () => eachUserLogsIn(peer, "None", "None", ["--insecure"]));

  test("None is refused where nobody has allowed it", () =>
    refused(["read", "i=2259", "--policy", "None"], 4, /Bad_Security/));

  test("a wrong password", async () => {
    const program = new Busbar(peer, join(folder, "pki"));
    const { code, json } = await program.run(["read", "i=2259", "--user", user.userName], { BUSBAR_PASSWORD: "wrong" });
    assert.equal(code, 4, JSON.stringify(json));
    assert.match(json.error.status.symbol, /^Bad_(UserAccessDenied|IdentityTokenRejected)$/);
  });

  test("a server whose certificate names another host", async () => {
    const program = new Busbar({ endpointUrl: `opc.tcp://127.0.0.1:${peer.port}` }, join(folder, "pki"));
    await refused(["read", "i=2259"], 4, /^Bad_CertificateHostNameInvalid$/, program);
  });

  test("an unknown server: refused, trusted by its thumbprint, accepted", async () => {
    const stranger = new Busbar(peer, join(folder, "new-pki"));
    await refused(["read", "i=2259"], 4, /^Bad_CertificateUntrusted$/, stranger);
    const [{ thumbprint }] = await good(["endpoints"], stranger);
    const rejected = (await good(["cert", "list"], stranger)).filter(({ list }) => list === "rejected");
    assert.deepEqual(rejected.map((entry) => entry.thumbprint), [thumbprint]);
    await good(["cert", "trust", thumbprint], stranger);
    await good(["read", "i=2259"], stranger);
  });
});

describe("the address space", () => {
  test("a tree, with a folder that takes several answers", async () => {
    const tree = await good(["browse", id("Machine"), "--depth", "2"]);
    const nameOf = ({ browseName }) => browseName.replace(/^\d+:/, "");
    const child = (name) => tree.children.find((node) => nameOf(node) === name);
    for (const name of ["Counter", "Setpoint", "Part"]) assert.equal(child(name).nodeClass, "Variable", name);
    assert.deepEqual(child("Multiply").children.map(nameOf).sort(), ["InputArguments", "OutputArguments"]);
    const many = child("Many").children.map(nameOf);
    assert.deepEqual(many.sort(), range(300).map((i) => `V${i}`).sort());
  });

  test("more values in one command than the server reads at once", async () => {
    const values = await good(["read", ...range(300).map((i) => id(`V${i}`))]);
    assert.deepEqual(values.map(({ value }) => value), range(300));
  });

  test("more paths than the server translates at once", async () => {
    const index = (await valueOf("i=2255")).indexOf("urn:interop:machine");
    const path = (i) => `/Objects/${["Machine", "Many", `V${i}`].map((name) => `${index}:${name}`).join("/")}`;
    const values = await good(["read", ...range(45).map(path)]);
    assert.deepEqual(values.map(({ value }) => value), range(45));
  });

  test("arrays, a range of one, a text with an escape sequence", async () => {
    assert.deepEqual(await valueOf(id("Recipe")), [1, 2, 3, 4]);
    assert.deepEqual((await good(["read", id("Recipe"), "--range", "1:2"]))[0].value, [2, 3]);
    assert.equal(await valueOf(id("Name")), "Press \u{1b}[31m4");
    const forPeople = busbar.startForPeople(["read", "--value", id("Name")]);
    assert.equal(await forPeople.end(), 0);
    assert.deepEqual(forPeople.lines, ["Press \\x1B[31m4"]);
  });

  test("the attributes of a node", async () => {
    const { attributes } = await good(["read", "--all", id("Serial")]);
    assert.equal(attributes.BrowseName.value.replace(/^\d+:/, ""), "Serial");
    assert.equal(attributes.DataType.value, "i=12");
    assert.equal(attributes.AccessLevel.value, 1);
  });

  test("nodes that are not there", async () => {
    await refused(["read", id("Nothing")], 1, /^Bad_NodeIdUnknown$/);
    const { code, json } = await busbar.run(["read", id("V1"), id("Nothing")]);
    assert.equal(code, 5);
    assert.deepEqual(json.map(({ status }) => status.symbol), ["Good", "Bad_NodeIdUnknown"]);
  });
});

describe("writing and calling", () => {
  test("a value, an array, a part of it", async () => {
    await good(["write", id("Setpoint"), "23.25"]);
    assert.equal(await valueOf(id("Setpoint")), 23.25);
    await good(["write", id("Recipe"), "[5, -6, 7, 8]"]);
    await good(["write", id("Recipe"), "[9, 10]", "--range", "2:3"]);
    assert.deepEqual(await valueOf(id("Recipe")), [5, -6, 9, 10]);
  });

  test("more values than the server writes at once", async () => {
    const nodes = range(120).map((i) => id(`V${i}`));
    await good(["write", ...nodes.flatMap((node, i) => [node, String(i + 1000)])]);
    const values = await good(["read", ...nodes]);
    assert.deepEqual(values.map(({ value }) => value), range(120).map((i) => i + 1000));
    await good(["write", ...nodes.flatMap((node, i) => [node, String(i)])]);
  });

  test("a value of another type, and what is read-only", async () => {
    await refused(["write", id("Setpoint"), "warm", "--type", "String"], 1, /^Bad_TypeMismatch$/);
    await refused(["write", id("Serial"), "P-5"], 1, /^Bad_(NotWritable|UserAccessDenied)$/);
    assert.equal(await valueOf(id("Serial")), "P-4");
  });

  test("a method, and what it does not take", async () => {
    const { outputs } = await good(["call", id("Machine"), "Multiply", "6", "7.5"]);
    assert.deepEqual(outputs, [{ name: "product", value: 45 }]);
    assert.equal((await busbar.run(["call", id("Machine"), "Multiply", "6"])).code, 2);
    await refused(["call", id("Machine"), "Divide"], 1, /^Bad_MethodInvalid$/);
  });
});

describe("the server's own types", () => {
  const part = { Serial: "P-4711", Grade: 1, Size: { Width: 2.5, Height: 4 }, Holes: [3, 5, 8], Note: "drilled" };
  const fieldsOf = async (node, program) => {
    const [{ value: { UaTypeId, ...fields } }] = await good(["read", node], program);
    assert.match(UaTypeId, /^ns=\d+;i=3$/);
    return fields;
  };

  test("a structure has its fields, with and without the optional one", async () => {
    assert.deepEqual(await fieldsOf(id("Part")), part);
    const { Note, ...rest } = part;
    assert.deepEqual(await fieldsOf(id("Blank")), { ...rest, Grade: 0, Holes: [] });
  });

  test("people read the names of enumerations", async () => {
    const program = busbar.startForPeople(["read", id("Part"), id("Blank")]);
    assert.equal(await program.end(), 0, program.errors);
    const grades = program.lines.filter((line) => /^ +Grade /.test(line));
    assert.deepEqual(grades.map((line) => line.trim().replace(/ +/g, " ")), ["Grade Good (1)", "Grade Scrap (0)"]);
  });

  test("one is written", async () => {
    const other = { ...part, Serial: "P-4712", Holes: [] };
    await good(["write", id("Part"), JSON.stringify(other)]);
    assert.deepEqual(await fieldsOf(id("Part")), other);
    await good(["write", id("Part"), JSON.stringify(part)]);
    assert.deepEqual(await fieldsOf(id("Part")), part);
  });

  test("exported, they load again", async () => {
    const types = join(folder, "types.xml");
    const { nodes, leftOut } = await good(["export", "urn:interop:types", "--output", types]);
    assert.ok(nodes >= 6, `${nodes} nodes`);
    assert.deepEqual(leftOut, []);
    const controller = await startController({ ...openHouse, nodesets: [types] });
    try {
      const local = new Busbar(controller, join(folder, "pki"), ["--insecure", "--policy", "None"]);
      const [{ value }] = await good(["read", "nsu=urn:interop:types;i=3", "--attribute", "DataTypeDefinition"], local);
      assert.deepEqual(value.Fields.map(({ Name }) => Name), Object.keys(part));
    } finally {
      assert.equal(await controller.stop(), 0);
    }
    const other = await startPeer({ folder, types });
    try {
      const program = new Busbar(other, join(folder, "pki"));
      assert.deepEqual(await fieldsOf(id("Part"), program), part);
      await good(["export", "urn:interop:types", "--output", `${types}.again`], program);
      const sorted = (file) => readFileSync(file, "utf8").split("\n").sort(); // the order of nodes is the server's
      assert.deepEqual(sorted(`${types}.again`), sorted(types));
    } finally {
      await other.kill();
    }
  });
});

// Each waits for what comes by and by: they wait together.
describe("subscriptions", { concurrency: true }, () => {
  test("every value of a counter once and in order", async () => {
    const { code, lines } = await busbar.run(
      ["subscribe", id("Counter"), "--interval", "100", "--sampling", "0", "--queue", "100", "--count", "40"]);
    assert.equal(code, 0);
    assert.deepEqual(lines.map(({ value }) => value), range(40).map((i) => lines[0].value + i));
    assert.ok(lines.every(({ node, status, sourceTimestamp }) =>
      node === id("Counter") && status.symbol === "Good" && sourceTimestamp !== null));
  });

  test("more items than the server creates at once", async () => {
    const nodes = range(100).map((i) => id(`V${i}`));
    const { code, lines } = await busbar.run(["subscribe", ...nodes, "--interval", "50", "--count", "100"]);
    assert.equal(code, 0);
    assert.deepEqual(lines.map(({ node }) => node).sort(), nodes.sort());
  });

  test("an item that is refused does not keep the others from theirs", async () => {
    const { code, lines } = await busbar.run(["subscribe", id("Nothing"), id("V1"), "--count", "1"]);
    assert.equal(code, 5);
    assert.deepEqual(lines.map(({ node, value }) => [node, value]), [[id("V1"), 1]]);
  });

  test("the server leaves out events below a severity", async () => {
    const { lines } = await busbar.run(["events", id("Machine"), "--severity", "500", "--count", "3"]);
    const numbers = lines.map(({ Message }) => Number(Message.Text.slice("event ".length)));
    assert.deepEqual(lines.map(({ Severity }) => Severity), [800, 800, 800]);
    assert.deepEqual(numbers, range(3).map((i) => numbers[0] + 2 * i));
  });
});

// By itself: node-opcua tells of each new session with an event of its own, for the URL is not the one it announces.
test("events have their fields and come in order", async () => {
  const { code, lines } = await busbar.run(["events", "--count", "5", "--field", "SourceNode"]);
  assert.equal(code, 0);
  const first = Number(lines[0].Message.Text.slice("event ".length));
  lines.forEach((event, i) => {
    assert.equal(event.Message.Text, `event ${first + i}`);
    assert.equal(event.Severity, (first + i) % 2 ? 800 : 200);
    assert.equal(event.SourceName, "Machine");
    assert.match(event.SourceNode, /s=Machine$/);
  });
  assert.equal(new Set(lines.map(({ EventId }) => EventId)).size, 5);
});
