#include <catch2/catch.hpp>

#include <functional>
#include <map>

#include <busbar/administration/role_list.hpp>
#include <busbar/administration/user_list.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "support/effort.hpp"

namespace storage_power_cut_test {

// Every persisted change, cut at every byte and call, and on a medium that is full, protected or
// away: there is the state before it or the one after it, in the file and in what counts.

using namespace busbar;
using administration::RoleList;
using administration::User;
using administration::UserChange;
using administration::UserList;

namespace {

/// Chance that costs a hash nothing: what is tested here is not the hash.
const std::string password = "correct horse 1";

struct World {
    World()
    {
        REQUIRE(users.load());
        REQUIRE(roles.load());
    }

    /// What is in force, and what a program would find that starts now.
    [[nodiscard]] std::string in_force() const { return text_of(users, roles); }
    [[nodiscard]] std::string stored()
    {
        server::PasswordUsers others;
        UserList other_users{storage, "users.json", {}, others};
        RoleList other_roles{storage, "roles.json"};
        REQUIRE(other_users.load());
        REQUIRE(other_roles.load());
        return text_of(other_users, other_roles);
    }
    /// Their bytes, which is quicker than to read what they say.
    [[nodiscard]] std::vector<std::byte> files()
    {
        std::vector<std::byte> all;
        for (const char* name : {"users.json", "roles.json"}) {
            const auto bytes = read_file(storage, name, 1U << 20U);
            REQUIRE(bytes);
            all.insert(all.end(), bytes->begin(), bytes->end());
        }
        return all;
    }
    [[nodiscard]] static std::string text_of(const UserList& users, const RoleList& roles)
    {
        std::string text;
        for (const User& user : users.users()) {
            text += user.name + " " + std::to_string(user.configuration) + " " + user.description;
            for (const std::string& role : user.roles) {
                text += " " + role;
            }
            text += "\n";
        }
        for (const administration::RoleRules& role : roles.roles()) {
            text += role.name + " " + std::to_string(role.identities.size()) + " " +
                    std::to_string(role.applications.size()) + " " +
                    std::to_string(role.endpoints.size()) +
                    (role.applications_exclude ? "" : " only") +
                    (role.endpoints_exclude ? "" : " only") + "\n";
        }
        return text;
    }

    storage::MemoryStorage storage;
    crypto::SystemRandom random;
    server::PasswordUsers passwords;
    UserList users{storage, "users.json", {}, passwords};
    RoleList roles{storage, "roles.json"};
};

/// A start afterwards removes what is left of the file that was being written.
void check_leftovers(storage::MemoryStorage& storage)
{
    NullLog silence;
    crypto::CertificateStore store{storage, {}, silence};
    REQUIRE(store.create());
    CHECK(storage.unfinished().empty());
}

using Change = std::function<bool(World&)>;

User named(const char* name)
{
    User user;
    user.name = name;
    user.roles = {"SecurityAdmin"};
    return user;
}

IdentityMappingRuleType rule(const char* user)
{
    return {IdentityCriteriaType::UserName, String{user}};
}

void fill(World& world)
{
    // A hash takes tens of milliseconds, and there are hundreds of cuts.
    static const std::string hash = [] {
        World once;
        REQUIRE(once.users.add(named("x"), password, once.random));
        return once.users.find("x")->password_hash;
    }();
    const std::string file = R"({"version":1,"users":[{"name":"ann","password_hash":")" + hash +
                             R"(","configuration":0,"description":"","roles":["SecurityAdmin"]},)"
                             R"({"name":"pat","password_hash":")" +
                             hash +
                             R"(","configuration":0,"description":"","roles":["SecurityAdmin"]}]})";
    REQUIRE(world.storage.replace("users.json", std::as_bytes(std::span{file}), FileAccess::Owner));
    REQUIRE(world.users.load());
    REQUIRE(world.roles.add("Fitter", ""));
    REQUIRE(world.roles.add_identity("Fitter", rule("pat")));
    REQUIRE(world.roles.add_application("Fitter", "urn:a"));
    REQUIRE(world.roles.add_endpoint("Fitter", EndpointType{}));
}

const std::map<std::string, Change> changes{
    {"disable a user",
     [](World& world) {
         UserChange change;
         change.configuration = administration::user_bit::disabled;
         change.description = "on leave";
         return !!world.users.modify("pat", change, world.random);
     }},
    {"remove a user", [](World& world) { return !!world.users.remove("pat"); }},
    {"add a role", [](World& world) { return !!world.roles.add("Welder", ""); }},
    {"remove a role", [](World& world) { return !!world.roles.remove("Fitter"); }},
    {"add an identity",
     [](World& world) { return !!world.roles.add_identity("Fitter", rule("sam")); }},
    {"remove an identity",
     [](World& world) { return !!world.roles.remove_identity("Fitter", rule("pat")); }},
    {"add an application",
     [](World& world) { return !!world.roles.add_application("Fitter", "urn:b"); }},
    {"remove an application",
     [](World& world) { return !!world.roles.remove_application("Fitter", "urn:a"); }},
    {"remove an endpoint",
     [](World& world) { return !!world.roles.remove_endpoint("Fitter", EndpointType{}); }},
    {"applications exclude",
     [](World& world) { return !!world.roles.set_applications_exclude("Fitter", false); }},
    {"endpoints exclude",
     [](World& world) { return !!world.roles.set_endpoints_exclude("Fitter", false); }},
};

} // namespace

TEST_CASE("power cut: a change of users or roles is whole or not done", "[power]")
{
    for (const auto& [what, change] : changes) {
        INFO(what);
        World world;
        fill(world);
        const std::string before = world.in_force();
        REQUIRE(world.stored() == before);
        const std::vector<std::byte> files = world.files();
        bool is_done = false;
        const test::Turns cuts{what, 5};
        for (std::size_t step = cuts.first; !is_done && step < 5'000; step += cuts.stride) {
            world.storage.cut_power_after(step);
            is_done = change(world);
            world.storage.restore_power();
            if (!is_done && (world.in_force() != before || world.files() != files)) {
                FAIL("half of it is done after " << step << " steps");
            }
        }
        REQUIRE(is_done);
        CHECK_FALSE(world.storage.unfinished().empty());
        check_leftovers(world.storage);
        CHECK(world.in_force() != before);
        CHECK(world.stored() == world.in_force());
    }
}

TEST_CASE("a medium that is full, protected or away refuses the change and nothing else", "[power]")
{
    using Fault = std::function<void(storage::MemoryStorage&, bool)>;
    const std::map<std::string, Fault> faults{
        {"full", [](storage::MemoryStorage& storage,
                    bool is_on) { storage.set_capacity(is_on ? 10 : UINT64_MAX); }},
        {"protected",
         [](storage::MemoryStorage& storage, bool is_on) { storage.set_protected(is_on); }},
        {"away", [](storage::MemoryStorage& storage, bool is_on) { storage.set_away(is_on); }},
    };
    for (const auto& [name, set] : faults) {
        for (const auto& [what, change] : changes) {
            INFO(what << ", " << name);
            World world;
            fill(world);
            const std::string before = world.in_force();
            set(world.storage, true);
            CHECK_FALSE(change(world));
            CHECK(world.in_force() == before);
            set(world.storage, false);
            CHECK(world.stored() == before);
            CHECK(change(world));
            CHECK(world.stored() == world.in_force());
        }
    }
}

} // namespace storage_power_cut_test
