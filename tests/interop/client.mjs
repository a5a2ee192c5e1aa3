// A node-opcua client with the settings that all tests share.
import opcua from "node-opcua";

const { MessageSecurityMode, SecurityPolicy, UserTokenType } = opcua;

export const modes = {
  None: { securityMode: MessageSecurityMode.None, securityPolicy: SecurityPolicy.None },
  Sign: { securityMode: MessageSecurityMode.Sign, securityPolicy: SecurityPolicy.Basic256Sha256 },
  SignAndEncrypt: { securityMode: MessageSecurityMode.SignAndEncrypt, securityPolicy: SecurityPolicy.Basic256Sha256 },
};

export const anonymous = { type: UserTokenType.Anonymous };
export const named = ({ userName, password }) => ({ type: UserTokenType.UserName, userName, password });

/** Client certificates and keys lie in `folder`, made on first use. `library` is node-opcua or another version of it. */
export async function createClient(folder, options, library = opcua) {
  const clientCertificateManager = new library.OPCUACertificateManager({
    rootFolder: `${folder}/client-pki`,
    automaticallyAcceptUnknownCertificate: true,
  });
  await clientCertificateManager.initialize();
  return library.OPCUAClient.create({
    applicationName: "Busbar interoperation test",
    clientCertificateManager,
    endpointMustExist: false,
    connectionStrategy: { initialDelay: 50, maxDelay: 200, maxRetry: 20 },
    ...options,
  });
}

/** Connects, runs `action(session, client)` and closes whatever happens. */
export async function withSession(controller, options, identity, action, endpointUrl = controller.endpointUrl,
  library = opcua) {
  const client = await createClient(controller.folder, options, library);
  await client.connect(endpointUrl);
  try {
    const session = await client.createSession(identity);
    try {
      return await action(session, client);
    } finally {
      await session.close();
    }
  } finally {
    await client.disconnect();
  }
}
