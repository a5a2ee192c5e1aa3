import opcua from "./opcua.mjs";

/** Tells with what security whoever logs in has come, a line each. */
export function tellLogins(server) {
  server.on("session_activated", ({ channel }, token) => {
    const policy = channel.securityPolicy.split("#")[1];
    const mode = opcua.MessageSecurityMode[channel.securityMode];
    process.stdout.write(`login: ${policy} ${mode} ${token.constructor.name}\n`);
  });
}
