#include <catch2/catch.hpp>

#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <busbar/administration/role_list.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/product/controller.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/machine/simulated_runtime.hpp"
#include "product/store/taken_over.hpp"
#include "support/identity.hpp"
#include "support/temporary_folder.hpp"

namespace damaged_lists_test {

using namespace busbar;
using namespace busbar::product;

// A controller whose lists of users or roles are damaged starts, and nobody may do more than
// before.

namespace {

/// A controller that is started and ends.
struct Place {
    Place()
    {
        std::ofstream{path("c.toml")} << "[server]\naddress = \"127.0.0.1\"\nport = 0\n"
                                         "[certificates]\nfolder = \""
                                      << path("pki")
                                      << "\"\n[users]\nanonymous = \"read\"\n"
                                         "[[users.account]]\nname = \"pat\"\n"
                                         "roles = [\"Operator\"]\npassword = \""
                                      << *crypto::hash_password("patience", random, cost)
                                      << "\"\n[[endpoint]]\npolicy = \"None\"\nmode = \"None\"\n";
        start();
    }
    [[nodiscard]] std::string path(const std::string& in) const
    {
        return (folder.path / in).string();
    }
    void start()
    {
        log.text.clear();
        SimulatedRuntime runtime;
        auto controller =
            Controller::create({.file = path("c.toml")}, runtime,
                               {.log = &log, .takes_signals = false, .greets = false});
        INFO((controller ? "" : text(controller.error())));
        REQUIRE(controller);
        (*controller)->stop();
        CHECK((*controller)->run());
    }
    void put(const std::string& name, std::string_view text)
    {
        REQUIRE(files.replace(name, std::as_bytes(std::span{text}), FileAccess::Owner));
    }
    [[nodiscard]] std::string content(const std::string& name)
    {
        const auto bytes = read_file(files, name, 1'000'000);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : "none";
    }
    /// Those of the roles that somebody who is given them has.
    [[nodiscard]] std::vector<std::string> left_of(std::vector<std::string> all)
    {
        administration::RoleList roles{files, "roles.json"};
        REQUIRE(roles.load());
        const server::UserIdentity user{UserTokenType::UserName, "pat", 0xFF, all};
        return roles
            .limited({.user = user, .application_uri = "urn:client", .is_trusted = true},
                     {0xFF, all})
            .roles;
    }

    static constexpr crypto::PasswordCost cost{.scheme = crypto::PasswordScheme::Pbkdf2,
                                               .iterations = 1'000};
    crypto::SystemRandom random;
    test::TemporaryFolder folder;
    storage::FolderStorage files{path("pki")};
    test::LogBook log;
};

using Names = std::vector<std::string>;

} // namespace

TEST_CASE("a damaged list of roles: the last good copy counts, also after another damage")
{
    Place place;
    {
        administration::RoleList roles{place.files, "roles.json"};
        REQUIRE(roles.set_endpoints_exclude("Operator", false));
    }
    place.start();
    const std::string good = place.content("roles.json");
    CHECK(place.left_of({"Operator", "Engineer"}) == Names{"Engineer"});

    for (const std::string damage : {"", "{\"version\":1", "[]"}) {
        place.put("roles.json", damage);
        place.start();
        CHECK(place.content("roles.json") == good);
        CHECK(place.content("roles.json.refused") == damage);
        CHECK(place.log.text.find("roles.json") != std::string::npos);
        CHECK(place.log.text.find(
                  "which is kept beside it as .refused, and its last good copy is used") !=
              std::string::npos);
        CHECK(place.left_of({"Operator", "Engineer"}) == Names{"Engineer"});
    }
    place.start();
    CHECK(place.log.text.find("refused") == std::string::npos);
}

TEST_CASE("a damaged list of roles without a good copy: all roles but SecurityAdmin are closed")
{
    Place place;
    place.put("roles.json", "damage");
    SECTION("there was no list") {}
    SECTION("the copy is damaged, too")
    {
        place.put("taken-over/roles.json", "damage");
    }
    SECTION("the copy is no list of roles")
    {
        place.put("roles.json", R"({"version":1,"roles":[7]})");
        REQUIRE(TakenOverFiles{place.files}.keep_copy("roles.json"));
    }
    place.start();
    CHECK(place.log.text.find("every role but SecurityAdmin is closed until an administrator opens "
                              "it") != std::string::npos);
    CHECK(place.left_of({"Operator", "Observer", "SecurityAdmin", "ConfigureAdmin"}) ==
          Names{"SecurityAdmin"});
    place.start(); // and stay so
    CHECK(place.left_of({"Operator", "SecurityAdmin"}) == Names{"SecurityAdmin"});
}

TEST_CASE("a damaged list of users: the last good copy counts, or none of them")
{
    Place place;
    const std::string list = R"({"version":1,"users":[]})";
    place.put("users.json", list);
    place.start();
    place.put("users.json", "damage");
    place.start();
    CHECK(place.content("users.json") == list);
    CHECK(place.content("users.json.refused") == "damage");
    place.put("users.json", "damage");
    place.put("taken-over/users.json", "damage");
    place.start();
    CHECK(place.content("users.json") == "none");
    CHECK(place.log.text.find("which is kept beside it as .refused and is not used") !=
          std::string::npos);
}

} // namespace damaged_lists_test
