#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/jwt.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/session.hpp>

#include "crypto/secret_maker.hpp"
#include "fuzz_script.hpp"
#include "server/users/token_checks.hpp"
#include "server/users/user_policies.hpp"
#include "server/users/user_token.hpp"
#include "support/identity.hpp"

namespace user_token_fuzz {

using namespace busbar;

namespace {

/// Lets nobody in; takes tokens of every kind.
class Users final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        ++asked;
        return fail(status::Bad_UserAccessDenied);
    }
    [[nodiscard]] crypto::CertificateValidator* certificate_validator() override
    {
        return &validator_;
    }
    [[nodiscard]] const crypto::JwtRules* token_rules() const override { return &rules_; }

    int asked{0};

private:
    crypto::InsecureAcceptAnyCertificate validator_;
    crypto::JwtRules rules_;
};

/// An endpoint for every kind of user; passwords are encrypted, or at the second not.
server::ServerConfig make_config()
{
    server::ServerConfig config;
    config.identity = test::server_identity();
    config.endpoints.resize(2);
    for (auto& endpoint : config.endpoints) {
        endpoint.security = {&crypto::policy_none(), MessageSecurityMode::None};
        endpoint.allows_certificate = true;
        endpoint.certificate_policy = crypto::find_policy_by_name("Basic256Sha256");
        endpoint.allows_issued = true;
    }
    config.endpoints[1].password_policy = &crypto::policy_none();
    return config;
}

struct Fixture {
    server::ServerConfig config{make_config()};
    std::vector<std::byte> nonce = std::vector<std::byte>(32, std::byte{7});
    Users users;

    /// True if somebody is let in.
    bool log_in(const server::EndpointConfig& endpoint, const ExtensionObject& token,
                const SignatureData& signature)
    {
        const server::detail::LoginContext context{
            config, endpoint, &users, nonce, test::today, server::detail::log_in_issued};
        return server::detail::log_in(context, token, signature).has_value();
    }
};

/// The plain text as the payload of an RsaEncryptedSecret, which has whole blocks.
ByteString sealed(const Fixture& fixture, const crypto::SecurityPolicy& policy,
                  std::span<const std::byte> plain)
{
    const auto& certificate = fixture.config.identity->certificates.front();
    crypto::Bytes payload{plain.begin(), plain.end()};
    payload.resize((plain.size() / policy.block_size + 1) * policy.block_size);
    const auto secret = test::make_secret(
        policy, certificate, test::secret_parts(policy, certificate, std::move(payload)));
    return secret ? ByteString{*secret} : ByteString{};
}

/// What a client may have encrypted, so that what is behind the decryption is reached.
ExtensionObject encrypted(const Fixture& fixture, std::span<const std::byte> plain, bool is_legacy)
{
    const auto& endpoint = fixture.config.endpoints[0];
    const auto& policy = server::detail::password_policy(endpoint);
    UserNameIdentityToken token;
    token.policy_id = server::detail::policy_id(endpoint, UserTokenType::UserName);
    token.user_name = "operator";
    token.encryption_algorithm = policy.encryption_uri;
    if (!is_legacy) {
        token.password = sealed(fixture, policy, plain);
        return ExtensionObject::from(token);
    }
    if (const auto cipher = crypto::asymmetric_encrypt(
            policy, fixture.config.identity->certificates.front(), plain)) {
        token.password = ByteString{*cipher};
    }
    return ExtensionObject::from(token);
}

} // namespace

/// Any userIdentityToken and userTokenSignature, and any plain text of an encrypted password in
/// either format. No token of these users is right.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static Fixture fixture;
    fuzz::Script script{{data, size}};
    const std::uint8_t choice = script.byte();
    if (choice % 4 == 0) {
        fixture.users.asked = 0;
        const auto token = encrypted(fixture, script.bytes(size), choice % 8 == 0);
        if (fixture.log_in(fixture.config.endpoints[0], token, {}) || fixture.users.asked != 1) {
            std::abort(); // every secret costs a password check
        }
        return 0;
    }
    static const binary::TypeRegistry types{binary::namespace0_types()};
    binary::Reader reader{script.bytes(size), binary::Strings::Borrow, &types};
    ExtensionObject token;
    SignatureData signature;
    decode(reader, token);
    decode(reader, signature);
    if (fixture.log_in(fixture.config.endpoints[choice % 2], token, signature)) {
        std::abort();
    }
    return 0;
}

} // namespace user_token_fuzz
