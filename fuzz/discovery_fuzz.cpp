#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/client/discovery.hpp>
#include <busbar/client/endpoint_choice.hpp>
#include <busbar/client/response_limits.hpp>

#include "fuzz_root.hpp"
#include "fuzz_script.hpp"
#include "require.hpp"

namespace discovery_fuzz {

using namespace busbar;
using fuzz::require;

namespace {

constexpr std::string_view reached_by = "opc.tcp://plc:4840";
constexpr std::string_view transport =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
/// What choose_endpoint() takes at most.
constexpr std::size_t max_endpoints = 500;
/// Of those, so many are also looked at alone.
constexpr std::size_t max_alone = 4;

/// A server whose one answer is given.
class OneAnswer final : public client::Requester {
public:
    void answer(std::vector<std::byte> bytes)
    {
        const auto handler = std::exchange(handler_, nullptr);
        handler(client::ResponseBody{std::move(bytes)});
    }

    void cancel(client::RequestId) override { handler_ = nullptr; }
    [[nodiscard]] const client::ServerInfo& server() const override { return info_; }
    [[nodiscard]] TimePoint now() const override { return {}; }
    [[nodiscard]] const binary::DecodeLimits& decode_limits() const override
    {
        return client::response_limits;
    }

private:
    client::RequestId start(Encode, Handler<client::ResponseBody> handler,
                            const client::RequestOptions&) override
    {
        handler_ = std::move(handler);
        return 1;
    }

    client::ServerInfo info_;
    Handler<client::ResponseBody> handler_;
};

/// Lines that anybody may read, of a length that a log can take.
class CheckedLog final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view text) override
    {
        require(text.size() < 64'000 && printable(text, text.size()) == text);
        warns = warns || text.starts_with("INSECURE");
    }

    bool warns{false};
};

template <typename Response>
std::vector<std::byte> body_of(std::span<const std::byte> content)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, NodeId{0, Response::binary_encoding_id});
    writer.bytes(content);
    return sink.take(writer.written());
}

/// Gives `content` as the answer to what `ask` asks; what came of it, which must be told once.
/// Its elements take some bytes each, whatever count the answer claims.
template <typename Response, typename T, typename Ask>
std::optional<T> asked(std::span<const std::byte> content, Ask ask)
{
    OneAnswer server;
    std::optional<Result<T>> told;
    ask(server, [&](Result<T> result) {
        require(!told);
        told = std::move(result);
    });
    server.answer(body_of<Response>(content));
    require(told.has_value());
    return *told ? std::optional<T>{std::move(**told)} : std::nullopt;
}

std::optional<std::vector<EndpointDescription>> endpoints_in(std::span<const std::byte> content)
{
    using List = std::vector<EndpointDescription>;
    return asked<GetEndpointsResponse, List>(content, [](auto& server, auto done) {
        client::get_endpoints(server, reached_by, std::move(done));
    });
}

void find(std::span<const std::byte> content)
{
    using List = std::vector<ApplicationDescription>;
    const auto servers = asked<FindServersResponse, List>(content, [](auto& server, auto done) {
        client::find_servers(server, reached_by, std::move(done), {"urn:a"});
    });
    require(!servers || servers->size() <= content.size() / 25);
}

void find_on_network(std::span<const std::byte> content)
{
    using Found = FindServersOnNetworkResponse;
    const auto found = asked<Found, Found>(content, [](auto& server, auto done) {
        client::find_servers_on_network(server, std::move(done), {"DA"});
    });
    require(!found || found->servers.size() <= content.size() / 16);
}

template <std::size_t size>
String one_of(const std::array<std::string_view, size>& texts, fuzz::Script& script)
{
    const std::size_t choice = script.byte();
    if (choice >= 0xf0) {
        const auto raw = script.bytes(choice - 0xf0);
        return String{std::string_view{reinterpret_cast<const char*>(raw.data()), raw.size()}};
    }
    return String{texts[choice % size]};
}

String policy_uri(fuzz::Script& script)
{
    static constexpr std::array<std::string_view, 6> uris{
        "http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256",
        "http://opcfoundation.org/UA/SecurityPolicy#Aes256_Sha256_RsaPss",
        "http://opcfoundation.org/UA/SecurityPolicy#None",
        "http://opcfoundation.org/UA/SecurityPolicy#Basic128Rsa15",
        "http://opcfoundation.org/UA/SecurityPolicy#Aes128_Sha256_RsaOaep",
        ""};
    return one_of(uris, script);
}

