#include <catch2/catch.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <busbar/backend/device.hpp>
#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/slmp_message.hpp>

namespace line_test {

using namespace busbar;
using namespace busbar::backend;
using namespace std::chrono_literals;

namespace {

constexpr std::uint16_t locked = 0xC201;
constexpr std::uint16_t wrong_password = 0xC810;

SlmpProtocolOptions with_password()
{
    SlmpProtocolOptions options;
    options.password = "secret1";
    return options;
}

/// A device that sends a remote password, and the time.
struct Locked {
    explicit Locked(DeviceConfig config = {.name = "press"})
        : device{std::move(config), make_slmp_protocol(with_password(), {}), log}
    {
    }
    /// Connects, and answers the password with this end code.
    void refuse(std::uint16_t end_code)
    {
        REQUIRE(device.wants_connection(now));
        device.connecting(now);
        device.connected(now);
        const std::vector<std::byte> frame{device.output().begin(), device.output().end()};
        device.consume(frame.size());
        const auto head = read_slmp_head(frame);
        REQUIRE((head && *head));
        const auto request = read_slmp_request(**head, frame);
        REQUIRE(request);
        REQUIRE(request->command == static_cast<std::uint16_t>(SlmpCommand::Unlock));
        SlmpAnswer answer{.end_code = end_code};
        answer.error = {(*head)->station, request->command, request->subcommand};
        const auto bytes = encode_slmp_answer(**head, *decode_slmp_request(*request), answer);
        REQUIRE(bytes);
        static_cast<void>(device.feed(*bytes, now));
        REQUIRE(device.is_closed());
        device.lost("closed", now);
        CHECK(device.state() == DeviceState::Waiting);
    }

    TimePoint now{1h};
    NullLog log;
    Device device;
};

} // namespace

TEST_CASE("a wrong remote password is sent again only after ten minutes, each time")
{
    Locked plc;
    for (int i = 0; i < 8; ++i) {
        plc.refuse(wrong_password);
        CHECK(plc.device.trouble() == "C810: the remote password is wrong; it is tried again after "
                                      "10 minutes, or at a restart");
        plc.now += 10min - 1ns;
        CHECK_FALSE(plc.device.wants_connection(plc.now));
        plc.now += 1ns;
        CHECK(plc.device.next_deadline() == plc.now);
    }
    CHECK(plc.device.counters().attempts == 8);
}

TEST_CASE("a pause that is configured to be longer is kept after a wrong remote password")
{
    Locked plc{{.name = "press", .first_pause = 1h, .longest_pause = 1h}};
    plc.refuse(wrong_password);
    CHECK(plc.device.next_deadline() - plc.now >= 45min); // shortened by up to a quarter
}

TEST_CASE("a port that is locked for another reason is tried again soon")
{
    Locked plc;
    plc.refuse(locked);
    CHECK(plc.device.trouble() == "C201: the port is locked by a remote password");
    CHECK(plc.device.next_deadline() - plc.now <= 500ms);
}

} // namespace line_test
