#include "failure_cases.hpp"
#include "server/rights/role_permissions.hpp"
#include "support/failing_worlds.hpp"

namespace user_change_failure_test {

/// A session that changes to another user while there is no memory.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Items of two Variables that only one role may read.
struct GuardedWorld : FailureFixture {
    GuardedWorld()
    {
        model::AddressSpace& space = server.address_space();
        for (const char* const name : {"level", "speed"}) {
            model::NodeAccess access;
            RolePermissionType permission;
            permission.role_id = NodeId{0, id::WellKnownRole_ConfigureAdmin};
            permission.permissions = PermissionType{server::detail::all_permissions};
            access.role_permissions.push_back(permission);
            space.set_node_access(space.find(own(name)), access);
        }
        monitor(subscribe());
        pass(100ms, client);
    }
    /// How often a value is reported that another writes now.
    [[nodiscard]] int leaks(std::int32_t written)
    {
        WriteRequest request;
        request.nodes_to_write.resize(2);
        request.nodes_to_write[0].node_id = own("level");
        request.nodes_to_write[1].node_id = own("speed");
        for (WriteValue& value : request.nodes_to_write) {
            value.attribute_id = 13;
            value.value.value = written;
        }
        REQUIRE(ask(other, asking<WriteResponse>(request)) == status::Good);
        int found = 0;
        for (const MonitoredItemNotification& one : reported()) {
            found += one.value.value == Variant{written} ? 1 : 0;
        }
        return found;
    }
};

bool fail_once(std::size_t k, std::size_t most)
{
    GuardedWorld world;
    world.users.everybody.roles.clear();
    ActivateSessionRequest request;
    request.user_identity_token = TestClient::anonymous();
    const FailureCase asked = asking<ActivateSessionResponse>(request);
    auto [answer, has_failed] = world.attempt(asked, k, most);
    INFO("allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    // Until it is asked again it is one user's or the other's.
    if (world.ask(world.client, failing::read(world)) != status::Good) {
        CHECK(world.leaks(8) == 0);
    }
    if (answer != status::Good) {
        answer = world.ask(world.client, asked);
        CHECK(answer == status::Good);
    }
    CHECK(world.leaks(7) == 0);
    return has_failed;
}

bool fail_expiry(std::size_t k, std::size_t most)
{
    GuardedWorld world;
    world.users.everybody.valid_until = {world.wall_clock.time.ticks + DateTime::ticks_per_second};
    ActivateSessionRequest request;
    request.user_identity_token = TestClient::anonymous();
    REQUIRE(world.ask(world.client, asking<ActivateSessionResponse>(request)) == status::Good);
    world.users.everybody.roles.clear();
    world.users.everybody.valid_until = {};
    fail_allocation(k, most);
    world.pass(1100ms, world.client);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK(world.leaks(7) == 0);
    return has_failed;
}

} // namespace

TEST_CASE("who a session was given to in the end reads by that user's rights only")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("ActivateSession", [&](std::size_t k) { return fail_once(k, most); });
}

TEST_CASE("nothing is read any more by the rights of a user whose time is over")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("the end of a user", [&](std::size_t k) { return fail_expiry(k, most); });
}

} // namespace user_change_failure_test