UserTokenPolicy token(fuzz::Script& script)
{
    static constexpr std::array<std::string_view, 3> ids{"a", "b", ""};
    static constexpr std::array<std::string_view, 2> issued{
        "http://opcfoundation.org/UA/UserToken#JWT", ""};
    UserTokenPolicy policy;
    policy.policy_id = one_of(ids, script);
    policy.token_type = static_cast<UserTokenType>(script.byte() % 5);
    policy.issued_token_type = one_of(issued, script);
    policy.security_policy_uri = policy_uri(script);
    return policy;
}

EndpointDescription endpoint(fuzz::Script& script)
{
    static constexpr std::array<std::string_view, 5> urls{
        reached_by, "opc.tcp://PLC:4841/path", "opc.tcp://elsewhere", "opc.tcp://plc:99999", ""};
    static constexpr std::array<std::string_view, 3> profiles{transport, transport, "https"};
    static constexpr std::array<std::string_view, 2> uris{"urn:server", "urn:other"};
    EndpointDescription endpoint;
    endpoint.endpoint_url = one_of(urls, script);
    endpoint.server.application_uri = one_of(uris, script);
    endpoint.security_mode = static_cast<MessageSecurityMode>(script.byte() % 5);
    endpoint.security_policy_uri = policy_uri(script);
    endpoint.security_level = script.byte();
    endpoint.transport_profile_uri = one_of(profiles, script);
    const std::size_t certificate = script.byte();
    endpoint.server_certificate = certificate < 0xc0 ? ByteString{test::fuzz_root().der()}
                                                     : ByteString{script.bytes(certificate % 16)};
    for (int i = script.byte() % 4; i != 0; --i) {
        endpoint.user_identity_tokens.push_back(token(script));
    }
    return endpoint;
}

/// An answer that is one, with endpoints as the script would have them.
std::vector<std::byte> made_answer(fuzz::Script& script)
{
    GetEndpointsResponse response;
    const bool are_many = script.byte() >= 0xf8;
    response.endpoints.resize(are_many ? max_endpoints - 1 : 0);
    for (int i = 0; i < 8 && !script.is_over(); ++i) {
        response.endpoints.push_back(endpoint(script));
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, response);
    return sink.take(writer.written());
}

client::SecurityWishes wishes_of(std::uint8_t choice)
{
    client::SecurityWishes wishes;
    wishes.allows_none = choice % 2 != 0;
    wishes.min_mode = static_cast<MessageSecurityMode>(1 + choice / 2 % 3);
    if ((choice & 0x10U) != 0) {
        wishes.policies = {"Aes128_Sha256_RsaOaep", "Basic256Sha256"};
    }
    return wishes;
}

client::UserIdentity identity_of(std::uint8_t choice)
{
    switch (choice >> 6U) {
    case 0:
        return client::AnonymousUser{};
    case 1:
        return client::NamedUser{"operator", "secret"};
    case 2:
        return client::CertificateUser{test::fuzz_root(), nullptr};
    default:
        return client::IssuedUser{"token"};
    }
}

/// That a password or token is encrypted by itself or by the channel (Part 4, 7.40.1), and a
/// certificate's proof made with a policy that has signatures.
void check_token(const client::EndpointChoice& choice, const client::UserIdentity& identity)
{
    const auto& tokens = choice.endpoint.user_identity_tokens;
    require(std::ranges::find(tokens, choice.token_policy) != tokens.end());
    if (std::holds_alternative<client::AnonymousUser>(identity)) {
        require(choice.token_policy.token_type == UserTokenType::Anonymous);
        return;
    }
    const auto uri = choice.token_policy.security_policy_uri.view();
    const auto* policy = uri.empty() ? choice.policy : crypto::find_policy(uri);
    require(policy != nullptr && (!policy->is_deprecated || policy == choice.policy));
    const bool is_hidden = choice.endpoint.security_mode == MessageSecurityMode::SignAndEncrypt &&
                           !std::holds_alternative<client::CertificateUser>(identity);
    require(!policy->is_none() || is_hidden);
}

/// Whether a TransportProfileUri may be that of UA TCP: also a missing one, that of version 1.00,
/// and one with a slash at its end.
bool is_tcp(std::string_view uri)
{
    uri.remove_suffix(uri.ends_with('/') ? 1 : 0);
    return uri.empty() || uri == transport ||
           uri == "http://opcfoundation.org/UA/profiles/transport/uatcp";
}

