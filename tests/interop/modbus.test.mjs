// Modbus TCP: our simulated device against clients of jsmodbus, modbus-serial and mbpoll; our client
// engine against servers of jsmodbus, modbus-serial and libmodbus; and what tshark says of it all.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { connect, createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import jsmodbus from "jsmodbus";
import ModbusSerial from "modbus-serial";
import { ask, counting, hasProgram, isInstalled, Plc, run } from "./plc.mjs";

const responder = (...args) => Plc.start("busbar-plc-responder", "modbus", ...args);

/** A client of jsmodbus, which has to see its socket connect. */
async function openJsmodbus(port) {
  const socket = connect(port, "127.0.0.1");
  const client = new jsmodbus.client.TCP(socket, 1);
  await once(socket, "connect");
  return { socket, client };
}

describe("clients of others at the simulated device", () => {
  let plc;
  before(async () => {
    plc = await responder("--set", "holding:0=17", "--set", "input:3=65535", "--set", "discrete:2=1");
    for (let i = 0; i < 125; ++i) {
      assert.equal(await plc.say(`set holding:${1000 + i} ${i}`), "ok");
    }
  });
  after(async () => assert.equal(await plc.stop(), 0));

  test("modbus-serial reads, writes, masks, identifies, and is refused", async () => {
    const client = new ModbusSerial();
    await client.connectTCP("127.0.0.1", { port: plc.port });
    client.setID(1);
    try {
      assert.deepEqual((await client.readHoldingRegisters(0, 1)).data, [17]);
      assert.deepEqual((await client.readInputRegisters(3, 1)).data, [65535]);
      assert.deepEqual((await client.readDiscreteInputs(0, 4)).data.slice(0, 4), [false, false, true, false]);
      await client.writeRegister(5, 0xabcd);
      assert.equal(await plc.say("get holding:5"), String(0xabcd));
      await client.writeRegisters(6, [1, 2, 65535]);
      assert.deepEqual((await client.readHoldingRegisters(5, 4)).data, [0xabcd, 1, 2, 65535]);
      await client.writeCoil(7, true);
      await client.writeCoils(8, [true, false, true]);
      assert.deepEqual((await client.readCoils(7, 4)).data.slice(0, 4), [true, true, false, true]);
      await client.writeRegister(20, 0x12);
      await client.maskWriteRegister(20, 0xf2, 0x25);
      assert.equal(await plc.say("get holding:20"), String(0x17));
      const { data } = await client.readDeviceIdentification(1, 0);
      assert.deepEqual([data[0], data[1]], ["Busbar", "busbar-plc-responder"]);
      assert.deepEqual((await client.readHoldingRegisters(1000, 125)).data, Array.from({ length: 125 }, (_, i) => i));
      assert.equal(await plc.say("refuse holding:30"), "ok");
      assert.equal(await plc.say("refuse holding:31 6"), "ok");
      await assert.rejects(client.readHoldingRegisters(30, 1), { modbusCode: 2 });
      await assert.rejects(client.readHoldingRegisters(31, 1), { modbusCode: 6 });
      await assert.rejects(client.readHoldingRegisters(65535, 2), { modbusCode: 2 });
      await assert.rejects(client.readHoldingRegisters(0, 126), { modbusCode: 3 });
      assert.equal(await plc.say("allow"), "ok");
      assert.deepEqual((await client.readHoldingRegisters(30, 1)).data, [0]);
    } finally {
      await new Promise((resolve) => client.close(resolve));
    }
  });

  test("jsmodbus reads and writes, several requests at a time", async () => {
    const { socket, client } = await openJsmodbus(plc.port);
    try {
      await client.writeMultipleRegisters(200, [7, 8, 9]);
      await client.writeSingleRegister(203, 10);
      await client.writeMultipleCoils(50, [true, false, true, true, false, true, true, true, true]);
      await client.writeSingleCoil(59, true);
      const [registers, coils, inputs] = await Promise.all([
        client.readHoldingRegisters(200, 4),
        client.readCoils(50, 10),
        client.readInputRegisters(2, 2),
      ]);
      assert.deepEqual(registers.response.body.valuesAsArray, [7, 8, 9, 10]);
      assert.deepEqual(coils.response.body.valuesAsArray.slice(0, 10), [1, 0, 1, 1, 0, 1, 1, 1, 1, 1]);
      assert.deepEqual(inputs.response.body.valuesAsArray, [0, 65535]);
      await assert.rejects(client.readHoldingRegisters(65530, 20), (error) => error.response.body.code === 2);
    } finally {
      socket.end();
    }
  });

  test("mbpoll reads and writes numbers, floats and coils", { skip: !isInstalled("mbpoll") && "there is no mbpoll" }, async () => {
    const mbpoll = (...args) => run("mbpoll", "-m", "tcp", "-p", String(plc.port), "-1", "-q", ...args);
    assert.match(await mbpoll("-0", "-r", "300", "127.0.0.1", "4660", "22136"), /Written 2 references/);
    assert.match(await mbpoll("-0", "-r", "300", "-c", "2", "-t", "4:hex", "127.0.0.1"), /0x1234[^]*0x5678/);
    assert.match(await mbpoll("-0", "-r", "310", "-t", "4:float", "-B", "127.0.0.1", "123456.0"), /Written/);
    assert.equal(await plc.say("get holding:310"), String(0x47f1));
    assert.equal(await plc.say("get holding:311"), String(0x2000));
    assert.match(await mbpoll("-0", "-r", "70", "-t", "0", "127.0.0.1", "1", "0", "1"), /Written/);
    assert.equal(await plc.say("get coil:72"), "1");
    assert.equal(await plc.say("refuse holding:400"), "ok");
    assert.match(await mbpoll("-0", "-r", "399", "-c", "3", "127.0.0.1"), /Illegal data address/i);
  });

  test("connections have answers of their own, are closed together, and are taken again", async () => {
    const all = await Promise.all(Array.from({ length: 8 }, () => openJsmodbus(plc.port)));
    const written = all.map(({ client }, i) => client.writeSingleRegister(500 + i, i + 1));
    await Promise.all(written);
    for (const { client } of all) {
      const { response } = await client.readHoldingRegisters(500, 8);
      assert.deepEqual(response.body.valuesAsArray, [1, 2, 3, 4, 5, 6, 7, 8]);
    }
    const closed = Promise.all(all.map(({ socket }) => once(socket.on("error", () => {}), "close")));
    assert.equal(await plc.say("close"), "ok");
    await closed;
    const again = await openJsmodbus(plc.port);
    assert.equal((await again.client.readHoldingRegisters(507, 1)).response.body.valuesAsArray[0], 8);
    again.socket.end();
  });
});

