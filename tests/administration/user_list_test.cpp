#include <busbar/administration/user_list.hpp>

#include <thread>

#include <catch2/catch.hpp>

#include <busbar/administration/configured_users.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/storage_gate.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "support/watched_storage.hpp"

namespace user_list_test {

using namespace busbar;
using administration::User;
using administration::UserChange;
using administration::UserList;
namespace user_bit = administration::user_bit;

namespace {

const std::string good_password = "correct horse 1";

struct Fixture {
    Fixture() { REQUIRE(list.load()); }

    Checked<void> add(std::string name, std::vector<std::string> roles = {},
                      std::uint32_t configuration = 0)
    {
        User user;
        user.name = std::move(name);
        user.roles = std::move(roles);
        user.configuration = configuration;
        return list.add(std::move(user), good_password, random);
    }
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view name,
                                                      std::string_view password = good_password)
    {
        return passwords.log_in(name, password);
    }
    /// What a program finds that starts anew.
    [[nodiscard]] std::vector<User> stored()
    {
        server::PasswordUsers others;
        UserList again{storage, "users.json", {}, others};
        REQUIRE(again.load());
        return again.users();
    }

    storage::MemoryStorage storage;
    crypto::SystemRandom random;
    server::PasswordUsers passwords;
    administration::ConfiguredUsers configured;
    // What a hash costs is not what is tested here.
    UserList list{storage, "users.json", {.cost = {.log_n = 1}}, passwords, {}, &configured};
};

template <typename T>
std::string_view status_of(const Checked<T>& result)
{
    return result ? "Good" : name(result.error().status);
}

} // namespace

TEST_CASE_METHOD(Fixture, "users: one is added, logs in, and is there after a restart")
{
    REQUIRE(add("pat", {"Operator"}));
    CHECK(log_in("pat")->roles == std::vector<std::string>{"Operator"});
    CHECK(log_in("pat")->access_level_mask == 0xFF);
    CHECK_FALSE(log_in("pat", "wrong"));
    REQUIRE(add("ann", {"Observer"}));
    CHECK(log_in("ann")->access_level_mask == 5); // reads
    REQUIRE(stored().size() == 2);
    CHECK(stored()[0].name == "ann");
    CHECK(stored()[1].roles == std::vector<std::string>{"Operator"});
    CHECK(crypto::is_password_hash(stored()[1].password_hash));
    CHECK_FALSE(storage.is_open_to_others("users.json"));
}

TEST_CASE_METHOD(Fixture, "users: no name and no description keeps the others from a restart",
                 "[attack]")
{
    using namespace std::string_literals;
    REQUIRE(add("pat"));
    for (const std::string& text :
         {"\"}], \"users\": [{"s, "a\\"s, "a\nb\r"s, "a\0b"s, "\x01\x1b[2J\x7f"s, "\xC3"s,
          "\xFF\xFE"s, "\xED\xA0\x80"s, "\xC0\x80"s, "\\u0000"s, "<user/>&amp;"s, "../pat"s}) {
        for (const bool is_name : {true, false}) {
            User user;
            user.name = is_name ? "named " + text : "described";
            user.description = is_name ? "" : text;
            const bool is_added = bool{list.add(user, good_password, random)};
            const auto found = stored();
            REQUIRE(found.size() == list.users().size());
            CHECK(found.back().name == "pat");
            if (is_added) {
                CHECK(found.front().name == user.name);
                CHECK(found.front().description == user.description);
                REQUIRE(list.remove(user.name));
            }
        }
        UserChange change;
        change.description = text;
        const bool is_changed = bool{list.modify("pat", change, random)};
        REQUIRE(stored().size() == 1);
        CHECK(stored()[0].description == list.users()[0].description);
        CHECK(is_changed == (list.users()[0].description == text));
    }
}

TEST_CASE_METHOD(Fixture, "users: what cannot be added (Part 18, 5.2.5)")
{
    REQUIRE(add("pat"));
    CHECK(status_of(add("pat")) == "Bad_AlreadyExists");
    REQUIRE(
        passwords.set("configured", *crypto::hash_password(good_password, random, {.log_n = 1})));
    CHECK(status_of(add("configured")) == "Bad_AlreadyExists");
    CHECK(status_of(add("")) == "Bad_InvalidArgument");
    CHECK(status_of(add("new", {}, 16)) == "Bad_NotSupported");
    CHECK(status_of(add("new", {}, user_bit::no_change_by_user | user_bit::must_change_password)) ==
          "Bad_ConfigurationError");
    User user;
    user.name = "new";
    CHECK(status_of(list.add(user, "short", random)) == "Bad_OutOfRange");
    user.description = std::string(300, 'x');
    CHECK(status_of(list.add(user, good_password, random)) == "Bad_InvalidArgument");
    CHECK(list.users().size() == 1);
}

