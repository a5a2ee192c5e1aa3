// A node-opcua client with the settings that all tests share.
import opcua from "./opcua.mjs";

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

let lastLogin = Promise.resolve();

/** One login after the other: a password that is still being checked counts as a wrong one, and many would lock out. */
function logIn(client, identity) {
  const login = lastLogin.then(() => client.createSession(identity));
  lastLogin = login.catch(() => {});
  return login;
}

/** Connects, runs `action(session, client)` and closes whatever happens. */
export async function withSession(controller, options, identity, action, endpointUrl = controller.endpointUrl,
  library = opcua) {
  const client = await createClient(controller.folder, options, library);
  await client.connect(endpointUrl);
  try {
    const session = await logIn(client, identity);
    try {
      return await action(session, client);
    } finally {
      await session.close();
    }
  } finally {
    await client.disconnect();
  }
}
