#include <catch2/catch.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>
#include <utility>

#include <busbar/product/configuration.hpp>

#include "programs/controller_administrator.hpp"
#include "programs/controller_site.hpp"
#include "programs/forked_controller.hpp"

namespace sent_program_test {

using namespace busbar::test;

namespace {

/// A controller whose administrator sends it programs while its media fail.
struct Sending {
    Sending()
    {
        site.settings[mode_setting] = in_program;
        site.write_configuration();
        start();
        site.keep_own_certificate();
    }
    /// After a loss of power.
    void start()
    {
        chief.disconnect();
        controller.kill();
        controller.calm();
        REQUIRE(controller.start() == ForkedController::Start::Serves);
    }
    /// Sends it another program; after `from` calls that change the disk all fail.
    Outcome send(std::uint64_t from)
    {
        sent = site.new_program(true);
        failing_disk::Orders& orders = controller.orders();
        orders.error = EROFS;
        orders.fails_from = orders.calls + from;
        orders.fails_until = failing_disk::Orders::never;
        return chief.program("download sent.st", sent.text);
    }
    ControllerReport report()
    {
        for (int i = 0; i < 20; ++i) {
            if (auto now = chief.report(setting_names(), {"Total"})) {
                return *std::move(now);
            }
        }
        FAIL(chief.why_not());
        return {};
    }
    /// Waits until it has taken the program or says why not.
    ControllerReport answer()
    {
        ControllerReport now = report();
        while (now.program != sent.text && now.pending_changes.empty()) {
            now = report();
        }
        return now;
    }
    static bool says_stored(const ControllerReport& now)
    {
        return std::ranges::any_of(now.pending_changes, [](const std::string& each) {
            return each.find("it is stored all the same") != std::string::npos;
        });
    }

    busbar::harness::Chance chance{1, 3};
    ControllerSite site{chance};
    ForkedController controller{busbar::product::Configuration{.file = site.file},
                                site.log().string()};
    ControllerAdministrator chief{site.ports, (site.folder.path / "client").string(),
                                  ControllerSite::password};
    MachineText sent;
};

} // namespace

TEST_CASE("a program that is refused because media fail does not come later, or this is told")
{
    Sending sending;
    int refused = 0;
    for (std::uint64_t from = 0; from < 10; ++from) {
        CAPTURE(from);
        const auto value = static_cast<std::int32_t>(100 + from);
        REQUIRE(sending.chief.write("Total", value) == Outcome::Done);
        const Outcome outcome = sending.send(from);
        const ControllerReport now = outcome == Outcome::Done ? sending.answer() : sending.report();
        CAPTURE(outcome, now.pending_changes, now.program, sending.sent.text);
        refused += now.program != sending.sent.text ? 1 : 0;
        sending.start();
        const std::string then = sending.report().program;
        CHECK((then == now.program || (Sending::says_stored(now) && then == sending.sent.text)));
    }
    CHECK(refused > 0);
}

} // namespace sent_program_test
