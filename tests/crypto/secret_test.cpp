#include <set>

#include <catch2/catch.hpp>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/secret.hpp>

#include "hex.hpp"
#include "support/seeded_random.hpp"

namespace secret_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Secret;

namespace {

/// A source that has run dry.
class NoRandom final : public crypto::Random {
public:
    Result<void> fill(std::span<std::byte>) override
    {
        return fail(status::Bad_ResourceUnavailable);
    }
};

} // namespace

TEST_CASE("a secret moves and is gone where it was", "[crypto][secret]")
{
    Secret first{std::string_view{"pass"}};
    CHECK(first.text() == "pass");
    Secret second{std::move(first)};
    CHECK(second.text() == "pass");
    Secret third;
    CHECK(third.empty());
    third = std::move(second);
    CHECK(third.size() == 4);
    std::array<std::byte, 3> bytes{std::byte{1}, std::byte{2}, std::byte{3}};
    crypto::cleanse(bytes);
    CHECK(bytes == std::array<std::byte, 3>{});
    crypto::cleanse({});
}

TEST_CASE("comparison sees every bit and every length", "[crypto][secret]")
{
    const auto a = from_text("abcdefgh");
    CHECK(crypto::equal_in_constant_time(a, a));
    CHECK(crypto::equal_in_constant_time({}, {}));
    for (std::size_t bit = 0; bit < a.size() * 8; ++bit) {
        auto b = a;
        b[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        CHECK_FALSE(crypto::equal_in_constant_time(a, b));
    }
    CHECK_FALSE(crypto::equal_in_constant_time(a, std::span{a}.first(7)));
    CHECK_FALSE(crypto::equal_in_constant_time(a, {}));
}

TEST_CASE("the system's source does not repeat itself", "[crypto][random]")
{
    crypto::SystemRandom random;
    std::set<std::vector<std::byte>> seen;
    for (int i = 0; i < 1'000; ++i) {
        std::vector<std::byte> bytes(32);
        REQUIRE(random.fill(bytes));
        CHECK(seen.insert(bytes).second);
    }
    CHECK(random.fill({}));
}

TEST_CASE("the tests' source repeats itself", "[crypto][random]")
{
    SeededRandom a{5};
    SeededRandom b{5};
    SeededRandom c{6};
    std::array<std::byte, 16> x{};
    std::array<std::byte, 16> y{};
    std::array<std::byte, 16> z{};
    REQUIRE((a.fill(x) && b.fill(y) && c.fill(z)));
    CHECK(x == y);
    CHECK(x != z);
}

TEST_CASE("a stored password is verified", "[crypto][password]")
{
    SeededRandom random;
    const auto stored = crypto::hash_password("a pass phrase", random);
    REQUIRE(stored);
    CHECK(stored->rfind("$scrypt$14$8$1$", 0) == 0);
    CHECK(stored->find("pass") == std::string::npos);
    CHECK(crypto::is_password_hash(*stored));
    CHECK(crypto::verify_password("a pass phrase", *stored));
    for (const char* wrong : {"", "a pass phras", "a pass phrase ", "A pass phrase"}) {
        CHECK_FALSE(crypto::verify_password(wrong, *stored));
    }
    const auto again = crypto::hash_password("a pass phrase", random);
    CHECK(*again != *stored); // another salt
    NoRandom none;
    CHECK_FALSE(crypto::hash_password("a pass phrase", none));
}

TEST_CASE("a NUL in a password counts", "[crypto][password]")
{
    SeededRandom random;
    using namespace std::string_view_literals;
    const auto stored = crypto::hash_password("a\0b"sv, random);
    CHECK(crypto::verify_password("a\0b"sv, *stored));
    CHECK_FALSE(crypto::verify_password("a"sv, *stored));
    CHECK_FALSE(crypto::verify_password("a\0c"sv, *stored));
    const auto empty = crypto::hash_password("", random);
    CHECK(crypto::verify_password("", *empty));
}

TEST_CASE("a hash made elsewhere is understood", "[crypto][password]")
{
    // Computed with the pseudo code of RFC 7914, salt 0, 1, ... 15.
    CHECK(crypto::verify_password(
        "password",
        "$scrypt$14$8$1$AAECAwQFBgcICQoLDA0ODw==$6iMJXpgeItuXSS3ial5ceU6o+LQA0aKIA8ORmTlhNMU="));
    CHECK(crypto::verify_password(
        "password",
        "$scrypt$10$4$3$AAECAwQFBgcICQoLDA0ODw==$Oslk8VaEfw/KU/UczAMzg9TLj9rnh58o6zdHfgxGLSU="));
    CHECK_FALSE(crypto::verify_password(
        "passwore",
        "$scrypt$14$8$1$AAECAwQFBgcICQoLDA0ODw==$6iMJXpgeItuXSS3ial5ceU6o+LQA0aKIA8ORmTlhNMU="));
}

TEST_CASE("texts that are no hash verify nothing", "[crypto][password]")
{
    SeededRandom random;
    const std::string good = *crypto::hash_password("x", random);
    for (std::size_t size = 0; size < good.size(); ++size) {
        CHECK_FALSE(crypto::is_password_hash(good.substr(0, size)));
    }
    const std::string rest = good.substr(good.find("$1$") + 3);
    for (const char* parameters :
         {"", "0$8$1$", "16$8$1$", "63$8$1$", "64$8$1$", "14$0$1$", "14$9$1$", "14$8$0$", "14$8$5$",
          "-1$8$1$", "14$8$4294967296$", " 14$8$1$", "14x$8$1$", "14$8$1$$", "$$$"}) {
        INFO(parameters);
        CHECK_FALSE(crypto::is_password_hash("$scrypt$" + std::string{parameters} + rest));
        CHECK_FALSE(crypto::verify_password("x", "$scrypt$" + std::string{parameters} + rest));
    }
    CHECK_FALSE(crypto::is_password_hash(good + "$"));
    CHECK_FALSE(crypto::is_password_hash("$argon2$14$8$1$" + rest));
    CHECK_FALSE(crypto::is_password_hash("x"));
}

} // namespace secret_test
