// SLMP: our simulated PLC against the client mcprotocol, and our client engine against it over TCP and
// UDP, in both forms of frames. (tshark knows no SLMP, and there is no free server to test against.)
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import McProtocol from "mcprotocol";
import { ask, counting, hasProgram, Plc } from "./plc.mjs";

const responder = (...args) => Plc.start("busbar-plc-responder", "slmp", ...args);

/** A connection of mcprotocol, with 3E frames in binary. */
class Client {
  static connect(port, octalInputOutput) {
    const client = new Client();
    client.connection = new McProtocol();
    return new Promise((resolve, reject) => {
      client.connection.initiateConnection(
        { host: "127.0.0.1", port, ascii: false, frame: "3E", octalInputOutput },
        (error) => (error === undefined ? resolve(client) : reject(error)));
    });
  }
  read(...addresses) {
    const { connection } = this;
    connection.removeItems();
    connection.addItems(addresses);
    return new Promise((resolve, reject) =>
      connection.readAllItems((isBad, values) => (isBad ? reject(new Error(JSON.stringify(values))) : resolve(values))));
  }
  /** Returns when all requests have an answer: mcprotocol calls each 3E answer to a write bad, since it
   * expects the first byte of a 1E answer. */
  write(addresses, values) {
    return new Promise((resolve) => assert.ok(!this.connection.writeItems(addresses, values, resolve)));
  }
  close() {
    this.connection.dropConnection();
  }
}

for (const [family, isOctal] of [["iqr", false], ["fx5", true]]) {
  describe(`mcprotocol at a simulated PLC, ${family}`, () => {
    let plc;
    let client;
    before(async () => {
      plc = await responder("--plc", family, "--set", "D0=17", "--set", "D1=-3", "--set", "X10=1");
      client = await Client.connect(plc.port, isOctal);
    });
    after(async () => {
      client?.close();
      assert.equal(await plc.stop(), 0);
    });

    test("reads words, bits and numbers of other types", async () => {
      assert.equal(await plc.say("set D11 0x47F1"), "ok");
      assert.equal(await plc.say("set D10 0x2000"), "ok");
      assert.equal(await plc.say("set M20 1"), "ok");
      const x = isOctal ? "X10" : "X16"; // it reads X in octal or in decimal
      const values = await client.read("D0,2", "DFLOAT10", "M19,3", x, "D0.4");
      assert.deepEqual(values["D0,2"], [17, -3]);
      assert.equal(values.DFLOAT10, 123456);
      assert.deepEqual(values["M19,3"], [false, true, false]);
      assert.equal(values[x], true);
      assert.equal(values["D0.4"], true);
    });

    test("writes words and floats, long arrays in several requests", async () => {
      const words = Array.from({ length: 1500 }, (_, i) => i);
      await client.write(["D100,1500"], [words]);
      assert.equal(await plc.say("get D1599"), "1499");
      assert.deepEqual((await client.read("D100,1500"))["D100,1500"], words);
      await client.write(["DFLOAT50", "D60"], [1.5, -2]);
      assert.equal(await plc.say("get D51"), String(0x3fc0));
      assert.equal(await plc.say("get D60"), "65534");
      // It sends the subcommand of bits with its bytes exchanged, which a PLC refuses.
      await client.write("M100,2", [true, true]);
      assert.equal(await plc.say("get M100"), "0");
      assert.equal((await client.read("D60")).D60, -2);
    });
  });
}

describe("our client at a simulated PLC", { skip: !hasProgram("plc-client") && "there is no plc-client" }, () => {
  for (const transport of [[], ["--udp"]]) {
    for (const form of [["--3e"], []]) {
      const what = `${transport[0] ?? "TCP"} ${form[0] ?? "4E"}`;
      test(`reads, writes, and is refused: ${what}`, async () => {
        const plc = await responder(...transport, "--set", "D100=1234", "--label", "Line.Speed=2:2C01", "--set", "W1F=9");
        const client = (...requests) => ask("slmp", plc.port, [...transport, ...form, "--under-way", "4"], requests);
        try {
          assert.deepEqual(
            await client("read D100 1", "write D200 1 2 65535", "set M5 1 0 1", "read D200 3", "bits M5 3", "read W1F 1"),
            ["ok 1234", "ok", "ok", "ok 1 2 65535", "ok 1 0 1", "ok 9"]);
          assert.equal(await plc.say("get D202"), "65535");
          assert.deepEqual(
            await client("random D100 W1F D201", "blocks D200 3 D100 1", "type", "echo ABC12", "label line.speed", "label Other"),
            ["ok 1234 9 2", "ok 1 2 65535 1234", "ok R08CPU", "ok ABC12", "ok 2C 01", "end 40C0"]);
          assert.equal(await plc.say("refuse D300"), "ok");
          assert.deepEqual(await client("read D299 3", "read D299 1", "read D0 960", "read D0 961"),
            ["end 4031", "ok 0", "end 4031", "end C051"]);
          assert.equal(await plc.say("allow"), "ok");
          const numbers = Array.from({ length: 960 }, (_, i) => i);
          assert.deepEqual(await client(`write D1000 ${numbers.join(" ")}`, "read D1000 960"), ["ok", counting(0, 960)]);
          assert.equal(await plc.say("slow 200"), "ok");
          const many = Array.from({ length: 6 }, (_, i) => `read D${1000 + i} 1`);
          assert.deepEqual(await client(...many), many.map((_, i) => `ok ${i}`));
        } finally {
          assert.equal(await plc.stop(), 0);
        }
      });
    }
  }

  test("a PLC in STOP answers, and its values stand still; the client can start it", async () => {
    const plc = await responder("--count", "D0", "--stop");
    try {
      const read = () => ask("slmp", plc.port, [], ["read D0 1"]);
      assert.deepEqual(await read(), ["ok 0"]);
      assert.deepEqual(await ask("slmp", plc.port, [], ["run"]), ["ok"]);
      while ((await read())[0] === "ok 0");
    } finally {
      await plc.stop();
    }
  });

  test("a port that takes 3E only leaves 4E without an answer; Q and FX5 refuse what they lack", async () => {
    const port = await responder("--plc", "q", "--set", "D1=5");
    const fx5 = await responder("--plc", "fx5");
    try {
      assert.deepEqual(await ask("slmp", port.port, [], ["read D1 1"]), ["Bad_Timeout"]);
      assert.deepEqual(await ask("slmp", port.port, ["--3e"], ["type", "read D1 1", "label A"]), ["end C059", "ok 5", "end C059"]);
      assert.deepEqual(await ask("slmp", fx5.port, [], ["read D0 961", "read D32768 1", "label A"]), ["end C052", "end C056", "end C059"]);
    } finally {
      await port.stop();
      await fx5.stop();
    }
  });
});
