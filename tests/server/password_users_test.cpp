#include <catch2/catch.hpp>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/user_directory.hpp>

#include "support/identity.hpp"
#include "support/seeded_random.hpp"

namespace password_users_test {

using namespace busbar;
using namespace busbar::test;
using server::PasswordRules;
using server::PasswordUsers;

namespace {

constexpr crypto::PasswordCost cheap_pbkdf2{.scheme = crypto::PasswordScheme::Pbkdf2,
                                            .iterations = 1'000};
constexpr crypto::PasswordCost cheap_scrypt{.log_n = 4};

/// "" for a password that the rules allow, else what is wrong with it.
std::string fault(const PasswordRules& rules, std::string_view password)
{
    const auto checked = server::check_password(rules, "maria", password);
    return checked ? std::string{} : checked.error().found;
}

std::string name_fault(const PasswordRules& rules, std::string_view name)
{
    const auto checked = server::check_user_name(rules, name);
    return checked ? std::string{} : checked.error().found;
}

} // namespace

TEST_CASE("nj501: letters and digits, and no name of a role")
{
    const PasswordRules rules = server::nj501_password_rules();
    CHECK(name_fault(rules, "Abc1").empty());
    CHECK(name_fault(rules, std::string(32, 'z')).empty());
    for (const std::string& wrong :
         {std::string{"abc"}, std::string(33, 'z'), std::string{"abc-d"},
          std::string{"J\xC3\xB6rg1"}, std::string{"operator"}, std::string{"ADMINISTRATOR"},
          std::string{"Anonymous"}, std::string{"Designer"}, std::string{"Maintainer"},
          std::string{"Observer"}}) {
        CAPTURE(wrong);
        CHECK_FALSE(name_fault(rules, wrong).empty());
    }
    CHECK(fault(rules, "abcdefgh").empty());
    CHECK(fault(rules, std::string(32, '9')).empty());
    CHECK_FALSE(fault(rules, "abcdefg").empty());
    CHECK_FALSE(fault(rules, std::string(33, '9')).empty());
    CHECK_FALSE(fault(rules, "abcdefg!").empty());
    CHECK(rules.max_users == 20);
}

TEST_CASE("rd81opc96: three kinds of characters")
{
    const PasswordRules rules = server::rd81opc96_password_rules();
    CHECK(name_fault(rules, "user01").empty());
    CHECK_FALSE(name_fault(rules, "user 01").empty());
    CHECK(fault(rules, "Abcde1").empty());
    CHECK(fault(rules, "Ab_1" + std::string(28, 'x')).empty());
    for (const std::string& wrong :
         {std::string{"Abcd1"}, "Ab1" + std::string(30, 'x'), std::string{"abcde1"},
          std::string{"ABCDE1"}, std::string{"Abcdef"}, std::string{"Abcde 1"},
          std::string{"MITSUBISHI"}}) {
        CAPTURE(wrong);
        CHECK_FALSE(fault(rules, wrong).empty());
    }
}

TEST_CASE("a user's name is a text that people can read")
{
    const PasswordRules rules;
    CHECK(name_fault(rules, "J\xC3\xB6rg M.").empty());
    for (const char* wrong : {"", " ", "pat ", " pat", "pat\n", "\xff\xfe", "\xe2\x80\xaetap"}) {
        CAPTURE(wrong);
        CHECK_FALSE(name_fault(rules, wrong).empty());
    }
}

TEST_CASE("by default a password has to be long, and anything that can be typed")
{
    const PasswordRules rules;
    CHECK(fault(rules, "correct horse").empty());
    CHECK(fault(rules, "d\xC3\xA9j\xC3\xA0 vu d\xC3\xA9j\xC3\xA0").empty());
    CHECK(fault(rules, std::string(64, 'x')).empty());
    CHECK_FALSE(fault(rules, std::string(65, 'x')).empty()); // would not fit a token
    CHECK_FALSE(fault(rules, "short horse").empty());
    CHECK_FALSE(fault(rules, "d\xC3\xA9j\xC3\xA0 vu").empty()); // characters, not bytes
    CHECK_FALSE(fault(rules, "correct\nhorse").empty());
    CHECK_FALSE(fault(rules, std::string("correct\0horse", 13)).empty());
    const auto same = server::check_password(rules, "maria the 2nd", "Maria the 2nd");
    CHECK(same.error().found == "it is the user's name");
    CHECK(name_fault(rules, "Jos\xC3\xA9").empty());
    CHECK_FALSE(name_fault(rules, "").empty());
    CHECK_FALSE(name_fault(rules, "a\tb").empty());
    CHECK_FALSE(name_fault(rules, "a\xFF").empty());
}

TEST_CASE("a refused password is not shown")
{
    const auto refused =
        server::check_password(server::rd81opc96_password_rules(), "maria", "hunter2hunter2");
    CHECK(text(refused.error()).find("hunter2") == std::string::npos);
}

TEST_CASE("users are added by the rules, and log in with their passwords")
{
    SeededRandom random;
    PasswordRules rules = server::nj501_password_rules();
    rules.cost = cheap_scrypt;
    PasswordUsers users{rules};
    CHECK(users.log_in("maria", "passw0rdA").error() == status::Bad_UserAccessDenied);
    CHECK(users.add("Operator", "passw0rdA", random).error().status == status::Bad_InvalidArgument);
    CHECK(users.add("maria", "short", random).error().status == status::Bad_InvalidArgument);
    REQUIRE(users.add("maria", "passw0rdA", random, {3, {"Operator"}}));
    CHECK(users.add("maria", "passw0rdB", random).error().status == status::Bad_EntryExists);

    const auto user = users.log_in("maria", "passw0rdA");
    REQUIRE(user);
    CHECK(*user == server::UserIdentity{UserTokenType::UserName, "maria", 3, {"Operator"}});
    CHECK_FALSE(users.log_in("maria", "passw0rda"));
    CHECK_FALSE(users.log_in("Maria", "passw0rdA"));
    CHECK_FALSE(users.log_in("nobody", "passw0rdA"));

    SECTION("passwords change, for those who know the old one")
    {
        const auto change = [&](const char* from, const char* to) {
            const auto changed = users.change_password("maria", from, to, random);
            return changed ? StatusCode{} : changed.error().status;
        };
        CHECK(change("wrong", "passw0rdB") == status::Bad_UserAccessDenied);
        CHECK(change("passw0rdA", "short") == status::Bad_InvalidArgument);
        CHECK(users.log_in("maria", "passw0rdA"));
        CHECK(change("passw0rdA", "passw0rdB") == status::Good);
        CHECK_FALSE(users.log_in("maria", "passw0rdA"));
        CHECK(users.log_in("maria", "passw0rdB")->access_level_mask == 3);
    }
    SECTION("they are removed")
    {
        CHECK(users.remove("maria"));
        CHECK_FALSE(users.remove("maria"));
        CHECK_FALSE(users.log_in("maria", "passw0rdA"));
    }
    SECTION("they are stored as hashes")
    {
        PasswordUsers later;
        REQUIRE(later.set("maria", std::string{users.password_hash("maria")}));
        CHECK(later.log_in("maria", "passw0rdA"));
        CHECK(users.password_hash("nobody").empty());
    }
    SECTION("there are at most so many")
    {
        const std::string hash{users.password_hash("maria")};
        for (int i = 1; i < 20; ++i) {
            REQUIRE(users.set("user" + std::to_string(i), hash));
        }
        CHECK(users.add("user20", "passw0rdA", random).error().status ==
              status::Bad_TooManyOperations);
    }
}

TEST_CASE("users from a file need a name and a hash")
{
    SeededRandom random;
    PasswordUsers users;
    CHECK(users.set("maria", "secret").error() == status::Bad_InvalidArgument);
    CHECK(users.set("", crypto::hash_password("secret", random, cheap_scrypt).value()).error() ==
          status::Bad_InvalidArgument);
    CHECK(users.anonymous() == server::anonymous_reader());
}

TEST_CASE("new hashes cost what the rules say, and those that there are go on")
{
    SeededRandom random;
    const PasswordRules rules{.cost = cheap_pbkdf2};
    PasswordUsers users{rules};
    REQUIRE(users.set("maria", crypto::hash_password("correct horse", random, cheap_scrypt).value(),
                      {1, {"Observer"}}));
    REQUIRE(users.add("bert", "correct horse", random, {3, {"Operator"}}));
    const auto cost = [&](const char* name) { return crypto::cost_of(users.password_hash(name)); };
    CHECK(cost("maria") == cheap_scrypt);
    CHECK(cost("bert") == cheap_pbkdf2);
    CHECK(users.log_in("maria", "correct horse")->access_level_mask == 1);
    CHECK(users.log_in("bert", "correct horse")->access_level_mask == 3);

    REQUIRE(users.change_password("maria", "correct horse", "battery staple", random));
    CHECK(cost("maria") == cheap_pbkdf2);
    CHECK(users.log_in("maria", "battery staple")->access_level_mask == 1);

    PasswordRules impossible;
    impossible.cost.log_n = 16;
    PasswordUsers nobody{impossible};
    CHECK(nobody.add("carl", "correct horse", random).error().status ==
          status::Bad_InvalidArgument);
    CHECK(nobody.password_hash("carl").empty());
}

TEST_CASE("a name that is not there logs in with nobody's password")
{
    SeededRandom random;
    PasswordUsers users;
    REQUIRE(users.set("a", crypto::hash_password("secret", random, cheap_scrypt).value()));
    REQUIRE(users.set("b", crypto::hash_password("secret", random, cheap_pbkdf2).value()));
    for (int i = 0; i < 20; ++i) {
        CHECK(users.log_in("nobody" + std::to_string(i), "secret").error() ==
              status::Bad_UserAccessDenied);
    }
}

TEST_CASE("a directory gives rights to certificates and tokens")
{
    server::UserDirectory users;
    const crypto::Certificate& certificate = client_identity().certificates.front();
    CHECK(users.certificate_validator() == nullptr);
    CHECK(users.token_rules() == nullptr);
    crypto::InsecureAcceptAnyCertificate validator;
    users.accept_certificates(validator);
    users.accept_tokens({});
    CHECK(users.certificate_validator() == &validator);
    CHECK(users.token_rules() != nullptr);

    CHECK(users.certificate_user(certificate)->access_level_mask == 0xFF);
    users.set_other_certificate_rights(std::nullopt);
    CHECK(users.certificate_user(certificate).error() == status::Bad_IdentityTokenRejected);
    users.set_certificate_rights(certificate.thumbprint_text(), {1, {"Observer"}});
    CHECK(users.certificate_user(certificate)->access_level_mask == 1);

    crypto::JwtClaims claims;
    claims.roles = {"Operator", "unknown"};
    CHECK(users.token_user(claims)->access_level_mask ==
          server::anonymous_reader().access_level_mask);
    users.set_role_access("Operator", 0x02);
    CHECK(users.token_user(claims)->access_level_mask == 0x07);
    CHECK(users.token_user(claims)->roles == std::vector<std::string>{"Operator"});
    claims.roles = {"SecurityAdmin", "Operator"}; // the issuer does not decide who administers
    CHECK(users.token_user(claims)->roles == std::vector<std::string>{"Operator"});
}

TEST_CASE("users that are set and removed together")
{
    SeededRandom random;
    PasswordUsers users{{.cost = cheap_scrypt}};
    REQUIRE(users.add("maria", "patience is all", random));
    REQUIRE(users.add("tom", "patience is all", random));
    REQUIRE(users.add("pat", "patience is all", random));
    const auto hash = crypto::hash_password("another of them", random, cheap_scrypt).value();
    PasswordUsers::Change change;
    CHECK(change.set("maria", hash, {.must_change_password = true}));
    CHECK(change.set("eve", hash));
    CHECK_FALSE(change.set("", hash));
    CHECK_FALSE(change.set("mallory", "no hash"));
    change.remove("tom");
    change.remove("nobody");
    CHECK_FALSE(users.log_in("eve", "another of them"));
    users.apply(std::move(change));
    const auto maria = users.log_in("maria", "another of them");
    REQUIRE(maria);
    CHECK(maria->must_change_password);
    CHECK(users.log_in("eve", "another of them"));
    CHECK(users.log_in("pat", "patience is all"));
    CHECK_FALSE(users.log_in("tom", "patience is all"));
    CHECK(users.password_hash("mallory").empty());
}

} // namespace password_users_test