TEST_CASE("users: the list has a limit, and names and passwords rules")
{
    storage::MemoryStorage storage;
    crypto::SystemRandom random;
    server::PasswordUsers passwords;
    server::PasswordRules rules = server::nj501_password_rules();
    rules.cost.log_n = 1;
    rules.max_users = 1;
    UserList list{storage, "users.json", rules, passwords};
    User user;
    user.name = "abc"; // 4 to 32
    CHECK(status_of(list.add(user, "abcd1234", random)) == "Bad_InvalidArgument");
    user.name = "abcd";
    CHECK(status_of(list.add(user, "abcd123", random)) == "Bad_OutOfRange");
    CHECK(status_of(list.add(user, "abcde1234", random)) == "Good");
    user.name = "abcde";
    CHECK(status_of(list.add(user, "abcde1234", random)) == "Bad_ResourceUnavailable");
}

TEST_CASE("users: hashes cost what the rules say, and those of before stay")
{
    storage::MemoryStorage storage;
    crypto::SystemRandom random;
    server::PasswordUsers passwords;
    User user;
    user.name = "pat";
    server::PasswordRules rules;
    rules.cost.log_n = 4;
    UserList before{storage, "users.json", rules, passwords};
    REQUIRE(before.add(user, good_password, random));

    rules.cost = {.scheme = crypto::PasswordScheme::Pbkdf2, .iterations = 1'000};
    UserList list{storage, "users.json", rules, passwords};
    REQUIRE(list.load());
    user.name = "ann";
    REQUIRE(list.add(user, good_password, random));
    const auto scheme_of = [&](const char* name) {
        return crypto::cost_of(list.find(name)->password_hash)->scheme;
    };
    CHECK(scheme_of("pat") == crypto::PasswordScheme::Scrypt);
    CHECK(scheme_of("ann") == crypto::PasswordScheme::Pbkdf2);
    CHECK(passwords.log_in("pat", good_password));
    CHECK(passwords.log_in("ann", good_password));

    REQUIRE(list.change_password("pat", good_password, "another horse 2", random));
    CHECK(scheme_of("pat") == crypto::PasswordScheme::Pbkdf2);
    CHECK(passwords.log_in("pat", "another horse 2"));
}

TEST_CASE("users: what waits for a restart is not changed before")
{
    storage::MemoryStorage storage;
    StorageGate gate{storage};
    crypto::SystemRandom random;
    server::PasswordUsers passwords;
    UserList list{gate, "users.json", server::nj501_password_rules(), passwords};
    gate.close();
    User user;
    user.name = "late";
    CHECK(status_of(list.add(user, "abcde1234", random)) == "Bad_InvalidState");
    CHECK(list.users().empty());
    CHECK(passwords.password_hash("late").empty());
    CHECK(storage.names().empty());
}

TEST_CASE_METHOD(Fixture, "users: are modified, disabled and enabled (Part 18, 5.2.6)")
{
    REQUIRE(add("pat", {"Operator"}));
    UserChange change;
    change.configuration = user_bit::disabled;
    change.description = "on leave";
    REQUIRE(list.modify("pat", change, random));
    CHECK_FALSE(log_in("pat"));
    CHECK(stored()[0].configuration == user_bit::disabled);
    CHECK(stored()[0].description == "on leave");
    change = {};
    change.configuration = user_bit::must_change_password;
    change.password = "another horse 2";
    REQUIRE(list.modify("pat", change, random));
    CHECK_FALSE(log_in("pat"));
    CHECK(log_in("pat", "another horse 2")->must_change_password);
    CHECK(list.find("pat")->description == "on leave");
    CHECK(status_of(list.modify("sam", {}, random)) == "Bad_NotFound");
    change.password = "x";
    CHECK(status_of(list.modify("pat", change, random)) == "Bad_OutOfRange");
}

TEST_CASE_METHOD(Fixture, "users: are removed, but for those who must not be (Part 18, 5.2.7)")
{
    REQUIRE(add("pat"));
    REQUIRE(add("kept", {}, user_bit::no_delete));
    CHECK(status_of(list.remove("sam")) == "Bad_NotFound");
    CHECK(status_of(list.remove("kept")) == "Bad_NotSupported");
    REQUIRE(list.remove("pat"));
    CHECK_FALSE(log_in("pat"));
    CHECK(stored().size() == 1);
}

TEST_CASE_METHOD(Fixture, "users: those of the configuration are listed and stay as they are")
{
    REQUIRE(add("zoe"));
    REQUIRE(add("pat", {"Operator"}));
    const auto hash = crypto::hash_password("a word of the file", random, {.log_n = 1});
    REQUIRE(passwords.set("pat", *hash));
    configured.replace({{.name = "pat", .roles = {"Observer"}}});
    REQUIRE(list.load()); // as after a restart, or when the file was read again
    CHECK_FALSE(log_in("pat"));
    CHECK(log_in("pat", "a word of the file"));
    const std::vector<User> all = list.all_users();
    REQUIRE(all.size() == 2);
    CHECK(all[0].name == "pat");
    CHECK(all[0].configuration == (user_bit::no_delete | user_bit::no_change_by_user));
    CHECK(all[0].description == administration::of_configuration);
    CHECK(all[0].roles == std::vector<std::string>{"Observer"});
    CHECK(all[0].password_hash.empty());
    CHECK(all[1].name == "zoe");

    CHECK(status_of(add("pat")) == "Bad_AlreadyExists");
    CHECK(status_of(list.modify("pat", {}, random)) == "Bad_NotSupported");
    CHECK(status_of(list.remove("pat")) == "Bad_NotSupported");
    const auto change = [&](std::string_view from) {
        return status_of(list.change_password("pat", from, "another horse 2", random));
    };
    CHECK(change("wrong") == "Bad_IdentityTokenInvalid");
    CHECK(change("a word of the file") == "Bad_NotSupported");
    CHECK(log_in("pat", "a word of the file"));
    // Without the account of the file the one that was added is back.
    passwords.remove("pat");
    configured.replace({});
    REQUIRE(list.load());
    CHECK(log_in("pat"));
}

TEST_CASE_METHOD(Fixture, "users: the last administrator may go if the configuration has one")
{
    REQUIRE(add("root", {"SecurityAdmin"}));
    configured.replace({{.name = "setup", .roles = {"SecurityAdmin"}, .is_temporary = true}});
    CHECK(status_of(list.remove("root")) == "Bad_RequestNotAllowed");
    configured.replace({{.name = "chief", .roles = {"SecurityAdmin"}}});
    CHECK(status_of(list.remove("root")) == "Good");
    CHECK(list.has_administrator());
}

TEST_CASE_METHOD(Fixture, "users: the last administrator stays")
{
    CHECK_FALSE(list.has_administrator());
    REQUIRE(add("root", {"SecurityAdmin"}));
    REQUIRE(add("pat"));
    CHECK(list.has_administrator());
    CHECK(status_of(list.remove("root")) == "Bad_RequestNotAllowed");
    UserChange change;
    change.configuration = user_bit::disabled;
    CHECK(status_of(list.modify("root", change, random)) == "Bad_RequestNotAllowed");
    change = {};
    change.roles = std::vector<std::string>{"Operator"};
    CHECK(status_of(list.modify("root", change, random)) == "Bad_RequestNotAllowed");
    REQUIRE(add("second", {"SecurityAdmin"}));
    REQUIRE(list.remove("root"));
    CHECK(status_of(list.remove("second")) == "Bad_RequestNotAllowed");
}

TEST_CASE_METHOD(Fixture, "users: change their passwords (Part 18, 5.2.8)")
{
    REQUIRE(add("pat", {}, user_bit::must_change_password));
    REQUIRE(add("fixed", {}, user_bit::no_change_by_user));
    const std::string next = "another horse 2";
    CHECK(status_of(list.change_password("pat", "wrong", next, random)) ==
          "Bad_IdentityTokenInvalid");
    CHECK(status_of(list.change_password("sam", good_password, next, random)) ==
          "Bad_IdentityTokenInvalid");
    CHECK(status_of(list.change_password("fixed", good_password, next, random)) ==
          "Bad_NotSupported");
    CHECK(status_of(list.change_password("pat", good_password, "x", random)) == "Bad_OutOfRange");
    CHECK(status_of(list.change_password("pat", good_password, good_password, random)) ==
          "Bad_AlreadyExists");
    REQUIRE(list.change_password("pat", good_password, next, random));
    CHECK_FALSE(log_in("pat"));
    CHECK_FALSE(log_in("pat", next)->must_change_password);
    CHECK(stored()[1].configuration == 0);
}

TEST_CASE_METHOD(Fixture,
                 "users: a file that is wrong is refused with its place, and nothing changes")
{
    REQUIRE(add("pat"));
    const std::string hash = stored()[0].password_hash;
    const std::string user = R"("configuration":0,"description":"","roles":[]})";
    const std::string begin = R"({"version":1,"users":[)";
    const std::string good = R"({"name":"a","password_hash":")" + hash + "\"," + user;
    const auto problem = [&](const std::string& text) {
        REQUIRE(storage.replace("users.json", std::as_bytes(std::span{text}), FileAccess::Owner));
        const auto loaded = list.load();
        CHECK(list.users().size() == 1);
        return loaded ? "Good" : busbar::text(loaded.error());
    };
    const std::string place = "memory:users.json";
    CHECK(problem("{").find(place) == 0);
    CHECK(problem("[]") == place + ": the file: found a list, expected an object");
    CHECK(problem("{}") == place + ": version: found nothing, expected 1");
    CHECK(problem(R"({"version":2})") == place + ": version: found 2, expected 1");
    CHECK(problem(R"({"version":1})") == place + ": users: found nothing, expected a list");
    CHECK(problem(begin + R"({"name":7,)" + user + "]}") ==
          place + ": users[0].name: found 7, expected a name");
    CHECK(problem(begin + R"({"name":"a","password_hash":"secret",)" + user + "]}") ==
          place + ": users[0].password_hash: found nothing, expected the hash of a password");
    CHECK(problem(begin + good + "," + good + "]}") ==
          place + ": users[1].name: found \"a\", expected each name once");
    for (std::size_t size = 0; size < good.size() + begin.size(); ++size) {
        CHECK(problem((begin + good).substr(0, size)) != "Good");
    }
    CHECK(log_in("pat"));
}

