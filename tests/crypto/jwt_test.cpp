#include <catch2/catch.hpp>

#include <openssl/ec.h>
#include <openssl/pem.h>

#include "issuing.hpp"
#include "jwt_maker.hpp"

namespace jwt_test {

using namespace busbar;
using namespace busbar::test;
using crypto::JwtAlgorithm;
using crypto::JwtKey;
using namespace std::chrono_literals;

namespace {

constexpr std::string_view server_uri = "urn:test:server";
constexpr std::string_view rs256 = R"({"alg":"RS256","typ":"JWT","kid":"one"})";
constexpr std::string_view secret = "0123456789abcdef0123456789abcdef";

std::string seconds(std::chrono::seconds from_now)
{
    return std::to_string(now.unix_seconds() + from_now.count());
}

/// What every token has: `more` goes behind it.
std::string claims(const std::string& more = {})
{
    return R"({"sub":"maria","iss":"https://issuer","aud":"urn:test:server","exp":)" + seconds(1h) +
           more + "}";
}

const Issued& issuer()
{
    static const Issued issued = issue({}, key_number(1));
    return issued;
}

crypto::JwtRules rules()
{
    crypto::JwtRules made;
    made.keys.push_back(
        JwtKey::from_certificate(JwtAlgorithm::RS256, issuer().certificate, "one").value());
    made.issuer = "https://issuer";
    return made;
}

StatusCode status_of(const std::string& token, const crypto::JwtRules& with = rules())
{
    const auto verified = crypto::verify_jwt(token, with, server_uri, now);
    return verified ? StatusCode{} : verified.error().status;
}

StatusCode status_of_claims(const std::string& json)
{
    return status_of(rsa_token(rs256, json, issuer().key));
}

using PkeyPointer = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

std::vector<std::byte> public_pem(EVP_PKEY* key)
{
    const std::unique_ptr<BIO, decltype(&BIO_free_all)> bio{BIO_new(BIO_s_mem()), BIO_free_all};
    PEM_write_bio_PUBKEY(bio.get(), key);
    char* data = nullptr;
    const auto size = static_cast<std::size_t>(BIO_get_mem_data(bio.get(), &data));
    const auto bytes = std::as_bytes(std::span{data, size});
    return {bytes.begin(), bytes.end()};
}

/// r and s, 32 bytes each (RFC 7518, 3.4).
std::string ecdsa_token(std::string_view header, std::string_view json, EVP_PKEY* key)
{
    const std::string text = base64url(header) + "." + base64url(json);
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(),
                                                                          EVP_MD_CTX_free};
    EVP_DigestSignInit(context.get(), nullptr, EVP_sha256(), nullptr, key);
    unsigned char der[128];
    std::size_t size = sizeof der;
    EVP_DigestSign(context.get(), der, &size, reinterpret_cast<const unsigned char*>(text.data()),
                   text.size());
    const unsigned char* at = der;
    ECDSA_SIG* numbers = d2i_ECDSA_SIG(nullptr, &at, static_cast<long>(size));
    unsigned char raw[64];
    BN_bn2binpad(ECDSA_SIG_get0_r(numbers), raw, 32);
    BN_bn2binpad(ECDSA_SIG_get0_s(numbers), raw + 32, 32);
    ECDSA_SIG_free(numbers);
    return text + "." + base64url(std::as_bytes(std::span{raw}));
}

} // namespace

