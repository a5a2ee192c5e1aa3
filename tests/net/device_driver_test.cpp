#include <busbar/net/device_driver.hpp>

#include <array>
#include <memory>
#include <thread>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/ip/udp.hpp>
#include <asio/write.hpp>
#include <catch2/catch.hpp>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/harness/log_book.hpp>
#include <busbar/harness/modbus_responder.hpp>
#include <busbar/harness/slmp_responder.hpp>

namespace device_driver_test {

// Devices over sockets of this machine.

using namespace busbar;
using namespace busbar::backend;
using namespace std::chrono_literals;
using asio::ip::tcp;
using asio::ip::udp;

namespace {

TimePoint now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

/// A PLC on a port of its own, with one connection at a time, on a thread until it is destroyed.
class Plc {
public:
    explicit Plc(std::uint16_t port = 0)
        : acceptor_{context_, tcp::endpoint{asio::ip::address_v4::loopback(), port}}
    {
        for (auto& each : device_.table(ModbusTable::HoldingRegister)) {
            each = 17;
        }
        accept();
        thread_ = std::thread{[this] { context_.run(); }};
    }
    Plc(const Plc&) = delete;
    Plc& operator=(const Plc&) = delete;
    ~Plc()
    {
        context_.stop();
        thread_.join();
    }
    [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

private:
    struct Line {
        explicit Line(tcp::socket s, harness::ModbusDevice& device)
            : socket{std::move(s)}, responder{device}
        {
        }

        tcp::socket socket;
        harness::ModbusResponder responder;
        std::array<std::byte, 4'096> buffer{};
    };

    void accept()
    {
        acceptor_.async_accept([this](std::error_code error, tcp::socket socket) {
            if (!error) {
                receive(std::make_shared<Line>(std::move(socket), device_));
                accept();
            }
        });
    }
    void receive(const std::shared_ptr<Line>& line)
    {
        line->socket.async_read_some(
            asio::buffer(line->buffer), [this, line](std::error_code error, std::size_t size) {
                if (error) {
                    return;
                }
                static_cast<void>(line->responder.feed(std::span{line->buffer}.first(size), now()));
                const auto out = line->responder.output();
                asio::write(line->socket, asio::buffer(out.data(), out.size()), error);
                line->responder.consume(out.size());
                receive(line);
            });
    }

    asio::io_context context_;
    harness::ModbusDevice device_;
    tcp::acceptor acceptor_;
    std::thread thread_;
};

std::unique_ptr<Device> modbus_device(std::uint16_t port, LogSink& log)
{
    const auto point = parse_modbus_point("holding:5");
    REQUIRE(point);
    return std::make_unique<Device>(
        DeviceConfig{.name = "press", .host = "127.0.0.1", .port = port, .first_pause = 10ms},
        make_modbus_protocol({}, {&*point, 1}), log);
}

/// The status and word of one address.
std::pair<StatusCode, std::uint16_t> read(net::DeviceLoop& loop, Device& device,
                                          const DevicePoint& point)
{
    if (const auto batch = device.read({&point.address, 1}, now()); !batch) {
        return {batch.error(), 0};
    }
    std::optional<PlanResult> result;
    REQUIRE(loop.run_until([&] { return (result = device.next_result()).has_value(); }, 60s));
    const PlanValue& value = result->values.front();
    return {value.status, result->words_of(value).front()};
}

bool come(net::DeviceLoop& loop, const Device& device, DeviceState state)
{
    return loop.run_until([&] { return device.state() == state; }, 60s);
}

} // namespace

TEST_CASE("a device is connected, and again when its PLC was away", "[net]")
{
    harness::LogBook log;
    auto plc = std::make_unique<Plc>();
    const std::uint16_t port = plc->port();
    const auto device = modbus_device(port, log);
    const DevicePoint point = *parse_modbus_point("holding:5");
    net::DeviceLoop loop{log};
    loop.add(*device);
    REQUIRE(come(loop, *device, DeviceState::Online));
    CHECK(read(loop, *device, point) == std::pair{StatusCode{}, std::uint16_t{17}});
    plc.reset();
    REQUIRE(come(loop, *device, DeviceState::Waiting));
    CHECK(read(loop, *device, point).first == StatusCode{status::Bad_NoCommunication});
    CHECK_FALSE(device->trouble().empty());
    plc = std::make_unique<Plc>(port);
    REQUIRE(come(loop, *device, DeviceState::Online));
    CHECK(read(loop, *device, point) == std::pair{StatusCode{}, std::uint16_t{17}});
    CHECK(device->counters().connections == 2);
}

TEST_CASE("a device that nobody answers for is waited for, with the reason told", "[net]")
{
    harness::LogBook log;
    const std::uint16_t port = Plc{}.port();
    const auto device = modbus_device(port, log);
    net::DeviceLoop loop{log};
    loop.add(*device);
    CHECK(loop.run_until([&] { return log.contains("press: no connection: "); }, 60s));
    CHECK(device->state() != DeviceState::Online);
}

TEST_CASE("a PLC is asked by datagrams, and one that is lost is late only", "[net]")
{
    harness::LogBook log;
    asio::io_context context;
    udp::socket socket{context, udp::endpoint{asio::ip::address_v4::loopback(), 0}};
    harness::SlmpResponder plc{{.is_datagram = true}};
    plc.add_devices("D", 100);
    plc.set("D7", 42);
    std::thread thread{[&] {
        std::array<std::byte, 4'096> buffer;
        udp::endpoint from;
        std::error_code error;
        for (std::size_t size = 1; size != 0 && !error;) {
            size = socket.receive_from(asio::buffer(buffer), from, 0, error);
            plc.feed(std::span{buffer}.first(size), now());
            const auto out = plc.output();
            if (!out.empty()) {
                socket.send_to(asio::buffer(out.data(), out.size()), from);
                plc.consume(out.size());
            }
        }
    }};
    SlmpProtocolOptions options;
    options.client.is_datagram = true;
    options.client.timeout = 200ms;
    const DevicePoint point = *parse_slmp_point("D7");
    {
        Device device{{.name = "mixer",
                       .host = "127.0.0.1",
                       .port = socket.local_endpoint().port(),
                       .is_datagram = true,
                       .first_pause = 10ms},
                      make_slmp_protocol(options, {&point, 1}),
                      log};
        net::DeviceLoop loop{log};
        loop.add(device);
        REQUIRE(come(loop, device, DeviceState::Online));
        CHECK(device.identity().product == "R08CPU");
        CHECK(read(loop, device, point) == std::pair{StatusCode{}, std::uint16_t{42}});
    }
    udp::socket ends{context, udp::v4()};
    ends.send_to(asio::buffer("", 0), socket.local_endpoint());
    thread.join();
}

} // namespace device_driver_test