TEST_CASE_METHOD(Fixture, "users: members of a user that are none are named")
{
    REQUIRE(add("pat"));
    const std::string begin = R"({"version":1,"users":[{"name":"a","password_hash":")" +
                              stored()[0].password_hash + "\",";
    const auto problem = [&](const std::string& text) {
        const std::string document = begin + text + "}]}";
        REQUIRE(
            storage.replace("users.json", std::as_bytes(std::span{document}), FileAccess::Owner));
        const auto loaded = list.load();
        CHECK(list.users().size() == 1);
        return loaded ? "Good" : busbar::text(loaded.error());
    };
    const std::string place = "memory:users.json: users[0].";
    for (const char* bits : {"-1", "1.5", "\"1\"", "4294967296", "4294967295"}) {
        CHECK(problem(R"("configuration":)" + std::string{bits} +
                      R"(,"description":"","roles":[])") ==
              place + "configuration: found " + bits + ", expected bits of UserConfigurationMask");
    }
    CHECK(problem(R"("configuration":0,"description":7,"roles":[])") ==
          place + "description: found 7, expected a text");
    CHECK(problem(R"("configuration":0,"description":"")") ==
          place + "roles: found nothing, expected a list of texts");
    CHECK(problem(R"("configuration":0,"description":"","roles":["Operator",7])") ==
          place + "roles: found a list, expected a list of texts");
    CHECK(log_in("pat"));
}

