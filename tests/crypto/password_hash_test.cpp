#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include <busbar/crypto/password_hash.hpp>

#include "support/seeded_random.hpp"

namespace password_hash_test {

using namespace busbar;
using namespace busbar::test;
using crypto::PasswordCost;
using crypto::PasswordScheme;

namespace {

constexpr PasswordCost cheap_pbkdf2{.scheme = PasswordScheme::Pbkdf2, .iterations = 1'000};
constexpr PasswordCost cheap_scrypt{.log_n = 4, .r = 2, .p = 3};

// Of the password "password", with the salt 0, 1, ... 15.
const std::string salt = "AAECAwQFBgcICQoLDA0ODw==";
const std::string hash = "62yBU1WSIDwJKxWPjTkJZyNipvXb0A2YKARMuqiyUuk=";

std::string pbkdf2(const std::string& iterations, const std::string& rest = salt + "$" + hash)
{
    return "$pbkdf2-sha256$" + iterations + "$" + rest;
}

} // namespace

TEST_CASE("PBKDF2: a hash made elsewhere is understood", "[crypto][password]")
{
    CHECK(crypto::verify_password("password", pbkdf2("10000")));
    CHECK_FALSE(crypto::verify_password("passwore", pbkdf2("10000")));
    CHECK_FALSE(crypto::verify_password("password", pbkdf2("10001")));
    // Longer than a block of HMAC.
    CHECK(crypto::verify_password(
        std::string(100, 'p'),
        pbkdf2("1000", salt + "$8XHq8rALbUTwbt7C4xthRRFXEJ6s3Icn/GXWkdcPZz4=")));
}

TEST_CASE("a password is stored and verified with each scheme", "[crypto][password]")
{
    struct Row {
        PasswordCost cost;
        std::string beginning;
    };
    const Row rows[] = {{cheap_pbkdf2, "$pbkdf2-sha256$1000$"}, {cheap_scrypt, "$scrypt$4$2$3$"}};
    SeededRandom random;
    for (const Row& row : rows) {
        using namespace std::string_view_literals;
        INFO(row.beginning);
        for (const std::string_view password : {"a pass phrase"sv, ""sv, "a\0b"sv}) {
            const auto stored = crypto::hash_password(password, random, row.cost);
            REQUIRE(stored);
            CHECK(stored->starts_with(row.beginning));
            CHECK(crypto::cost_of(*stored) == row.cost);
            CHECK(crypto::verify_password(password, *stored));
            CHECK_FALSE(crypto::verify_password("a"sv, *stored));
            CHECK_FALSE(crypto::verify_password("a\0c"sv, *stored));
            CHECK(crypto::hash_password(password, random, row.cost) != stored); // another salt
        }
    }
}

TEST_CASE("PBKDF2: texts that are no hash verify nothing", "[crypto][password]")
{
    const std::string good = pbkdf2("10000");
    REQUIRE(crypto::is_password_hash(good));
    std::vector<std::string> wrong{good + "$", good + "A", good + "\n", " " + good, "x" + good};
    for (std::size_t size = 0; size < good.size(); ++size) {
        wrong.push_back(good.substr(0, size));
    }
    for (const char* iterations : {"", "0", "1", "999", "10000001", "4294967295", "4294967296",
                                   "4294977296", "18446744073709561616", "-10000", "+10000",
                                   " 10000", "10000 ", "1e4", "0x2710", "10000$8", "10000$8$1"}) {
        wrong.push_back(pbkdf2(iterations));
    }
    for (const std::string& rest :
         {std::string{"$"}, salt + "$", "$" + hash, hash + "$" + salt, salt + "$" + salt,
          hash + "$" + hash, salt + hash, salt + "$$" + hash, salt + "$" + hash.substr(1),
          salt + "$*" + hash.substr(1), "AAECAwQFBgcICQoLDA0O$" + hash}) {
        wrong.push_back(pbkdf2("10000", rest));
    }
    for (const char* scheme : {"pbkdf2", "pbkdf2-sha1", "pbkdf2-sha512", "PBKDF2-SHA256",
                               "pbkdf2-sha256 ", "scrypt", "argon2id", ""}) {
        wrong.push_back("$" + std::string{scheme} + "$10000$" + salt + "$" + hash);
    }
    for (const std::string& text : wrong) {
        INFO(text);
        CHECK_FALSE(crypto::is_password_hash(text));
        CHECK_FALSE(crypto::cost_of(text));
        CHECK_FALSE(crypto::verify_password("password", text));
    }
    CHECK(crypto::is_password_hash(pbkdf2("1000")));
    CHECK(crypto::is_password_hash(pbkdf2("10000000"))); // and no test asks for it
}

TEST_CASE("a cost out of range makes no hash", "[crypto][password]")
{
    constexpr auto scheme = PasswordScheme::Pbkdf2;
    const PasswordCost wrong[] = {{.scheme = scheme, .iterations = 0},
                                  {.scheme = scheme, .iterations = 999},
                                  {.scheme = scheme, .iterations = 10'000'001},
                                  {.scheme = scheme, .iterations = 0xFFFFFFFF},
                                  {.log_n = 0},
                                  {.log_n = 16},
                                  {.log_n = 64},
                                  {.log_n = 4, .r = 0},
                                  {.log_n = 4, .r = 9},
                                  {.log_n = 4, .p = 0},
                                  {.log_n = 4, .p = 5}};
    SeededRandom random;
    for (const PasswordCost& cost : wrong) {
        INFO(cost.log_n << " " << cost.r << " " << cost.p << " " << cost.iterations);
        const auto made = crypto::hash_password("password", random, cost);
        REQUIRE_FALSE(made);
        CHECK(made.error() == status::Bad_InvalidArgument);
        CHECK(crypto::memory_of(cost) == 0);
    }
}

TEST_CASE("what a hash takes in memory", "[crypto][password]")
{
    CHECK(crypto::memory_of({}) == 16'780'288);
    CHECK(crypto::memory_of({.log_n = 15, .r = 8, .p = 4}) < 34U << 20U);
    CHECK(crypto::memory_of({.log_n = 13}) < crypto::memory_of({}) / 2 + 4'096);
    CHECK(crypto::memory_of({.scheme = PasswordScheme::Pbkdf2}) < 64U << 10U);
    // OpenSSL is allowed no more than that.
    SeededRandom random;
    for (const PasswordCost& cost : {PasswordCost{.log_n = 1, .r = 1, .p = 1},
                                     PasswordCost{.log_n = 1, .r = 8, .p = 4}, cheap_scrypt}) {
        const auto stored = crypto::hash_password("password", random, cost);
        REQUIRE(stored);
        CHECK(crypto::verify_password("password", *stored));
    }
}

} // namespace password_hash_test
