#include <catch2/catch.hpp>

#include <busbar/client/endpoint_choice.hpp>

#include "crypto/status_text.hpp"
#include "support/identity.hpp"

namespace endpoint_choice_test {

using namespace busbar;
using namespace busbar::client;
using namespace busbar::test;

namespace {

constexpr std::string_view profile =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
constexpr auto none = MessageSecurityMode::None;
constexpr auto sign = MessageSecurityMode::Sign;
constexpr auto encrypt = MessageSecurityMode::SignAndEncrypt;

std::string_view uri(std::string_view name)
{
    const auto* policy = crypto::find_policy_by_name(name);
    return policy != nullptr ? policy->uri : name;
}

UserTokenPolicy token(UserTokenType type, std::string_view policy = {})
{
    UserTokenPolicy token;
    token.policy_id = String{std::to_string(static_cast<int>(type)) + std::string{policy}};
    token.token_type = type;
    token.security_policy_uri = policy.empty() ? String{} : String{uri(policy)};
    if (type == UserTokenType::IssuedToken) {
        token.issued_token_type = "http://opcfoundation.org/UA/UserToken#JWT";
    }
    return token;
}

EndpointDescription endpoint(std::string_view policy, MessageSecurityMode mode,
                             std::uint8_t level = 0,
                             Array<UserTokenPolicy> tokens = {token(UserTokenType::Anonymous),
                                                              token(UserTokenType::UserName)})
{
    EndpointDescription endpoint;
    endpoint.endpoint_url = "opc.tcp://plc:4840/server";
    endpoint.server.application_uri = "urn:busbar:test:server";
    endpoint.server_certificate = ByteString{server_identity().certificates.front().der()};
    endpoint.security_policy_uri = uri(policy);
    endpoint.security_mode = mode;
    endpoint.security_level = level;
    endpoint.transport_profile_uri = profile;
    endpoint.user_identity_tokens = std::move(tokens);
    return endpoint;
}

const UserIdentity nobody{AnonymousUser{}};
const UserIdentity somebody{NamedUser{"a", "b"}};

Result<EndpointChoice> choose(const Array<EndpointDescription>& endpoints,
                              const SecurityWishes& wishes = {},
                              const UserIdentity& identity = nobody)
{
    NullLog log;
    return choose_endpoint(endpoints, wishes, identity, "opc.tcp://plc:4840", log);
}

struct Row {
    const char* what;
    Array<EndpointDescription> offered;
    SecurityWishes wishes;
    UserIdentity identity;
    /// Which of them, or why none.
    Result<std::size_t> expected;
};

const SecurityWishes any{{}, sign, true};
const SecurityWishes signed_too{{}, sign, false};
const SecurityWishes two_policies{{"Basic256Sha256", "Aes256_Sha256_RsaPss"}, encrypt, false};

Result<std::size_t> no(StatusCode status)
{
    return fail(status);
}

/// Which of several is the best.
std::vector<Row> ranked()
{
    auto no_certificate = endpoint("Aes256_Sha256_RsaPss", encrypt);
    no_certificate.server_certificate = ByteString{std::vector<std::byte>(20)};
    return {
        {"mode before policy",
         {endpoint("Aes256_Sha256_RsaPss", sign, 9), endpoint("Basic256Sha256", encrypt)},
         any,
         nobody,
         1},
        {"policy before level",
         {endpoint("Basic256Sha256", encrypt, 9), endpoint("Aes256_Sha256_RsaPss", encrypt, 1)},
         any,
         nobody,
         1},
        {"level at last",
         {endpoint("Basic256Sha256", encrypt, 1), endpoint("Basic256Sha256", encrypt, 2),
          endpoint("Basic256Sha256", encrypt, 1)},
         any,
         nobody,
         1},
        {"wishes rank policies",
         {endpoint("Aes256_Sha256_RsaPss", encrypt), endpoint("Basic256Sha256", encrypt)},
         two_policies,
         nobody,
         1},
        {"anything before None",
         {endpoint("None", none, 255), endpoint("Basic256Sha256", sign)},
         any,
         nobody,
         1},
        {"None if that is all, and allowed", {endpoint("None", none)}, any, nobody, 0},
        {"Sign if allowed", {endpoint("Basic256Sha256", sign)}, signed_too, nobody, 0},
        {"a certificate that is none",
         {no_certificate, endpoint("Basic256Sha256", encrypt)},
         any,
         nobody,
         1},
    };
}

/// What devices leave out or spell as version 1.00 did.
std::vector<Row> sloppy()
{
    const auto with_profile = [](std::string_view profile_uri) {
        auto changed = endpoint("Basic256Sha256", encrypt);
        changed.transport_profile_uri = String{profile_uri};
        return changed;
    };
    auto null_profile = with_profile("");
    null_profile.transport_profile_uri = String{};
    auto other_scheme = with_profile("");
    other_scheme.endpoint_url = "opc.https://plc:443";
    auto no_policy = endpoint("None", none);
    no_policy.security_policy_uri = String{};
    auto empty_policy = endpoint("None", none);
    empty_policy.security_policy_uri = "";
    auto no_policy_but_mode = no_policy;
    no_policy_but_mode.security_mode = sign;
    const auto odd_token = [](std::string_view policy_uri) {
        auto with_token = token(UserTokenType::Anonymous);
        with_token.security_policy_uri = String{policy_uri};
        return endpoint("Basic256Sha256", encrypt, 0, {with_token});
    };
    const auto policy = no(status::Bad_SecurityPolicyRejected);
    return {
        {"an empty transport", {with_profile("")}, any, nobody, 0},
        {"no transport", {null_profile}, any, nobody, 0},
        {"no transport, and the scheme of another", {other_scheme}, any, nobody, policy},
        {"a slash at its end", {with_profile(std::string{profile} + "/")}, any, nobody, 0},
        {"that of version 1.00",
         {with_profile("http://opcfoundation.org/UA/profiles/transport/uatcp")},
         any,
         nobody,
         0},
        {"no policy, and mode None", {no_policy}, any, nobody, 0},
        {"an empty policy, and mode None", {empty_policy}, any, nobody, 0},
        {"no policy, and mode None, which is not wanted", {no_policy}, {}, nobody, policy},
        {"no policy, and another mode", {no_policy_but_mode}, any, nobody, policy},
        {"an anonymous token with an old policy",
         {odd_token("http://opcfoundation.org/UA/SecurityPolicy#Basic256")},
         any,
         nobody,
         0},
        {"an anonymous token with any text", {odd_token("x")}, any, nobody, 0},
    };
}

/// What is not fallen back to.
std::vector<Row> refused()
{
    auto other_transport = endpoint("Basic256Sha256", encrypt);
    other_transport.transport_profile_uri =
        "http://opcfoundation.org/UA-Profile/Transport/https-uabinary";
    const auto policy = no(status::Bad_SecurityPolicyRejected);
    return {
        {"None", {endpoint("None", none)}, signed_too, nobody, policy},
        {"Sign",
         {endpoint("Basic256Sha256", sign)},
         {},
         nobody,
         no(status::Bad_SecurityModeRejected)},
        {"a policy that is not wanted",
         {endpoint("Aes128_Sha256_RsaOaep", encrypt)},
         two_policies,
         nobody,
         policy},
        {"a policy that nobody knows",
         {endpoint("http://example/policy", encrypt)},
         any,
         nobody,
         policy},
        {"a deprecated policy that nobody named",
         {endpoint("Basic128Rsa15", encrypt)},
         signed_too,
         nobody,
         policy},
        {"a wish that means nothing",
         {endpoint("Basic256Sha256", encrypt)},
         {{"Basic256Sha265"}, encrypt, false},
         nobody,
         no(status::Bad_ConfigurationError)},
        {"mode None with a policy", {endpoint("Basic256Sha256", none)}, any, nobody, policy},
        {"policy None with a mode", {endpoint("None", encrypt)}, any, nobody, policy},
        {"no mode at all",
         {endpoint("Basic256Sha256", MessageSecurityMode::Invalid)},
         any,
         nobody,
         policy},
        {"a mode that does not exist",
         {endpoint("Basic256Sha256", static_cast<MessageSecurityMode>(7))},
         any,
         nobody,
         policy},
        {"another transport", {other_transport}, any, nobody, policy},
        {"nothing", {}, any, nobody, policy},
    };
}

/// What can be used for a user.
std::vector<Row> with_tokens()
{
    const auto name_only = [](std::string_view policy) {
        return Array<UserTokenPolicy>{token(UserTokenType::UserName, policy)};
    };
    const auto refusal = no(status::Bad_IdentityTokenRejected);
    return {
        {"None is not fallen back to because of the user",
         {endpoint("Basic256Sha256", encrypt, 0, name_only({})), endpoint("None", none)},
         {},
         nobody,
         refusal},
        {"no token for a user",
         {endpoint("Basic256Sha256", encrypt, 0, {})},
         any,
         somebody,
         refusal},
        {"a password is not sent in the clear over None",
         {endpoint("None", none, 0, name_only({}))},
         any,
         somebody,
         refusal},
        {"nor over a channel that only signs",
         {endpoint("Basic256Sha256", sign, 0, name_only("None"))},
         any,
         somebody,
         refusal},
        {"an encrypting channel hides it",
         {endpoint("Basic256Sha256", encrypt, 0, name_only("None"))},
         any,
         somebody,
         0},
        {"or its own policy",
         {endpoint("None", none, 0, name_only("Basic256Sha256"))},
         any,
         somebody,
         0},
        {"but no deprecated or unknown one",
         {endpoint("None", none, 0, name_only("Basic128Rsa15"))},
         any,
         somebody,
         refusal},
    };
}

void check(const Row& row)
{
    CAPTURE(row.what);
    LogBook log;
    const auto choice =
        choose_endpoint(row.offered, row.wishes, row.identity, "opc.tcp://plc:4840", log);
    REQUIRE(choice.has_value() == row.expected.has_value());
    if (choice) {
        CHECK(choice->endpoint == row.offered[*row.expected]);
        const std::string_view uri = choice->endpoint.security_policy_uri.view();
        CHECK((choice->policy->uri == uri || (uri.empty() && choice->policy->is_none())));
        CHECK(log.text.empty() != choice->policy->is_none());
    } else {
        CHECK(choice.error() == row.expected.error());
        CHECK_FALSE(log.text.empty());
    }
}

} // namespace

TEST_CASE("the best endpoint that both sides allow is chosen, or none")
{
    for (const auto& rows : {ranked(), sloppy(), refused(), with_tokens()}) {
        for (const Row& row : rows) {
            check(row);
        }
    }
}

TEST_CASE("a refusal says what was offered and what was wanted")
{
    LogBook log;
    CHECK_FALSE(choose_endpoint({endpoint("None", none), endpoint("Basic256Sha256", sign)},
                                {{"Aes256_Sha256_RsaPss"}, encrypt, false}, somebody,
                                "opc.tcp://plc", log));
    CHECK(log.text.find("None/None (anonymous, user name); Basic256Sha256/Sign") !=
          std::string::npos);
    CHECK(log.text.find("Aes256_Sha256_RsaPss with at least SignAndEncrypt, for user name") !=
          std::string::npos);
}

TEST_CASE("of several token policies the one that protects best is taken")
{
    const Array<UserTokenPolicy> tokens{token(UserTokenType::UserName, "None"),
                                        token(UserTokenType::UserName, "Basic256Sha256"),
                                        token(UserTokenType::UserName, "Aes256_Sha256_RsaPss"),
                                        token(UserTokenType::UserName, "Aes128_Sha256_RsaOaep")};
    const auto choice = choose({endpoint("Basic256Sha256", encrypt, 0, tokens)}, {}, somebody);
    REQUIRE(choice);
    CHECK(choice->token_policy == tokens[2]);
}

TEST_CASE("an issued token needs a policy of its type")
{
    const auto tokens = Array<UserTokenPolicy>{token(UserTokenType::IssuedToken)};
    const Array<EndpointDescription> offered{endpoint("Basic256Sha256", encrypt, 0, tokens)};
    CHECK(choose(offered, {}, IssuedUser{"x"}));
    CHECK(choose(offered, {}, IssuedUser{"x", "urn:kerberos"}).error() ==
          status::Bad_IdentityTokenRejected);
}

TEST_CASE("the URL is one that leads to the server")
{
    const auto [named, reached_by, expected] =
        GENERATE(table<std::string_view, std::string_view, std::string_view>({
            {"opc.tcp://plc:4840/a", "opc.tcp://plc:4840", "opc.tcp://plc:4840/a"},
            {"opc.tcp://PLC:4841/a", "opc.tcp://plc:4840", "opc.tcp://PLC:4841/a"},
            {"opc.tcp://internal:4840/a", "opc.tcp://10.0.0.1:5000", "opc.tcp://10.0.0.1:5000"},
            {"opc.tcp://evil.example", "opc.tcp://plc:4840/b", "opc.tcp://plc:4840/b"},
            {"https://plc", "opc.tcp://plc:4840", "opc.tcp://plc:4840"},
            {"", "opc.tcp://plc:4840", "opc.tcp://plc:4840"},
        }));
    auto offered = endpoint("Basic256Sha256", encrypt);
    offered.endpoint_url = named;
    NullLog log;
    const auto choice = choose_endpoint({offered}, {}, nobody, reached_by, log);
    REQUIRE(choice);
    CHECK(choice->endpoint.endpoint_url.view() == expected);
}

TEST_CASE("CreateSession has to repeat the endpoints of GetEndpoints")
{
    using Endpoints = Array<EndpointDescription>;
    const Endpoints discovered{endpoint("Basic256Sha256", sign, 1),
                               endpoint("Basic256Sha256", encrypt, 2)};
    const auto expect = [&](bool is_same, const char* what, auto change) {
        CAPTURE(what);
        Endpoints again = discovered;
        change(again);
        const auto checked = check_endpoints(discovered, again);
        CHECK((checked ? StatusCode{} : checked.error()) ==
              (is_same ? StatusCode{} : StatusCode{status::Bad_SecurityChecksFailed}));
    };
    expect(true, "as they were", [](Endpoints&) {});
    expect(true, "another order", [](Endpoints& all) { std::swap(all[0], all[1]); });
    expect(true, "no certificate", [](Endpoints& all) { all[0].server_certificate = {}; });
    expect(true, "another URL", [](Endpoints& all) { all[0].endpoint_url = "opc.tcp://other"; });
    expect(true, "another name",
           [](Endpoints& all) { all[0].server.application_name = LocalizedText{"other"}; });
    expect(true, "one more of another transport", [](Endpoints& all) {
        all.push_back(endpoint("Basic256Sha256", encrypt, 7));
        all[2].transport_profile_uri = "urn:other";
    });
    expect(false, "one less", [](Endpoints& all) { all.pop_back(); });
    expect(false, "one twice", [](Endpoints& all) { all.push_back(EndpointDescription{all[0]}); });
    expect(false, "another mode", [](Endpoints& all) { all[0].security_mode = encrypt; });
    expect(false, "another policy",
           [](Endpoints& all) { all[0].security_policy_uri = uri("Aes256_Sha256_RsaPss"); });
    expect(false, "another level", [](Endpoints& all) { all[0].security_level = 3; });
    expect(false, "another application",
           [](Endpoints& all) { all[0].server.application_uri = "urn:other"; });
    expect(false, "another token policy", [](Endpoints& all) {
        all[1].user_identity_tokens[1].security_policy_uri = uri("None");
    });
    expect(false, "a token policy less",
           [](Endpoints& all) { all[1].user_identity_tokens.pop_back(); });
    expect(false, "none", [](Endpoints& all) { all = {}; });
}

} // namespace endpoint_choice_test