TEST_CASE_METHOD(Fixture, "users: who is disabled changes no password")
{
    REQUIRE(add("pat", {}, user_bit::disabled));
    CHECK(status_of(list.change_password("pat", good_password, "another horse 2", random)) ==
          "Bad_IdentityTokenInvalid");
    UserChange change;
    change.configuration = 0;
    REQUIRE(list.modify("pat", change, random));
    CHECK(log_in("pat"));
}

// Or a thread that keeps others from writing, as a restore does, could never ask who is there.
TEST_CASE("users: are read while a change waits for its file")
{
    storage::MemoryStorage medium;
    test::WatchedStorage storage{medium};
    crypto::SystemRandom random;
    server::PasswordUsers passwords;
    UserList list{storage, "users.json", {.cost = {.log_n = 1}}, passwords};
    REQUIRE(list.add({"ann", {}, 0, {}, {"SecurityAdmin"}}, good_password, random));
    std::size_t seen = 0;
    bool has_administrator = false;
    storage.meanwhile = [&] {
        std::thread{[&] {
            seen = list.users().size();
            has_administrator = list.has_administrator() && list.find("ann");
        }}.join();
    };
    CHECK(list.add({"bob", {}, 0, {}, {}}, good_password, random));
    CHECK(seen == 1); // what is not stored does not count yet
    CHECK(has_administrator);
    CHECK(list.modify("bob", {.description = "of the night shift"}, random));
    CHECK(seen == 2);
    CHECK(list.change_password("bob", good_password, "another horse 2", random));
    CHECK(list.remove("bob"));
    CHECK(list.users().size() == 1);
}

} // namespace user_list_test
