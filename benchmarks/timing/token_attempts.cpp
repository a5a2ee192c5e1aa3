#include "experiment.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>

#include <busbar/types/session.hpp>

#include "attempts.hpp"
#include "server/users/user_policies.hpp"
#include "server/users/user_token.hpp"

namespace busbar::timing {

namespace {

constexpr std::string_view right_password = "the right password";

/// Knows one user, whose password it compares as it is.
class OneUser final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view name,
                                                      std::string_view password) override
    {
        if (name != "operator" || password != right_password) {
            return fail(status::Bad_UserAccessDenied);
        }
        return server::UserIdentity{UserTokenType::UserName, std::string{name}};
    }
};

server::ServerConfig make_config()
{
    server::ServerConfig config;
    config.identity = make_identity("server");
    return config;
}

const server::ServerConfig& config()
{
    static const server::ServerConfig instance = make_config();
    return instance;
}

enum class TokenFault {
    None,
    RsaPadding,
    OtherPadding,
    Length,
    TooLong,
    Nonce,
    Password,
    Empty,
};

/// Length, password and nonce (Part 4, 7.40.2.2).
Bytes secret_text(TokenFault fault, const Bytes& nonce)
{
    std::string password{right_password};
    if (fault == TokenFault::Password) {
        password.back() = 'D';
    } else if (fault == TokenFault::Empty) {
        password.clear();
    }
    std::size_t length = password.size() + nonce.size();
    length += fault == TokenFault::Length ? 1 : fault == TokenFault::TooLong ? 100'000 : 0;
    const Bytes other = random_bytes(nonce.size());
    const Bytes& used = fault == TokenFault::Nonce ? other : nonce;
    Bytes text(sizeof(std::uint32_t) + password.size() + used.size());
    auto out = text.begin();
    for (unsigned shift = 0; shift < 32; shift += 8) {
        *out++ = static_cast<std::byte>(length >> shift);
    }
    out = std::ranges::copy(std::as_bytes(std::span{password}), out).out;
    std::ranges::copy(used, out);
    return text;
}

ExtensionObject token_of(const crypto::SecurityPolicy& policy,
                         const server::EndpointConfig& endpoint, TokenFault fault,
                         const Bytes& nonce)
{
    const auto& sent = fault == TokenFault::OtherPadding ? with_other_padding(policy) : policy;
    Bytes cipher = crypto::asymmetric_encrypt(sent, config().identity->certificates.front(),
                                              secret_text(fault, nonce))
                       .value();
    if (fault == TokenFault::RsaPadding) {
        spoil_block(cipher, 0);
    }
    UserNameIdentityToken token;
    token.policy_id = server::detail::policy_id(endpoint, UserTokenType::UserName);
    token.user_name = "operator";
    token.encryption_algorithm = String{policy.encryption_uri};
    token.password = ByteString{cipher};
    return ExtensionObject::from(std::move(token));
}

Attempt prepare_token(const crypto::SecurityPolicy& policy, TokenFault fault)
{
    struct Case {
        server::EndpointConfig endpoint;
        OneUser users;
        Bytes nonce;
        ExtensionObject token;
    };
    auto one = std::make_shared<Case>();
    one->endpoint.security = {&policy, MessageSecurityMode::SignAndEncrypt};
    one->nonce = random_bytes(32);
    one->token = token_of(policy, one->endpoint, fault, one->nonce);
    return [one, fault] {
        const auto login = server::detail::log_in(
            {config(), one->endpoint, &one->users, one->nonce, now}, one->token, {});
        const bool is_as_expected = login ? fault == TokenFault::None
                                          : login.error().answer == status::Bad_UserAccessDenied;
        if (!is_as_expected) {
            std::fprintf(stderr, "busbar-timing: a token did not end as it should\n");
            std::abort();
        }
    };
}

} // namespace

std::vector<InputClass> token_attempts(const crypto::SecurityPolicy& policy)
{
    const auto input = [&policy](const char* name, TokenFault fault) {
        return InputClass{name, [&policy, fault] { return prepare_token(policy, fault); }};
    };
    return {input("wrong RSA padding", TokenFault::RsaPadding),
            input("padding of another OAEP hash", TokenFault::OtherPadding),
            input("wrong length", TokenFault::Length),
            input("length beyond the text", TokenFault::TooLong),
            input("wrong nonce", TokenFault::Nonce),
            input("wrong password", TokenFault::Password),
            input("empty password", TokenFault::Empty)};
}

} // namespace busbar::timing