TEST_CASE("a token of a configured issuer is verified, and its claims are passed on")
{
    const auto verified = crypto::verify_jwt(
        rsa_token(rs256,
                  claims(R"(,"name":"Mar\u00eda \ud83d\ude00","roles":["Operator","x"],)"
                         R"("iat":1767225000.5,"more":{"a":[1,[true,null]]})"),
                  issuer().key),
        rules(), server_uri, now);
    REQUIRE(verified);
    CHECK(verified->subject == "maria");
    CHECK(verified->issuer == "https://issuer");
    CHECK(verified->name == "Mar\xC3\xAD"
                            "a \xF0\x9F\x98\x80");
    CHECK(verified->roles == std::vector<std::string>{"Operator", "x"});
    CHECK(verified->issued_at == DateTime::from_unix_seconds(1'767'225'000));
    CHECK(verified->expires.ticks == now.ticks + 3'600 * DateTime::ticks_per_second);
}

TEST_CASE("every algorithm verifies its own signatures and no other")
{
    auto with = rules();
    with.keys.clear();
    SECTION("PS256")
    {
        with.keys.push_back(
            JwtKey::from_certificate(JwtAlgorithm::PS256, issuer().certificate).value());
        CHECK(status_of(
                  rsa_token(R"({"alg":"PS256"})", claims(), issuer().key, "Aes256_Sha256_RsaPss"),
                  with) == status::Good);
        CHECK(status_of(rsa_token(R"({"alg":"PS256"})", claims(), issuer().key), with) ==
              status::Bad_IdentityTokenRejected);
    }
    SECTION("ES256")
    {
        const PkeyPointer key{EVP_EC_gen("P-256"), EVP_PKEY_free};
        const PkeyPointer other{EVP_EC_gen("P-256"), EVP_PKEY_free};
        with.keys.push_back(
            JwtKey::from_public_key(JwtAlgorithm::ES256, public_pem(key.get())).value());
        const std::string header = R"({"alg":"ES256"})";
        CHECK(status_of(ecdsa_token(header, claims(), key.get()), with) == status::Good);
        CHECK(status_of(ecdsa_token(header, claims(), other.get()), with) ==
              status::Bad_IdentityTokenRejected);
        CHECK(status_of(ecdsa_token(header, claims(), key.get()) + "AA", with) ==
              status::Bad_IdentityTokenRejected);
    }
    SECTION("HS256")
    {
        with.keys.push_back(JwtKey::from_shared_secret(std::as_bytes(std::span{secret})).value());
        const std::string header = R"({"alg":"HS256"})";
        CHECK(status_of(hmac_token(header, claims(), secret), with) == status::Good);
        CHECK(status_of(hmac_token(header, claims(), "another secret"), with) ==
              status::Bad_IdentityTokenRejected);
    }
}

TEST_CASE("a key is for one algorithm, and has to be strong enough for it")
{
    const auto bytes = std::as_bytes(std::span{secret});
    CHECK(JwtKey::from_shared_secret(bytes.first(31)).error() == status::Bad_ConfigurationError);
    CHECK_FALSE(JwtKey::from_public_key(JwtAlgorithm::RS256, bytes));
    CHECK_FALSE(JwtKey::from_certificate(JwtAlgorithm::ES256, issuer().certificate));
    CHECK_FALSE(JwtKey::from_certificate(JwtAlgorithm::HS256, issuer().certificate));
    const PkeyPointer small{EVP_RSA_gen(1024), EVP_PKEY_free};
    CHECK_FALSE(JwtKey::from_public_key(JwtAlgorithm::RS256, public_pem(small.get())));
    const PkeyPointer p384{EVP_EC_gen("P-384"), EVP_PKEY_free};
    CHECK_FALSE(JwtKey::from_public_key(JwtAlgorithm::ES256, public_pem(p384.get())));
}

TEST_CASE("the token does not choose its algorithm")
{
    SECTION("none")
    {
        const auto* alg = GENERATE("none", "None", "NONE", "");
        const std::string header = std::string{R"({"alg":")"} + alg + "\"}";
        CHECK(status_of(base64url(header) + "." + base64url(claims()) + ".") ==
              status::Bad_IdentityTokenRejected);
    }
    SECTION("no algorithm at all")
    {
        CHECK(status_of(rsa_token("{}", claims(), issuer().key)) ==
              status::Bad_IdentityTokenRejected);
    }
    SECTION("the public key as the secret of HS256")
    {
        const auto pem = public_pem(X509_get0_pubkey(issuer().certificate.native()));
        const std::string_view key{reinterpret_cast<const char*>(pem.data()), pem.size()};
        CHECK(status_of(hmac_token(R"({"alg":"HS256","kid":"one"})", claims(), key)) ==
              status::Bad_IdentityTokenRejected);
    }
    SECTION("a key that it brings along")
    {
        const auto& stranger = key_number(2);
        CHECK(status_of(rsa_token(R"({"alg":"RS256","jwk":{"kty":"RSA"},"x5c":["MA=="]})", claims(),
                                  stranger)) == status::Bad_IdentityTokenRejected);
    }
    SECTION("another key id")
    {
        CHECK(status_of(rsa_token(R"({"alg":"RS256","kid":"two"})", claims(), issuer().key)) ==
              status::Bad_IdentityTokenRejected);
    }
}

TEST_CASE("changed tokens are refused")
{
    const std::string token = rsa_token(rs256, claims(), issuer().key);
    REQUIRE(status_of(token) == status::Good);
    for (std::size_t i = 0; i < token.size(); i += 7) {
        std::string changed = token;
        changed[i] = changed[i] == 'A' ? 'B' : 'A';
        CAPTURE(i);
        CHECK(status_of(changed).is_bad());
    }
    for (std::size_t size = 0; size < token.size(); size += 13) {
        CHECK(status_of(token.substr(0, size)).is_bad());
    }
}

TEST_CASE("what is no token in compact form is invalid")
{
    const std::string token = rsa_token(rs256, claims(), issuer().key);
    const auto wrong = GENERATE_COPY(
        std::string{}, std::string{"."}, std::string{".."}, std::string{"a.b.c.d.e"},
        std::string{"a.b"}, "!" + token, token + "=", token + "\n", "Bearer " + token,
        rsa_token("[]", claims(), issuer().key), rsa_token(rs256, "[]", issuer().key),
        rsa_token(R"({"alg":"RS256","crit":["b64"],"b64":false})", claims(), issuer().key),
        rsa_token(R"({"alg":"RS256","typ":"logout+jwt"})", claims(), issuer().key),
        std::string(100'000, 'A'), std::string(8'190, 'A') + "..A");
    CAPTURE(wrong.substr(0, 60));
    CHECK(status_of(wrong) == status::Bad_IdentityTokenInvalid);
}

TEST_CASE("a token counts in its time only")
{
    const auto with_times = [](const std::string& times) {
        return R"({"sub":"maria","iss":"https://issuer","aud":"urn:test:server")" + times + "}";
    };
    const auto exp = [&](std::chrono::seconds t) { return ",\"exp\":" + seconds(t); };
    CHECK(status_of_claims(with_times(exp(-59s))) == status::Good); // within the clock skew
    CHECK(status_of_claims(with_times(exp(24h))) == status::Good);
    CHECK(status_of_claims(with_times(exp(24h) + ".9")) == status::Good);
    CHECK(status_of_claims(with_times(exp(1h) + ",\"nbf\":" + seconds(60s))) == status::Good);
    for (const std::string& wrong :
         {exp(-60s), exp(24h + 1s), std::string{}, std::string{R"(,"exp":"soon")"},
          std::string{R"(,"exp":-5)"}, std::string{R"(,"exp":1e300)"},
          std::string{R"(,"exp":1e999)"}, std::string{R"(,"exp":99999999999999999999)"},
          exp(1h) + ",\"nbf\":" + seconds(61s), exp(1h) + ",\"iat\":" + seconds(61s),
          exp(1h) + R"(,"nbf":"now")"}) {
        CAPTURE(wrong);
        CHECK(status_of_claims(with_times(wrong)) == status::Bad_IdentityTokenRejected);
    }
}

TEST_CASE("a token counts for its subject, issuer and audience only")
{
    const std::string exp = ",\"exp\":" + seconds(1h) + "}";
    const auto rejected = [&](const std::string& json) {
        CAPTURE(json);
        CHECK(status_of_claims(json + exp) == status::Bad_IdentityTokenRejected);
    };
    rejected(R"({"iss":"https://issuer","aud":"urn:test:server")");
    rejected(R"({"sub":"","iss":"https://issuer","aud":"urn:test:server")");
    rejected(R"({"sub":7,"iss":"https://issuer","aud":"urn:test:server")");
    rejected(R"({"sub":"maria","aud":"urn:test:server")");
    rejected(R"({"sub":"maria","iss":"https://issuer/","aud":"urn:test:server")");
    rejected(R"({"sub":"maria","iss":"https://issuer")");
    rejected(R"({"sub":"maria","iss":"https://issuer","aud":"urn:test:server2")");
    rejected(R"({"sub":"maria","iss":"https://issuer","aud":["urn:test:server2"])");
    rejected(R"({"sub":"maria","iss":"https://issuer","aud":["urn:test:server",1])");
    CHECK(status_of_claims(
              R"({"sub":"maria","iss":"https://issuer","aud":["a","urn:test:server"])" + exp) ==
          status::Good);

    auto with = rules();
    with.audience = "https://plant/line3";
    const std::string other =
        R"({"sub":"maria","iss":"https://issuer","aud":"https://plant/line3")" + exp;
    CHECK(status_of(rsa_token(rs256, other, issuer().key), with) == status::Good);
    CHECK(status_of(rsa_token(rs256, claims(), issuer().key), with) ==
          status::Bad_IdentityTokenRejected);
    with = rules();
    with.issuer = {};
    CHECK(status_of(rsa_token(rs256, claims(), issuer().key), with) ==
          status::Bad_IdentityTokenRejected);
}

TEST_CASE("a refused token is explained without showing it")
{
    const std::string token =
        rsa_token(rs256, claims(R"(,"nbf":9999999999,"code":"\u001b[2J")"), issuer().key);
    const auto verified = crypto::verify_jwt(token, rules(), server_uri, now);
    REQUIRE_FALSE(verified);
    const std::string line = text(verified.error());
    CHECK(line.find("it is not valid before 2286-11-20") != std::string::npos);
    CHECK(line.find(token.substr(0, 20)) == std::string::npos);
    CHECK(line.find('\x1b') == std::string::npos);
}

TEST_CASE("claims that are read in two ways, or are too many, are malformed")
{
    const auto with = [](const std::string& more) { return status_of_claims(claims("," + more)); };
    CHECK(with(R"("a":[[[[[[[]]]]]]])") == status::Good);
    CHECK(with(R"("a":[[[[[[[[]]]]]]]])") == status::Bad_IdentityTokenInvalid);
    CHECK(with(R"("sub":"root")") == status::Bad_IdentityTokenInvalid);
    CHECK(with(R"("a":1,"\u0061":2)") == status::Bad_IdentityTokenInvalid);
    CHECK(with(R"("a":"\u0000")") == status::Bad_IdentityTokenInvalid);
    CHECK(with(R"("a":01)") == status::Bad_IdentityTokenInvalid);
    CHECK(status_of_claims("[]") == status::Bad_IdentityTokenInvalid);

    std::string members = "\"0\":0";
    for (int i = 1; i < 65; ++i) {
        members += ",\"" + std::to_string(i) + "\":0";
    }
    CHECK(with(members) == status::Bad_IdentityTokenInvalid);
    std::string values = "\"a\":[0";
    for (int i = 1; i < 400; ++i) {
        values += ",0";
    }
    CHECK(with(values + "]") == status::Good);
    for (int i = 0; i < 200; ++i) {
        values += ",0";
    }
    CHECK(with(values + "]") == status::Bad_IdentityTokenInvalid);
}

} // namespace jwt_test
