#include <chrono>
#include <cstddef>
#include <span>

#include "managed_fixture.hpp"

namespace server_reset_test {

// Part 12, 7.10.13.

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct Reset : ManagedFixture {
    StatusCode ask(TestClient& client)
    {
        return call(client, NodeId{0, id::ServerConfiguration},
                    NodeId{0, id::ServerConfiguration_ResetToServerDefaults}, {})
            .status_code;
    }
    std::size_t trusted() { return count(applications, crypto::StoreList::Trusted); }
};

} // namespace

TEST_CASE_METHOD(Reset,
                 "reset: what administrators changed is forgotten, and the program starts again")
{
    auto admin = log_in();
    REQUIRE(storage.entry("users.json"));
    CHECK(ask(admin) == status::Good);
    CHECK_FALSE(storage.entry("users.json"));
    CHECK_FALSE(storage.entry("roles.json"));
    CHECK(trusted() == 0);
    CHECK(restarts == 1);
    CHECK(stops == 0);
    // Clients are warned, and have time to receive the answer.
    CHECK(
        read(admin, id::Server_ServerStatus_SecondsTillShutdown).value.value_or<std::uint32_t>(0) ==
        2);
    CHECK(read(admin, id::Server_ServerStatus_ShutdownReason)
              .value.value_or<LocalizedText>({})
              .text.view()
              .find("may not be accepted") != std::string_view::npos);
    advance(2s);
    CHECK(admin.is_closed());
    CHECK(log.text.find("SettingsChanged by user \"admin\"") != std::string::npos);
}

TEST_CASE_METHOD(Reset, "reset: is for SecurityAdmin, and over a channel that is signed")
{
    REQUIRE(user_list.add({"pat", {}, 0, {}, {"Engineer", "ConfigureAdmin"}}, "patience is all",
                          random));
    auto pat = log_in("pat", "patience is all");
    CHECK(ask(pat).is_bad());
    CHECK(storage.entry("users.json"));
    CHECK(stops == 0);
}

TEST_CASE_METHOD(Reset, "reset: one that fails changes nothing")
{
    auto admin = log_in();
    storage.set_protected(true);
    CHECK(ask(admin) == status::Bad_ResourceUnavailable);
    storage.set_protected(false);
    CHECK(stops == 0);
    CHECK(storage.entry("users.json"));
    CHECK(trusted() == 1);
    CHECK(log.text.find("cannot be removed") != std::string::npos);
    CHECK(stops + restarts == 0);
    CHECK(ask(admin) == status::Good);
    CHECK(restarts == 1);
}

TEST_CASE("reset: a power cut leaves all of it or nothing")
{
    std::size_t whole = 0;
    std::size_t nothing = 0;
    for (std::size_t steps = 0;; ++steps) {
        storage::MemoryStorage storage;
        for (const char* folder : {"trusted/certs", "own/certs"}) {
            REQUIRE(storage.make_folder(folder, FileAccess::Owner));
        }
        const auto text = std::as_bytes(std::span{"0123456789"});
        for (const char* name : {"users.json", "trusted/certs/a.der", "own/certs/own.der"}) {
            REQUIRE(storage.replace(name, text, FileAccess::Owner));
        }
        static constexpr std::array<std::string_view, 2> names{"users.json", "roles.json"};
        static constexpr std::array<std::string_view, 3> folders{"trusted/certs", "own/certs",
                                                                 "rejected/certs"};
        storage.cut_power_after(steps);
        const bool is_done = administration::remove_files(storage, names, folders).has_value() &&
                             storage.free_space().has_value(); // there is power
        storage.restore_power();
        REQUIRE(administration::finish_changes(storage));
        const std::size_t left = std::size_t{storage.entry("users.json").has_value()} +
                                 std::size_t{storage.entry("trusted/certs/a.der").has_value()} +
                                 std::size_t{storage.entry("own/certs/own.der").has_value()};
        INFO(steps);
        CHECK((left == 0 || left == 3));
        ++(left == 0 ? whole : nothing);
        if (is_done) {
            CHECK(left == 0);
            break;
        }
    }
    CHECK(whole > 1);
    CHECK(nothing > 1);
}

} // namespace server_reset_test
