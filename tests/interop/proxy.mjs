// A TCP proxy that can cut its connections and record them as a capture file.
import { writeFileSync } from "node:fs";
import { connect, createServer } from "node:net";

const linkTypeRaw = 101;
const segmentSize = 1400;

function pcapHeader() {
  const header = Buffer.alloc(24);
  header.writeUInt32LE(0xa1b2c3d4, 0);
  header.writeUInt16LE(2, 4);
  header.writeUInt16LE(4, 6);
  header.writeUInt32LE(0x40000, 16);
  header.writeUInt32LE(linkTypeRaw, 20);
  return header;
}

/** One IPv4 packet with a TCP segment; checksums stay 0, which a reader of captures accepts. */
function packet(from, to, sequence, acknowledged, flags, payload) {
  const ip = Buffer.alloc(40);
  ip[0] = 0x45;
  ip.writeUInt16BE(40 + payload.length, 2);
  ip[8] = 64;
  ip[9] = 6;
  ip.writeUInt32BE(0x7f000001, 12);
  ip.writeUInt32BE(0x7f000001, 16);
  ip.writeUInt16BE(from, 20);
  ip.writeUInt16BE(to, 22);
  ip.writeUInt32BE(sequence >>> 0, 24);
  ip.writeUInt32BE(acknowledged >>> 0, 28);
  ip[32] = 0x50;
  ip[33] = flags;
  ip.writeUInt16BE(65535, 34);
  return Buffer.concat([ip, payload]);
}

class Recorder {
  constructor() {
    this.records = [pcapHeader()];
    this.count = 0;
  }
  add(data) {
    const header = Buffer.alloc(16);
    header.writeUInt32LE(Math.floor(this.count / 1000), 0);
    header.writeUInt32LE((this.count++ % 1000) * 1000, 4);
    header.writeUInt32LE(data.length, 8);
    header.writeUInt32LE(data.length, 12);
    this.records.push(header, data);
  }
}

/** Records both directions of one connection as if it were captured. */
class Conversation {
  constructor(recorder, clientPort, serverPort) {
    this.recorder = recorder;
    this.ports = [clientPort, serverPort];
    this.next = [1, 1];
    recorder.add(packet(clientPort, serverPort, 0, 0, 0x02, Buffer.alloc(0)));
    recorder.add(packet(serverPort, clientPort, 0, 1, 0x12, Buffer.alloc(0)));
  }
  sent(side, data) {
    for (let at = 0; at < data.length; at += segmentSize) {
      const part = data.subarray(at, at + segmentSize);
      this.recorder.add(packet(this.ports[side], this.ports[1 - side], this.next[side], this.next[1 - side], 0x18, part));
      this.next[side] += part.length;
    }
  }
}

/** Listens on a free port and forwards to `target`. */
export async function startProxy(target) {
  const recorder = new Recorder();
  const sockets = new Set();
  let nextPort = 50000;
  const server = createServer((client) => {
    const upstream = connect(target, "127.0.0.1");
    const conversation = new Conversation(recorder, nextPort++, 4840);
    const ends = [client, upstream];
    ends.forEach((from, side) => {
      const to = ends[1 - side];
      sockets.add(from);
      from.on("data", (data) => {
        conversation.sent(side, data);
        to.write(data);
      });
      from.on("close", () => {
        sockets.delete(from);
        to.destroy();
      });
      from.on("error", () => to.destroy());
    });
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return {
    port: server.address().port,
    /** Cuts every connection without a goodbye. */
    cut() {
      for (const socket of sockets) socket.destroy();
    },
    save(file) {
      writeFileSync(file, Buffer.concat(recorder.records));
    },
    stop() {
      this.cut();
      return new Promise((resolve) => server.close(resolve));
    },
  };
}
