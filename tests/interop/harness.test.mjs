// The harness and peers of another stack: node-opcua's client against a server that is wrong on purpose, and
// busbar's proxy, recordings and replays between node-opcua's client and node-opcua's server.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, before, describe, test } from "node:test";
import { anonymous, createClient, modes } from "./client.mjs";
import { freePort } from "./controller.mjs";
import opcua from "./opcua.mjs";

const { AttributeIds, DataType, OPCUACertificateManager, OPCUAServer, StatusCodes, Variant } = opcua;
const scriptedServer = join(process.env.BUSBAR_PROGRAMS, "scripted-server");
const busbar = process.env.BUSBAR_CLIENT;
const level = { nodeId: "ns=1;s=Level", attributeId: AttributeIds.Value };

/** Starts a program and waits for the line that `pattern` matches, on either output. */
function start(program, args, pattern) {
  return new Promise((resolve, reject) => {
    const child = spawn(program, args, { stdio: ["pipe", "pipe", "pipe"] });
    const running = { child, lines: [], end: new Promise((ended) => child.on("exit", (code) => ended(code))) };
    const timer = setTimeout(() => reject(new Error(`no ${pattern} from ${program}`)), 30_000);
    for (const stream of [child.stdout, child.stderr]) {
      createInterface({ input: stream }).on("line", (line) => {
        running.lines.push(line);
        const found = pattern.exec(line);
        if (found) {
          clearTimeout(timer);
          running.url = found[1];
          resolve(running);
        }
      });
    }
    child.on("error", reject);
  });
}

/** The result of busbar: its exit code and what it printed. The servers of this process go on meanwhile. */
function run(...args) {
  return new Promise((resolve) => {
    const child = spawn(busbar, args, { stdio: ["ignore", "pipe", "pipe"], timeout: 60_000 });
    let text = "";
    child.stdout.on("data", (part) => { text += part; });
    child.stderr.on("data", (part) => { text += part; });
    child.on("close", (code) => resolve({ code, text }));
  });
}

describe("a server that is wrong on purpose", () => {
  const folder = mkdtempSync(join(tmpdir(), "busbar-harness-"));

  /** Runs `action(session, client)` against a scripted server; returns what did not go by the script. */
  async function meet(scenario, isSecured, action) {
    const server = await start(scriptedServer, [scenario, ...(isSecured ? ["secured"] : [])], /^ready (.*)$/);
    try {
      const mode = isSecured ? modes.SignAndEncrypt : modes.None;
      const client = await createClient(folder, { ...mode, transactionTimeout: 10_000 });
      await client.connect(server.url);
      try {
        await action(await client.createSession(anonymous), client);
      } finally {
        await client.disconnect();
      }
    } finally {
      server.child.stdin.end();
      await server.end;
    }
    return server.lines.slice(1);
  }

  for (const isSecured of [false, true]) {
    const kind = isSecured ? "with security" : "without security";
    for (const scenario of ["right", "twice"]) {
      test(`${scenario}, ${kind}: the value comes`, async () => {
        const report = await meet(scenario, isSecured, async (session) => {
          assert.equal((await session.read(level)).value.value, 1.5);
          await session.close();
        });
        assert.deepEqual(report, []);
      });
    }
    test(`late, ${kind}: the client waits`, async () => {
      await meet("late", isSecured, async (session) => {
        const begin = Date.now();
        assert.equal((await session.read(level)).value.value, 1.5);
        assert.ok(Date.now() - begin > 2_500);
        await session.close();
      });
    });
    test(`cut, ${kind}: the client connects again`, async () => {
      await meet("cut", isSecured, async (session) => {
        assert.notEqual(await session.read(level).then((read) => read.value.value, () => "refused"), 1.5);
        assert.equal((await session.read(level)).value.value, 2.5);
        await session.close();
      });
    });
    test(`a sequence number again, ${kind}: the client goes on`, async () => {
      // node-opcua writes of it and takes the message (Part 6, 6.7.2.4 has it close the channel).
      await meet("sequence", isSecured, async (session) => {
        await session.read(level).catch(() => {});
        assert.equal((await session.read(level)).value.value, 2.5);
        await session.close();
      });
    });
    if (isSecured) {
      test("a wrong signature: the client does not take the value", async () => {
        // node-opcua drops the message and waits for another answer.
        await meet("signature", isSecured, async (session) => {
          assert.notEqual(await session.read(level).then((read) => read.value.value, () => "refused"), 1.5);
        });
      });
    }
    test(`a Publish that is never answered, ${kind}: reads go on`, async () => {
      await meet("publish", isSecured, async (session) => {
        const subscription = await session.createSubscription2({
          requestedPublishingInterval: 100, requestedLifetimeCount: 100, requestedMaxKeepAliveCount: 10,
          publishingEnabled: true,
        });
        assert.equal((await session.read(level)).value.value, 2.5);
        await subscription.terminate();
        await session.close();
      });
    });
  }
});

