// Certificates and revocation lists for tests, as a certificate authority would issue them.
import "reflect-metadata";
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import * as x509 from "@peculiar/x509";

const algorithm = {
  name: "RSASSA-PKCS1-v1_5", hash: "SHA-256", publicExponent: new Uint8Array([1, 0, 1]), modulusLength: 2048,
};
const day = 86_400_000;
const { KeyUsageFlags: Usage } = x509;
let serial = 1000;

const makeKeys = () => crypto.subtle.generateKey(algorithm, true, ["sign", "verify"]);
const validity = () => ({ notBefore: new Date(Date.now() - day), notAfter: new Date(Date.now() + 365 * day) });

/** A root, or an authority below `issuer`. */
export async function makeAuthority(name, issuer) {
  const keys = await makeKeys();
  const certificate = await x509.X509CertificateGenerator.create({
    serialNumber: (++serial).toString(16), ...validity(), signingAlgorithm: algorithm, publicKey: keys.publicKey,
    subject: `CN=${name}`, issuer: issuer?.certificate.subject ?? `CN=${name}`,
    signingKey: issuer?.keys.privateKey ?? keys.privateKey,
    extensions: [
      new x509.BasicConstraintsExtension(true, undefined, true),
      new x509.KeyUsagesExtension(Usage.keyCertSign | Usage.cRLSign, true),
      await x509.SubjectKeyIdentifierExtension.create(keys.publicKey),
      await x509.AuthorityKeyIdentifierExtension.create(issuer?.keys.publicKey ?? keys.publicKey),
    ],
  });
  return { keys, certificate };
}

/** What `authority` has revoked. */
export async function makeRevocationList(authority, revoked = []) {
  const list = await x509.X509CrlGenerator.create({
    issuer: authority.certificate.subject, thisUpdate: new Date(Date.now() - day),
    nextUpdate: new Date(Date.now() + 30 * day), signingAlgorithm: algorithm, signingKey: authority.keys.privateKey,
    entries: revoked.map(({ certificate }) => ({
      serialNumber: certificate.serialNumber, revocationDate: new Date(Date.now() - day / 2),
    })),
  });
  return Buffer.from(list.rawData);
}

const applicationExtensions = (applicationUri, addresses, isSelfSigned) => [
  new x509.KeyUsagesExtension(
    Usage.digitalSignature | Usage.nonRepudiation | Usage.keyEncipherment | Usage.dataEncipherment |
      (isSelfSigned ? Usage.keyCertSign : 0), true),
  new x509.ExtendedKeyUsageExtension([x509.ExtendedKeyUsage.clientAuth, x509.ExtendedKeyUsage.serverAuth]),
  new x509.SubjectAlternativeNameExtension([
    { type: "url", value: applicationUri }, { type: "dns", value: "localhost" },
    ...addresses.map((value) => ({ type: "ip", value })),
  ]),
];
const userExtensions = () => [new x509.KeyUsagesExtension(Usage.digitalSignature, true)];

/** A certificate with its key; an application's, for IP addresses too, if it has an ApplicationUri, else a user's. */
export async function makeCertificate(name, { issuer, applicationUri, addresses = [] } = {}) {
  const keys = await makeKeys();
  const certificate = await x509.X509CertificateGenerator.create({
    serialNumber: (++serial).toString(16), ...validity(), signingAlgorithm: algorithm, publicKey: keys.publicKey,
    subject: `CN=${name}`, issuer: issuer?.certificate.subject ?? `CN=${name}`,
    signingKey: issuer?.keys.privateKey ?? keys.privateKey,
    extensions: [
      new x509.BasicConstraintsExtension(false, undefined, true),
      ...(applicationUri ? applicationExtensions(applicationUri, addresses, !issuer) : userExtensions()),
      await x509.SubjectKeyIdentifierExtension.create(keys.publicKey),
      await x509.AuthorityKeyIdentifierExtension.create(issuer?.keys.publicKey ?? keys.publicKey),
    ],
  });
  return { keys, certificate, applicationUri };
}

export const derOf = ({ certificate }) => Buffer.from(certificate.rawData);

export async function keyPemOf({ keys }) {
  const bytes = Buffer.from(await crypto.subtle.exportKey("pkcs8", keys.privateKey));
  return `-----BEGIN PRIVATE KEY-----\n${bytes.toString("base64").replace(/(.{64})/g, "$1\n")}\n-----END PRIVATE KEY-----\n`;
}

/** Writes certificate and key where node-opcua reads them; the options for its client. */
export async function clientOptions(folder, name, made) {
  mkdirSync(folder, { recursive: true });
  const certificateFile = join(folder, `${name}.pem`);
  const privateKeyFile = join(folder, `${name}_key.pem`);
  writeFileSync(certificateFile, made.certificate.toString("pem") + "\n");
  writeFileSync(privateKeyFile, await keyPemOf(made));
  return { certificateFile, privateKeyFile, applicationUri: made.applicationUri };
}

/** DER of a certificate for a request, with the names that it asks for. */
export async function signRequest(authority, der) {
  const request = new x509.Pkcs10CertificateRequest(der);
  assert.ok(await request.verify());
  const names = request.getExtension("2.5.29.17");
  const certificate = await x509.X509CertificateGenerator.create({
    serialNumber: (++serial).toString(16), ...validity(), signingAlgorithm: algorithm, publicKey: request.publicKey,
    subject: request.subject, issuer: authority.certificate.subject, signingKey: authority.keys.privateKey,
    extensions: [
      new x509.BasicConstraintsExtension(false, undefined, true),
      ...applicationExtensions("urn:replaced", [], false).slice(0, 2),
      names,
      await x509.SubjectKeyIdentifierExtension.create(request.publicKey),
      await x509.AuthorityKeyIdentifierExtension.create(authority.keys.publicKey),
    ],
  });
  return Buffer.from(certificate.rawData);
}