/** What every server has to answer to our client; it has 200 items in each table. */
async function checkServer(port, options, { more = [], pastTheEnd = "exception 2" } = {}) {
  const has = (number) => more.includes(number);
  const client = (...requests) => ask("modbus", port, options, requests);
  const isOk = (lines) => lines.forEach((line) => assert.equal(line, "ok"));
  isOk(await client("6 10 4660", "16 11 1 2 65535", "5 3 1", "15 4 1 0 1 1 0 0 1 0 1 1"));
  assert.deepEqual(await client("3 10 4", "1 3 11"), ["ok 4660 1 2 65535", "ok 1 1 0 1 1 0 0 1 0 1 1"]);
  if (has(22)) {
    isOk(await client("6 20 18", "22 20 242 37"));
    assert.deepEqual(await client("3 20 1"), ["ok 23"]);
  }
  if (has(23)) {
    assert.deepEqual(await client("23 10 3 11 77 78"), ["ok 4660 77 78"]);
  }
  assert.deepEqual(await client("6 199 5", "3 199 1", "3 199 2", "3 10 1"), ["ok", "ok 5", pastTheEnd, "ok 4660"]);
  const [inputs, discrete] = await client("4 0 125", "2 0 125");
  assert.equal(inputs, counting(1000, 125));
  assert.equal(discrete.split(" ").filter((bit) => bit === "1").length, 42);
  const values = Array.from({ length: 123 }, (_, i) => i * 500);
  isOk(await client(`16 30 ${values.join(" ")}`));
  assert.deepEqual(await client("3 30 123"), [`ok ${values.join(" ")}`]);
}

