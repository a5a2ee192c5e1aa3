#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <busbar/crypto/own_certificate.hpp>
#include <busbar/crypto/random.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/connection/context.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool::admin {

namespace own_certificate {
namespace {

const NodeId configuration{0, id::ServerConfiguration};
const NodeId rsa{0, id::RsaSha256ApplicationCertificateType};

std::vector<Variant> on_server(Connection& connection, std::uint32_t method,
                               const std::vector<Variant>& inputs, const std::string& what,
                               Duration timeout = {})
{
    return call(connection, configuration, standard(method), inputs, what, timeout);
}

/// Returns how long to wait for a Method that makes a key: on a small controller an RSA key of 4096
/// bits takes minutes, and a client that gives up does not get what was made.
Duration time_for_key(const Context& context)
{
    constexpr Duration least = std::chrono::minutes{5};
    const std::chrono::duration<double> wanted{context.options.timeout};
    return std::max(least, std::chrono::duration_cast<Duration>(wanted));
}

/// Returns the certificate of this connection, for users who may see it but not export it (W588,
/// 8-1); nothing if this user may not see it.
std::optional<crypto::Certificate> displayed(Connection& connection)
{
    const Variant shown =
        read(connection, NodeId{1, "ServerConfiguration/OwnCertificate/Thumbprint"});
    const EndpointDescription* const endpoint = connection.client().endpoint();
    if (shown.is_null() || endpoint == nullptr) {
        return std::nullopt;
    }
    auto chain = crypto::parse_chain(endpoint->server_certificate.span());
    if (!chain || chain->front().thumbprint_text() != shown.value_or<String>({}).view()) {
        return std::nullopt;
    }
    return std::move(chain->front());
}

/// Returns the server's certificate that is in use.
crypto::Certificate present(Connection& connection)
{
    const auto outputs =
        call(connection, configuration, child_of(connection, configuration, "GetCertificates"),
             {Variant{NodeId{}}}, "reading the server's certificate");
    const auto* const ders = outputs.size() < 2 ? nullptr : outputs[1].array_if<ByteString>();
    if (ders != nullptr && !ders->empty()) {
        if (auto chain = crypto::parse_chain((*ders)[0].span())) {
            return chain->front();
        }
    }
    throw Failure{status::Bad_NotFound, "the server's certificate"};
}

Exit show(Context& context, Connection& connection, const AdminArguments&)
{
    const auto shown = displayed(connection);
    print_own(context, {"own", shown ? *shown : present(connection)});
    return Exit::Good;
}

Exit export_own(Context& context, Connection& connection, const AdminArguments& arguments)
{
    if (arguments.words.size() > 1) {
        throw Failure{Exit::Usage,
                      std::to_string(arguments.words.size()) + " arguments instead of 1",
                      "expected FILE"};
    }
    const std::string file =
        arguments.words.empty() ? "ServerCertificate.der" : arguments.words.front();
    const crypto::Certificate certificate = present(connection);
    const auto der = certificate.der();
    write_file(file, {reinterpret_cast<const char*>(der.data()), der.size()});
    return report(context, "exported " + certificate.thumbprint_text() + " to " + safe(file));
}

void apply(Connection& connection)
{
    on_server(connection, id::ServerConfiguration_ApplyChanges, {}, "applying the changes");
}

Exit request(Context& context, Connection& connection, const AdminArguments& arguments)
{
    constexpr std::size_t nonce_size = 32;
    std::vector<std::byte> nonce(nonce_size);
    crypto::SystemRandom random;
    if (!random.fill(nonce)) {
        throw Failure{Exit::Failed, "no random bytes"};
    }
    const auto outputs =
        on_server(connection, id::ServerConfiguration_CreateSigningRequest,
                  {Variant{NodeId{}}, Variant{rsa}, Variant{String{arguments.subject}},
                   Variant{true}, Variant{ByteString{nonce}}},
                  "making the request", time_for_key(context));
    const auto* const der = outputs.empty() ? nullptr : outputs.front().get_if<ByteString>();
    if (der == nullptr) {
        throw Failure{status::Bad_UnexpectedError, "making the request"};
    }
    write_file(arguments.words.front(),
               {reinterpret_cast<const char*>(der->span().data()), der->span().size()});
    return report(context, "wrote a request for a CA to " + safe(arguments.words.front()));
}

Exit install(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& file = arguments.words.front();
    const std::string contents = read_file(file);
    const auto certificates = crypto::read_certificates(std::as_bytes(std::span{contents}));
    if (!certificates) {
        throw Failure{Exit::Usage, file + ": " + text(certificates.error())};
    }
    Array<ByteString> issuers;
    issuers.clear();
    for (std::size_t i = 1; i < certificates->size(); ++i) {
        issuers.push_back(ByteString{(*certificates)[i].der()});
    }
    on_server(connection, id::ServerConfiguration_UpdateCertificate,
              {Variant{NodeId{}}, Variant{rsa}, Variant{ByteString{certificates->front().der()}},
               Variant{std::move(issuers)}, Variant{String{}}, Variant{ByteString{}}},
              "installing the certificate");
    apply(connection);
    return report(context, "installed " + certificates->front().thumbprint_text());
}

/// Writes a certificate's subject as "CN=Name/O=Works", with all fields that
/// CreateSelfSignedCertificate takes.
std::string subject_name(const crypto::CertificateSubject& subject)
{
    using crypto::CertificateSubject;
    static constexpr std::array<std::pair<const char*, std::string CertificateSubject::*>, 7> all{{
        {"CN", &CertificateSubject::common_name},
        {"O", &CertificateSubject::organization},
        {"OU", &CertificateSubject::organizational_unit},
        {"L", &CertificateSubject::locality},
        {"S", &CertificateSubject::state},
        {"C", &CertificateSubject::country},
        {"DC", &CertificateSubject::domain_component},
    }};
    std::string text;
    for (const auto& [name, member] : all) {
        if (!(subject.*member).empty()) {
            text += (text.empty() ? "" : "/") + std::string{name} + "=\"" + subject.*member + "\"";
        }
    }
    return text;
}

bool is_loopback(const std::string& host)
{
    return host == "localhost" || host == "::1" || host.starts_with("127.");
}

void add(std::vector<std::string>& hosts, const std::string& host)
{
    if (std::find(hosts.begin(), hosts.end(), host) == hosts.end()) {
        hosts.push_back(host);
    }
}

/// Lists the names and addresses by which clients reach the server now: the one of this connection,
/// which the server may not know, and those that it tells.
std::vector<std::string> hosts_of_now(const std::string& connected, const Variant& told)
{
    std::vector<std::string> hosts;
    if (!is_loopback(connected)) {
        hosts.push_back(connected);
    }
    if (const auto* const more = told.array_if<String>()) {
        for (const String& each : *more) {
            add(hosts, each.str());
        }
    }
    return hosts;
}

/// Updates the address after the @ in a name such as "NxOpcUaServer@192.0.2.50" (W588, 3-2-5).
void renew_address(std::string& common_name, const std::vector<std::string>& hosts)
{
    const auto addresses_of = [](const std::vector<std::string>& names) {
        crypto::CertificateSubject parsed;
        for (const std::string& name : names) {
            crypto::add_host(parsed, name);
        }
        return parsed.ip_addresses;
    };
    const std::size_t at = common_name.rfind('@');
    if (at == std::string::npos) {
        return;
    }
    const std::string old = common_name.substr(at + 1);
    const auto now = addresses_of(hosts);
    const bool is_address = !addresses_of({old}).empty();
    if (is_address && !now.empty() && std::find(now.begin(), now.end(), old) == now.end()) {
        common_name.replace(at + 1, std::string::npos, now.front());
    }
}

/// Returns the configured names for the certificate; null if the server does not tell.
Variant configured(Connection& connection, const std::string& what)
{
    return read(connection, NodeId{1, "ServerConfiguration/OwnCertificate/Configured" + what});
}

Exit regenerate(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const crypto::Certificate before = present(connection);
    make_sure(context, arguments,
              "Clients have to trust the new certificate. Replace " + before.thumbprint_text() +
                  "?");
    std::vector<std::string> hosts = arguments.hosts;
    if (hosts.empty()) {
        hosts = hosts_of_now(host_of(context.options.url), configured(connection, "Hosts"));
    }
    crypto::CertificateSubject kept = crypto::subject_of(before);
    renew_address(kept.common_name, hosts);
    if (arguments.hosts.empty()) {
        for (const std::string& host : before.host_names()) {
            add(hosts, host);
        }
    }
    crypto::CertificateSubject names;
    for (const std::string& host : hosts) {
        crypto::add_host(names, host);
    }
    const std::string wanted = configured(connection, "Subject").value_or<String>(String{""}).str();
    const auto strings = [](const std::vector<std::string>& texts) {
        Array<String> list;
        list.clear();
        for (const std::string& text : texts) {
            list.push_back(String{text});
        }
        return Variant{std::move(list)};
    };
    const std::string what = "making a new certificate";
    call(connection, configuration, child_of(connection, configuration, "DeleteCertificate"),
         {Variant{NodeId{}}, Variant{rsa}}, what);
    const std::string subject = !arguments.subject.empty() ? arguments.subject
                                : !wanted.empty()          ? wanted
                                                           : subject_name(kept);
    const auto outputs = with_hint(
        [&] {
            return call(connection, configuration,
                        child_of(connection, configuration, "CreateSelfSignedCertificate"),
                        {Variant{NodeId{}}, Variant{rsa}, Variant{String{subject}},
                         strings(names.dns_names), strings(names.ip_addresses),
                         Variant{static_cast<std::uint16_t>(arguments.days)},
                         Variant{std::uint16_t{0}}},
                        what, time_for_key(context));
        },
        status::Bad_InvalidArgument,
        "a subject is CN=Name/O=Works/OU=Line/L=Town/S=State/C=JP: a value with / or , stands in "
        "quotation marks, and C is a country of two letters");
    apply(connection);
    const auto* const der = outputs.empty() ? nullptr : outputs.front().get_if<ByteString>();
    const auto made =
        crypto::Certificate::parse(der != nullptr ? der->span() : std::span<const std::byte>{});
    return report(context, made ? "the server's certificate is " + made->thumbprint_text()
                                : "the server has a new certificate");
}

} // namespace
} // namespace own_certificate