/// That `choice` is what was wished for, at the host that was asked.
void check_choice(const client::EndpointChoice& choice, const client::SecurityWishes& wishes)
{
    const EndpointDescription& endpoint = choice.endpoint;
    const bool is_left_out = endpoint.security_policy_uri.empty() && choice.policy->is_none();
    require(is_left_out ||
            choice.policy == crypto::find_policy(endpoint.security_policy_uri.view()));
    require(is_tcp(endpoint.transport_profile_uri.view()));
    const auto url = channel::EndpointUrl::parse(endpoint.endpoint_url.view());
    require(url && channel::is_same_host(url->host, "plc"));
    if (choice.policy->is_none()) {
        require(wishes.allows_none && endpoint.security_mode == MessageSecurityMode::None);
        return;
    }
    require(endpoint.security_mode >= wishes.min_mode &&
            endpoint.security_mode > MessageSecurityMode::None &&
            endpoint.security_mode <= MessageSecurityMode::SignAndEncrypt);
    require(crypto::parse_chain(endpoint.server_certificate.span()).has_value());
    const bool is_wanted =
        wishes.policies.empty()
            ? !choice.policy->is_deprecated
            : std::ranges::find(wishes.policies, choice.policy->name) != wishes.policies.end();
    require(is_wanted);
}

/// That the choice is the same in whatever order the endpoints come, and none the less for others
/// beside it: nobody who adds an endpoint makes a client take less than it was offered.
void check_best(const Array<EndpointDescription>& endpoints,
                const Result<client::EndpointChoice>& choice, const client::SecurityWishes& wishes,
                const client::UserIdentity& identity)
{
    NullLog log;
    Array<EndpointDescription> reversed{endpoints};
    std::ranges::reverse(reversed);
    const auto again = choose_endpoint(reversed, wishes, identity, reached_by, log);
    require(again.has_value() == choice.has_value());
    require(choice ? again->endpoint.security_mode == choice->endpoint.security_mode &&
                         again->policy == choice->policy &&
                         again->endpoint.security_level == choice->endpoint.security_level
                   : again.error() == choice.error());
    for (std::size_t i = 0; i < std::min(endpoints.size(), max_alone); ++i) {
        const auto alone = choose_endpoint({endpoints[i]}, wishes, identity, reached_by, log);
        require(!alone ||
                (choice && alone->endpoint.security_mode <= choice->endpoint.security_mode));
    }
}

void choose(const Array<EndpointDescription>& endpoints, std::uint8_t settings)
{
    const auto wishes = wishes_of(settings);
    const auto identity = identity_of(settings);
    CheckedLog log;
    const auto choice = choose_endpoint(endpoints, wishes, identity, reached_by, log);
    if (endpoints.size() > max_endpoints) {
        require(!choice && choice.error() == status::Bad_ResponseTooLarge);
        return;
    }
    require(log.warns == (choice && choice->policy->is_none()));
    if (choice) {
        check_choice(*choice, wishes);
        check_token(*choice, identity);
    }
    check_best(endpoints, choice, wishes, identity);
}

/// That a session's list passes in any order, but not without one of the endpoints (Part 4,
/// 5.7.2.2).
void compare(const Array<EndpointDescription>& endpoints)
{
    Array<EndpointDescription> others{endpoints};
    std::ranges::reverse(others);
    require(client::check_endpoints(endpoints, others).has_value());
    if (!others.empty()) {
        // One without a transport is compared where its URL is one of UA TCP, or is missing, too.
        const std::string_view url = others[0].endpoint_url.view();
        const std::string_view uri = others[0].transport_profile_uri.view();
        const bool is_compared =
            uri.empty() ? url.empty() || channel::EndpointUrl::parse(url) : is_tcp(uri);
        const Array<EndpointDescription> fewer{std::span{others}.subspan(1)};
        require(client::check_endpoints(endpoints, fewer).has_value() != is_compared);
    }
}

} // namespace

/// What a client makes of a hostile server's answers to the Discovery Service Set. The first byte
/// chooses the service and whether the rest is the answer or a script for one, the second what the
/// client wishes.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    const std::uint8_t kind = script.byte() % 4;
    const std::uint8_t settings = script.byte();
    if (kind == 2) {
        find(script.bytes(size));
        return 0;
    }
    if (kind == 3) {
        find_on_network(script.bytes(size));
        return 0;
    }
    const auto found = endpoints_in(kind == 0 ? std::span<const std::byte>{made_answer(script)}
                                              : script.bytes(size));
    if (found) {
        Array<EndpointDescription> endpoints;
        for (const EndpointDescription& endpoint : *found) {
            endpoints.push_back(endpoint);
        }
        choose(endpoints, settings);
        compare(endpoints);
    }
    return 0;
}

} // namespace discovery_fuzz