describe("our client at servers of others", { skip: !hasProgram("plc-client") && "there is no plc-client" }, () => {
  const items = 200;

  test("modbus-serial's", async () => {
    const holding = new Array(items).fill(0);
    const coils = new Array(items).fill(false);
    const within = (address) => {
      if (address >= items) {
        throw Object.assign(new Error("no such item"), { modbusErrorCode: 2 });
      }
      return address;
    };
    const memory = {
      getHoldingRegister: (address) => holding[within(address)],
      getInputRegister: (address) => 1000 + within(address),
      getCoil: (address) => coils[within(address)],
      getDiscreteInput: (address) => within(address) % 3 === 0,
      setRegister: (address, value) => void (holding[within(address)] = value),
      setCoil: (address, value) => void (coils[within(address)] = value),
    };
    const server = new ModbusSerial.ServerTCP(memory, { host: "127.0.0.1", port: 0, unitID: 1 });
    await once(server, "initialized");
    const { port } = server._server.address();
    try {
      await checkServer(port, []);
      assert.equal(holding[11], 1);
      const many = Array.from({ length: 30 }, (_, i) => `3 ${30 + i} 1`);
      assert.deepEqual(await ask("modbus", port, ["--under-way", "8"], many), many.map((_, i) => `ok ${i * 500}`));
    } finally {
      await new Promise((resolve) => server.close(resolve));
    }
  });

  test("jsmodbus's", async () => {
    const net = createServer();
    const input = Buffer.alloc(items * 2);
    const discrete = Buffer.alloc(items / 8);
    for (let i = 0; i < items; ++i) {
      input.writeUInt16BE(1000 + i, i * 2);
      discrete[i >> 3] |= i % 3 === 0 ? 1 << (i & 7) : 0;
    }
    const server = new jsmodbus.server.TCP(net, {
      holding: Buffer.alloc(items * 2), input, coils: Buffer.alloc(items / 8), discrete,
    });
    net.listen(0, "127.0.0.1");
    await once(net, "listening");
    try {
      await checkServer(net.address().port, [], { pastTheEnd: "Bad_UnknownResponse" });
      assert.equal(server.holding.readUInt16BE(20), 4660);
    } finally {
      net.close();
    }
  });

  test("libmodbus's", { skip: !hasProgram("modbus-server") && "libmodbus was not there when this was built" }, async () => {
    const server = await Plc.start("modbus-server");
    try {
      await checkServer(server.port, ["--under-way", "4"], { more: [22, 23] });
    } finally {
      await server.stop();
    }
  });
});

const canCapture = isInstalled("tshark") && hasProgram("plc-client");
test("tshark finds nothing malformed in what we say", { skip: !canCapture && "there is no tshark" }, async (t) => {
  const folder = mkdtempSync(join(tmpdir(), "busbar-modbus-"));
  const file = join(folder, "modbus.pcap");
  const plc = await responder("--refuse", "holding:9");
  const capture = spawn("tshark", ["-i", "lo", "-f", `tcp port ${plc.port}`, "-w", file, "-F", "pcap"]);
  try {
    let told = "";
    const isReady = await new Promise((resolve) => {
      capture.on("close", () => resolve(false));
      capture.stderr.on("data", (data) => (told += data).includes("Capture started") && resolve(true));
      setTimeout(() => resolve(false), 20_000).unref();
    });
    if (!isReady) {
      t.skip(`tshark cannot capture here: ${told}`);
      return;
    }
    const requests = [
      "1 0 2000", "2 0 17", "3 0 8", "4 5 125", "5 3 1", "6 3 9", "15 0 1 0 1", "16 0 1 2 3", "22 4 242 37",
      "23 0 4 10 7 8", "43 1 0", "3 9 1", "3 8 2",
    ];
    const answers = await ask("modbus", plc.port, ["--under-way", "4"], requests);
    assert.deepEqual(answers.slice(-2), ["exception 2", "exception 2"]);
    await new Promise((resolve) => setTimeout(resolve, 500)); // what is captured is written
    const ended = once(capture, "close");
    capture.kill("SIGINT");
    await ended;
    const tshark = (filter, ...fields) =>
      run("tshark", "-r", file, "-o", `mbtcp.tcp.port:${plc.port}`, "-Y", filter, "-T", "fields",
        ...fields.flatMap((field) => ["-e", field]));
    const codes = (await tshark("modbus", "modbus.func_code")).split(/[\s,]+/).filter((code) => /^\d+$/.test(code));
    assert.equal(codes.length, 2 * requests.length, "tshark reads each request and each response");
    assert.deepEqual([...new Set(codes.map(Number))].sort((a, b) => a - b), [1, 2, 3, 4, 5, 6, 15, 16, 22, 23, 43]);
    const problems = await tshark("_ws.malformed || mbtcp.prot_id != 0 || modbus && _ws.expert.severity >= 6291456", "frame.number", "_ws.expert.message");
    assert.doesNotMatch(problems, /^\d+/m, problems);
    assert.match(await tshark("modbus.exception_code", "modbus.exception_code"), /\b2\b/);
  } finally {
    capture.kill();
    await plc.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});