void add_own(CLI::App& admin, Run& run)
{
    using namespace own_certificate;
    Group group{admin, run, "cert", "The server's own certificate."};
    auto& arguments = group.arguments();
    constexpr unsigned max_days = 7'305; // twenty years
    group.add("show", "Shows all that it says.", 0, "URL", show);
    group.add_any("export",
                  "Writes it to a DER file for clients to trust, ServerCertificate.der by default.",
                  "FILE", export_own);
    auto* asked = group.add("request", "Writes a request for a CA to a file.", 1, "FILE", request);
    group.add("install", "Puts what a CA issued for the request in force.", 1, "FILE", install);
    auto* made =
        group.add("regenerate", "Has the server make a new one for itself.", 0, "URL", regenerate);
    for (auto* command : {asked, made}) {
        command->add_option("--subject", arguments.subject,
                            "CN=Name/O=Organization; by default as it is, and of a new one as "
                            "configured");
    }
    made->add_option("--host", arguments.hosts,
                     "all names and addresses that clients connect to; as they are by default");
    made->add_option("--days", arguments.days, "how long it is valid")
        ->check(CLI::Range(1U, max_days))
        ->capture_default_str();
    made->add_flag("--yes", arguments.is_sure, "do not ask");
}

} // namespace busbar::tool::admin