describe("a proxy between node-opcua and itself", () => {
  const folder = mkdtempSync(join(tmpdir(), "busbar-proxy-"));
  const servers = [];
  const urls = [];

  before(async () => {
    for (const value of [1.5, 1.75]) {
      const serverCertificateManager = new OPCUACertificateManager({
        rootFolder: join(folder, `server-${value}`), automaticallyAcceptUnknownCertificate: true,
      });
      await serverCertificateManager.initialize();
      const server = new OPCUAServer({
        port: await freePort(), hostname: "127.0.0.1", serverCertificateManager,
        userManager: { isValidUser: (name, password) => name === "operator" && password === "a long secret" },
      });
      await server.initialize();
      const { addressSpace } = server.engine;
      addressSpace.getOwnNamespace().addVariable({
        organizedBy: addressSpace.rootFolder.objects, nodeId: "ns=1;s=Level", browseName: "Level",
        dataType: "Double", value: new Variant({ dataType: DataType.Double, value }),
      });
      await server.start();
      servers.push(server);
      urls.push(`opc.tcp://127.0.0.1:${server.endpoints[0].port}`);
    }
  });
  after(() => Promise.all(servers.map((server) => server.shutdown())));

  /** Reads the level through a proxy; returns the value and what the proxy said. */
  async function visit(mode, ...all) {
    const args = all.filter((argument) => typeof argument === "string");
    const { user = anonymous } = all.find((argument) => typeof argument !== "string") ?? {};
    const proxy = await start(busbar, ["proxy", urls[0], ...args], /^busbar: (\S+) leads to/);
    let value;
    const client = await createClient(folder, mode);
    await client.connect(proxy.url);
    try {
      const session = await client.createSession(user);
      value = (await session.read(level)).value.value;
      await session.close();
    } finally {
      await client.disconnect();
      await new Promise((resolve) => setTimeout(resolve, 300)); // the proxy sees the end
      proxy.child.kill("SIGTERM");
    }
    return { value, code: await proxy.end, lines: proxy.lines };
  }

  test("without security it is seen, recorded and disturbed by name", async () => {
    const first = await visit(modes.None, "--pass", "--record", join(folder, "first.rec"));
    assert.equal(first.value, 1.5);
    assert.equal(first.code, 0);
    assert.ok(first.lines.some((line) => line.endsWith("server -> ReadResponse Double 1.5")));
    const edited = await visit(modes.None, "--pass", "--record", join(folder, "edited.rec"), "--fault",
      "edit results[0].value = Double:9 at ReadResponse 1");
    assert.equal(edited.value, 9);
    const { code, text } = await run("diff", join(folder, "first.rec"), join(folder, "edited.rec"));
    assert.equal(code, 1);
    assert.match(text, /^ReadResponse to ns=1;s=Level: results\[0\]\.value Double 1\.5 -> Double 9 \(messages \d+, \d+\)$/m);
    assert.equal(text.trim().split("\n").length, 1, text);
  });

  test("with security it may be passed on, seen and delayed", async () => {
    const begin = Date.now();
    const { value, code, lines } = await visit(modes.SignAndEncrypt, "--pass", "--record", join(folder, "secured.rec"),
      "--fault", "delay 1500ms at MSG 3 of the server");
    assert.equal(value, 1.5);
    assert.equal(code, 0, lines.join("\n"));
    assert.ok(Date.now() - begin > 1_400);
    assert.ok(lines.some((line) => line.endsWith("client -> MSG")));
  });

  // Both peers accept every certificate; node-opcua's server does not name 127.0.0.1 in its own.
  const trusting = ["--pki", join(folder, "proxy"), "--trust", "--any-client", "--ignore", "host-name"];

  for (const [name, mode] of Object.entries(modes)) {
    test(`with ${name} it ends the channels of both and sees, records and changes what they say`, async () => {
      const recording = join(folder, `ended-${name}.rec`);
      const plain = await visit(mode, ...trusting, "--record", recording);
      assert.equal(plain.value, 1.5, plain.lines.join("\n"));
      assert.equal(plain.code, 0, plain.lines.join("\n"));
      assert.ok(plain.lines.some((line) => line.endsWith("server -> ReadResponse Double 1.5")), plain.lines.join("\n"));
      const other = join(folder, `edited-${name}.rec`);
      const edited = await visit(mode, ...trusting, "--record", other, "--fault",
        "edit results[0].value = Double:9 at ReadResponse 1");
      assert.equal(edited.value, 9, edited.lines.join("\n"));
      const shown = await run("show", recording, "--filter", "service=Read and from=server");
      assert.equal(shown.code, 0, shown.text);
      assert.match(shown.text, /ReadResponse Double 1\.5/);
      const { code, text } = await run("diff", recording, other);
      assert.equal(code, 1);
      assert.match(text, /^ReadResponse to ns=1;s=Level: results\[0\]\.value Double 1\.5 -> Double 9 \(messages \d+, \d+\)$/m);
      assert.equal(text.trim().split("\n").length, 1, text);
    });
  }

  test("with security and a user, whose password is in no file", async () => {
    const recording = join(folder, "user.rec");
    const user = { type: opcua.UserTokenType.UserName, userName: "operator", password: "a long secret" };
    const { value, lines } = await visit(modes.SignAndEncrypt, ...trusting, "--record", recording, { user });
    assert.equal(value, 1.5, lines.join("\n"));
    const everything = readFileSync(recording, "latin1") + lines.join("\n");
    assert.ok(!everything.includes("a long secret"));
    assert.ok(!everything.includes(Buffer.from("a long secret").toString("hex")));
    assert.ok(everything.includes(Buffer.from("operator").toString("hex")));
  });

  test("what was recorded is asked again, and what differs is named", async () => {
    const recording = join(folder, "first.rec");
    // With security, since the servers offer it; --insecure --policy None would do without.
    const trusting = ["--pki", join(folder, "proxy"), "--trust", "--ignore", "host-name"];
    const same = await run(...trusting, "replay", urls[0], recording);
    assert.equal(same.code, 0, same.text);
    assert.ok(!same.text.includes("->"), same.text);
    const { code, text } = await run(...trusting, "replay", urls[1], recording);
    assert.equal(code, 1, text);
    assert.match(text, /results\[0\]\.value Double 1\.5 -> Double 1\.75/);
  });

  test("a recording stands in for the server", async () => {
    const served = await start(busbar, ["replay", join(folder, "first.rec"), "--serve", "0"],
      /^busbar: (\S+) answers as/);
    const client = await createClient(folder, modes.None);
    await client.connect(served.url);
    const session = await client.createSession(anonymous);
    assert.equal((await session.read(level)).value.value, 1.5);
    await session.close();
    await client.disconnect();
    served.child.kill("SIGTERM");
    assert.equal(await served.end, 0, served.lines.join("\n"));
  });

  const hasTshark = spawnSync("tshark", ["--version"]).status === 0;
  test("tshark reads the capture", { skip: !hasTshark && "no tshark" }, async () => {
    const capture = join(folder, "first.pcap");
    assert.equal((await run("show", join(folder, "first.rec"), "--pcap", capture)).code, 0);
    const { stdout } = spawnSync("tshark", ["-r", capture, "-d", "tcp.port==4840,opcua", "-T", "fields",
      "-e", "opcua.servicenodeid.numeric", "-e", "_ws.malformed"], { encoding: "utf8" });
    assert.ok(stdout.includes("631"), "a ReadRequest, i=631");
    assert.ok(!/malformed/i.test(stdout), stdout);
  });

  test("tshark reads what was said with security", { skip: !hasTshark && "no tshark" }, async () => {
    for (const option of ["--pcap", "--pcapng"]) {
      const capture = join(folder, `ended.${option.slice(2)}`);
      assert.equal((await run("show", join(folder, "ended-SignAndEncrypt.rec"), option, capture)).code, 0);
      const { stdout } = spawnSync("tshark", ["-r", capture, "-d", "tcp.port==4840,opcua", "-T", "fields",
        "-e", "opcua.servicenodeid.numeric", "-e", "_ws.malformed"], { encoding: "utf8" });
      for (const service of ["461", "467", "631", "634"]) { // CreateSession, ActivateSession, Read, its response
        assert.ok(stdout.includes(service), `${option}: ${service} is not in ${stdout}`);
      }
      assert.ok(!/malformed/i.test(stdout), stdout);
    }
  });
});
