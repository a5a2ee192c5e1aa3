// A TCP proxy with room for one connection, as a server of the Nano profile has it: others are refused with an Error
// message (Part 6, 7.1.2.5), and the place is free again some time after a connection has ended.
import { connect, createServer } from "node:net";

const badTcpNotEnoughResources = 0x80810000;

function errorMessage(status) {
  const message = Buffer.alloc(16);
  message.write("ERRF");
  message.writeUInt32LE(message.length, 4);
  message.writeUInt32LE(status, 8);
  message.writeInt32LE(-1, 12);
  return message;
}

/** Listens on a free port of `host` and forwards to `target`; a place is free `releaseMs` after its connection. */
export async function startGate(target, { releaseMs = 0, host = "127.0.0.1" } = {}) {
  let isTaken = false;
  const counts = { admitted: 0, refused: 0 };
  const server = createServer({ allowHalfOpen: true }, (client) => {
    client.on("error", () => {});
    if (isTaken) {
      ++counts.refused;
      client.resume().end(errorMessage(badTcpNotEnoughResources));
      return;
    }
    isTaken = true;
    ++counts.admitted;
    const upstream = connect(target, "localhost");
    upstream.on("error", () => client.destroy());
    client.pipe(upstream);
    upstream.pipe(client, { end: false });
    client.on("close", () => upstream.destroy());
    upstream.on("close", () => {
      const release = () => (isTaken = false);
      releaseMs === 0 ? release() : setTimeout(release, releaseMs);
      client.end();
    });
  });
  await new Promise((resolve) => server.listen(0, host, resolve));
  return {
    counts,
    endpointUrl: `opc.tcp://localhost:${server.address().port}`,
    stop: () => new Promise((resolve) => server.close(resolve)),
  };
}
