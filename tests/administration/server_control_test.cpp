#include <chrono>

#include <busbar/types/enumerations.hpp>

#include "managed_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct Control : ManagedFixture {
    std::string_view request(TestClient& client, ServerState state, std::uint32_t seconds = 10,
                             bool restarts = false, const char* reason = "maintenance")
    {
        const DateTime tomorrow{today.ticks + 86'400 * DateTime::ticks_per_second};
        return name(
            call(client, NodeId{0, id::Server}, NodeId{0, id::Server_RequestServerStateChange},
                 {Variant{static_cast<std::int32_t>(state)}, Variant{tomorrow}, Variant{seconds},
                  Variant{LocalizedText{"en", reason}}, Variant{restarts}})
                .status_code);
    }
};

} // namespace

TEST_CASE_METHOD(Control, "server control: an administrator stops the server",
                 "[unit:Base Info RequestServerStateChange Method]")
{
    auto admin = log_in();
    CHECK(request(admin, ServerState::Running) == "Good");
    CHECK(request(admin, ServerState::Suspended) == "Bad_NotSupported");
    CHECK(request(admin, ServerState::Shutdown, 10, true) == "Bad_NotSupported");
    CHECK(request(admin, ServerState::Shutdown, 86'401) == "Bad_OutOfRange");
    CHECK(stops == 0);
    CHECK(request(admin, ServerState::Shutdown) == "Good");
    CHECK(stops == 1);
    CHECK(
        read(admin, id::Server_ServerStatus_SecondsTillShutdown).value.value_or<std::uint32_t>(0) ==
        10);
    CHECK(read(admin, id::Server_ServiceLevel).value == Variant{std::uint8_t{0}});
    CHECK(read(admin, id::Server_EstimatedReturnTime).value.value_or<DateTime>({}) > today);
    advance(10s);
    CHECK(admin.is_closed());
    CHECK(log.text.find("maintenance") != std::string::npos);
}

TEST_CASE_METHOD(Control, "server control: is not for everybody")
{
    REQUIRE(user_list.add({"pat", {}, 0, {}, {"Engineer"}}, "patience is all", random));
    auto pat = log_in("pat", "patience is all");
    CHECK(request(pat, ServerState::Shutdown).starts_with("Bad_"));
    CHECK(stops == 0);
}
