// One node-opcua server at two ports, since to start another one takes seconds.

/**
 * Has each port tell of its own endpoints only, as if there were two servers. node-opcua knows its endpoints by the
 * host name that it announces; to whoever comes with another one it tells all. Who comes through a proxy comes to
 * `mainPort`.
 */
export function separatePorts(server, mainPort) {
  let asked; // the URL that the last client came with
  const portOf = (url) => Number(new URL(url).port);
  const find = server.findMatchingEndpoints.bind(server);
  server.findMatchingEndpoints = (url) => {
    if (url) {
      asked = url;
      return find(url);
    }
    const ports = server.endpoints.map(({ port }) => port);
    const port = asked && ports.includes(portOf(asked)) ? portOf(asked) : mainPort;
    return find(null).filter(({ endpointUrl }) => portOf(endpointUrl) === port);
  };
  const getEndpoints = server._on_GetEndpointsRequest.bind(server);
  server._on_GetEndpointsRequest = (message, channel) => {
    asked = message.request.endpointUrl;
    getEndpoints(message, channel);
  };
}
