#include "failure.hpp"

#include <algorithm>
#include <array>

#include <busbar/core/status_codes.hpp>

namespace busbar::tool {

namespace {

struct Row {
    StatusCode status;
    StatusHelp help;
};

constexpr std::array connection{
    Row{status::Bad_Timeout,
        {"no answer in time", "give it longer with --timeout, or check host, port and firewall"}},
    Row{status::Bad_CommunicationError,
        {"the connection could not be made or broke",
         "check that the server runs and that host and port are right"}},
    Row{status::Bad_NotConnected,
        {"there is no connection", "check that the server runs and that host and port are right"}},
    Row{status::Bad_ConnectionRejected,
        {"the server does not accept the connection",
         "check host and port; the server may be full or closed to this machine"}},
    Row{status::Bad_ConnectionClosed,
        {"the server closed the connection",
         "often it does not trust our certificate, or was stopped; see its log"}},
    Row{status::Bad_ServerNotConnected,
        {"there is no session with the server", "check that the server runs"}},
    Row{status::Bad_SecureChannelClosed,
        {"the server closed the secure channel",
         "often it does not trust our certificate; see its log"}},
    Row{status::Bad_TcpEndpointUrlInvalid,
        {"the server does not know this URL",
         "URLs look like opc.tcp://host:4840/path; see `busbar discover`"}},
    Row{status::Bad_TcpServerTooBusy, {"the server has too much to do", "try again later"}},
    Row{status::Bad_TcpMessageTypeInvalid,
        {"what answers at this address does not speak OPC UA", "check host and port"}},
    Row{status::Bad_ConfigurationError,
        {"the server cannot do this as it is configured: a new program or project that cannot be "
         "served has changed nothing, and a PLC may refuse the address of a Variable",
         "the log of the controller has the reason; for a PLC, LastRefusal of its Object "
         "Connection has it, and busbar-controller --check asks for each address"}},
    Row{status::Bad_ServerHalted,
        {"the server is not running its application",
         "`busbar admin status` says why, and `busbar admin shutdown --restart` starts it again"}},
    Row{status::Bad_Shutdown, {"the server is about to stop", "try again later"}},
    Row{status::Bad_SessionClosed, {"the server closed the session", ""}},
    Row{status::Bad_TooManySessions,
        {"the server has no session left", "close other clients, or try again in a minute"}},
    Row{status::Bad_NoCommunication,
        {"the server does not reach its device",
         "check the device and its cable; LastError below /Objects/Module of a controller with "
         "an information model names a label that cannot be used"}},
    Row{status::Bad_RequestInterrupted, {"it was interrupted", ""}},
};

constexpr std::array security{
    Row{status::Bad_SecurityChecksFailed,
        {"the server refuses us and does not say why",
         "most likely it does not know our certificate: have its administrator trust it; `busbar "
         "cert show` tells where it lies"}},
    Row{status::Bad_CertificateUntrusted,
        {"the certificate is not trusted", "see `busbar cert list`"}},
    Row{status::Bad_CertificateChainIncomplete,
        {"a certificate above it is missing", "add the authority: `busbar cert trust FILE`"}},
    Row{status::Bad_CertificateTimeInvalid,
        {"the certificate is expired, or not valid yet",
         "check the clocks of both machines, or have the certificate renewed"}},
    Row{status::Bad_CertificateHostNameInvalid,
        {"the certificate does not name the host of the URL",
         "use a host name that it names, see `busbar endpoints`"}},
    Row{status::Bad_CertificateUriInvalid,
        {"the certificate is of another application than the one that sent it", ""}},
    Row{status::Bad_CertificateRevoked,
        {"the certificate was revoked", "ask its issuer for a new one"}},
    Row{status::Bad_CertificateRevocationUnknown,
        {"there is no current revocation list of the certificate's issuer",
         "put it into the store: `busbar cert trust FILE.crl`"}},
    Row{status::Bad_CertificateUseNotAllowed, {"the certificate was not issued for this use", ""}},
    Row{status::Bad_CertificatePolicyCheckFailed,
        {"the certificate is too weak for the security policy", "try another --policy"}},
    Row{status::Bad_CertificateInvalid, {"the certificate cannot be read", ""}},
    Row{status::Bad_SecurityPolicyRejected,
        {"the server has no endpoint for UA TCP with a security policy that we accept",
         "see `busbar endpoints`; --policy names others, --insecure allows none at all"}},
    Row{status::Bad_SecurityModeRejected,
        {"no endpoint of the server has a security mode that we accept",
         "see `busbar endpoints`; --mode Sign accepts less, --insecure allows none at all"}},
    Row{status::Bad_IdentityTokenRejected,
        {"the server does not accept this kind of login, or this user",
         "see `busbar endpoints` for the kinds; log in with --user and --password-file"}},
    Row{status::Bad_IdentityTokenInvalid,
        {"the server cannot make sense of the login",
         "see `busbar endpoints` for the kinds of login it knows"}},
    Row{status::Bad_UserAccessDenied,
        {"the user may not do this, or name or password are wrong",
         "log in as another user with --user and --password-file"}},
};

constexpr std::array nodes{
    Row{status::Bad_NodeIdUnknown,
        {"the server has no such node", "look for it with `busbar browse`"}},
    Row{status::Bad_NodeIdInvalid,
        {"this is not a node id", "write i=2258, \"ns=2;s=Name\", \"nsu=urn:x;s=Name\" or a path "
                                  "such as /Objects/2:Machine; a server, opc.tcp://host:4840, "
                                  "comes before all nodes"}},
    Row{status::Bad_BrowseNameInvalid,
        {"this is not a browse path",
         "write /Objects/2:Machine/2:Speed, with the names' namespaces"}},
    Row{status::Bad_NoMatch,
        {"no node lies at this path", "look with `busbar browse`; names need their namespace"}},
    Row{status::Bad_TooManyMatches,
        {"more than one node lies at this path",
         "give the names their namespace, or use a node id"}},
    Row{status::Bad_AttributeIdInvalid, {"the node has no such attribute", ""}},
    Row{status::Bad_IndexRangeInvalid, {"this is not an index range", "write 3, 0:9 or 1,0:2"}},
    Row{status::Bad_IndexRangeNoData, {"the value has nothing in this range", ""}},
    Row{status::Bad_NotReadable, {"the value may not be read", ""}},
    Row{status::Bad_NotWritable, {"the value may not be written", ""}},
    Row{status::Bad_TypeMismatch,
        {"the value is not of the type that the server expects",
         "see the DataType with `busbar read --all`, or give one with --type"}},
    Row{status::Bad_OutOfRange, {"the value is too large or too small", ""}},
    Row{status::Bad_SyntaxError, {"the text cannot be read as a value of this type", ""}},
    Row{status::Bad_WaitingForInitialData, {"the server has no value yet", "try again"}},
    Row{status::Bad_WriteNotSupported,
        {"the server writes neither a status or time, nor a part of this array, nor fewer or more "
         "elements than it has",
         ""}},
    Row{status::Bad_MethodInvalid,
        {"the object has no such method", "look with `busbar browse OBJECT`"}},
    Row{status::Bad_NotExecutable, {"the method may not be called now", ""}},
    Row{status::Bad_ArgumentsMissing, {"the method wants more arguments", ""}},
    Row{status::Bad_TooManyArguments, {"the method wants fewer arguments", ""}},
    Row{status::Bad_InvalidArgument,
        {"the server refuses an argument and does not say which",
         "`busbar browse METHOD` shows the method's arguments; administrators of a "
         "busbar-controller get the reason over an encrypted channel"}},
    Row{status::Bad_ServiceUnsupported, {"the server does not offer this service", ""}},
    Row{status::Bad_NotSupported, {"the server does not support this", ""}},
    Row{status::Bad_NotImplemented, {"the server does not support this", ""}},
    Row{status::Bad_FilterNotAllowed, {"the node sends no events", "try the Server, i=2253"}},
    Row{status::Bad_TooManyOperations, {"that is more than the server takes at once", ""}},
    Row{status::Bad_EncodingLimitsExceeded,
        {"an array or a text is longer than the other side accepts",
         "write a part of it with --range; MaxArrayLength in /Objects/Server/ServerCapabilities "
         "tells the limit, which a busbar-controller has as array_length in [limits], and those of "
         "texts as string_length and byte_string_length"}},
    Row{status::Bad_RequestTooLarge,
        {"the request is larger than the server accepts",
         "write a part with --range; a busbar-controller accepts more with message_size in its "
         "[limits]"}},
    Row{status::Bad_ResponseTooLarge,
        {"the answer is larger than we accept or the server sends",
         "read a part with --range, or fewer nodes at once"}},
    Row{status::Bad_DecodingError,
        {"a message could not be decoded",
         "texts and names must be UTF-8; if they are, one of the two OPC UA stacks is at fault"}},
    Row{status::Bad_OutOfMemory, {"the other side has no memory left", ""}},
};

template <std::size_t N>
const StatusHelp* find(const std::array<Row, N>& rows, StatusCode status)
{
    const auto found = std::find_if(rows.begin(), rows.end(),
                                    [&](const Row& row) { return row.status == status; });
    return found == rows.end() ? nullptr : &found->help;
}

} // namespace

StatusHelp help_for(StatusCode status)
{
    const StatusCode code = status.code();
    for (const StatusHelp* help :
         {find(connection, code), find(security, code), find(nodes, code)}) {
        if (help != nullptr) {
            return *help;
        }
    }
    return {};
}

} // namespace busbar::tool
