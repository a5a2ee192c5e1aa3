#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/core/log.hpp>
#include <busbar/harness/modbus_responder.hpp>
#include <busbar/harness/slmp_responder.hpp>
#include <busbar/net/device_driver.hpp>

#include "command_line/program_options.hpp"
#include "gateway.hpp"
#include "plc_thread.hpp"

namespace {

using namespace busbar;
using namespace busbar::backend;

struct Choices {
    std::size_t variables{1'000};
    std::size_t cycles{50};
    /// Every one of so many registers is a variable.
    std::size_t apart{2};
    std::size_t under_way{4};
};

TimePoint now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

double processor_us()
{
    ::timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

[[noreturn]] void give_up(const std::string& why)
{
    std::fprintf(stderr, "busbar-backend-bench: %s\n", why.c_str());
    std::exit(1);
}

/// Reads all points once in each cycle, one cycle after the other, and prints a row.
void measure(const char* name, const Choices& choices, const std::vector<DevicePoint>& points,
             std::uint16_t port, std::unique_ptr<DeviceProtocol> protocol)
{
    NullLog log;
    Device device{{.name = name, .host = "127.0.0.1", .port = port}, std::move(protocol), log};
    net::DeviceLoop loop{log};
    loop.add(device);
    constexpr std::chrono::seconds patience{60};
    if (!loop.run_until([&] { return device.state() == DeviceState::Online; }, patience)) {
        give_up(device.trouble());
    }
    std::vector<PlanAddress> addresses;
    std::ranges::transform(points, std::back_inserter(addresses),
                           [](const DevicePoint& point) { return point.address; });
    std::vector<double> times;
    const auto requests = device.plan_counters().requests;
    const double begin = processor_us();
    for (std::size_t i = 0; i < choices.cycles; ++i) {
        const TimePoint start = now();
        if (const auto batch = device.read(addresses, start); !batch) {
            give_up("the read is refused");
        }
        std::optional<PlanResult> result;
        if (!loop.run_until([&] { return (result = device.next_result()).has_value(); },
                            patience)) {
            give_up("there is no answer");
        }
        for (std::size_t j = 0; j < points.size(); ++j) {
            if (!read_point(points[j], result->words_of(result->values[j]))) {
                give_up("a value is missing");
            }
        }
        times.push_back(std::chrono::duration<double, std::milli>(now() - start).count());
    }
    const double processor = processor_us() - begin;
    std::ranges::sort(times);
    const double median = times[times.size() / 2];
    std::printf("%-28s %10.1f %12.0f %10.3f %10.3f %12.3f\n", name,
                static_cast<double>(device.plan_counters().requests - requests) /
                    static_cast<double>(choices.cycles),
                static_cast<double>(points.size()) / median * 1e3, times.front(), median,
                processor / static_cast<double>(choices.cycles * points.size()));
    std::fflush(stdout);
}

std::vector<DevicePoint> points_of(const Choices& choices, const char* prefix, const auto& parse)
{
    std::vector<DevicePoint> points;
    for (std::size_t i = 0; i < choices.variables; ++i) {
        const auto point = parse(prefix + std::to_string(i * choices.apart));
        if (!point) {
            give_up(text(point.error()));
        }
        points.push_back(*point);
    }
    return points;
}

void measure_modbus(const char* name, const Choices& choices, const ModbusProtocolOptions& options)
{
    const auto points = points_of(
        choices, "holding:", [](const std::string& text) { return parse_modbus_point(text); });
    harness::ModbusDevice device;
    harness::ModbusResponder responder{device};
    bench::PlcThread plc{responder};
    plc.start();
    measure(name, choices, points, plc.port(), make_modbus_protocol(options, points));
}

void measure_slmp(const char* name, const Choices& choices, const SlmpProtocolOptions& options)
{
    const auto points =
        points_of(choices, "D", [](const std::string& text) { return parse_slmp_point(text); });
    harness::SlmpResponder responder;
    responder.add_devices("D", 65'536);
    bench::PlcThread plc{responder};
    plc.start();
    measure(name, choices, points, plc.port(), make_slmp_protocol(options, points));
}

int run(const Choices& choices)
{
    std::printf("%zu words, each %zu apart, read in %zu cycles; %zu requests under way\n",
                choices.variables, choices.apart, choices.cycles, choices.under_way);
    std::printf("%-28s %10s %12s %10s %10s %12s\n", "", "requests", "values/s", "least ms",
                "median ms", "us a value");
    ModbusProtocolOptions modbus;
    modbus.client.max_under_way = choices.under_way;
    measure_modbus("modbus", choices, modbus);
    modbus.max_gap = 0;
    measure_modbus("modbus, no gaps read", choices, modbus);
    modbus.max_read = 1;
    measure_modbus("modbus, a request each", choices, modbus);
    SlmpProtocolOptions slmp;
    slmp.client.max_under_way = choices.under_way;
    measure_slmp("slmp", choices, slmp);
    slmp.max_gap = 0;
    measure_slmp("slmp, no gaps read", choices, slmp);
    slmp.max_words = 1;
    measure_slmp("slmp, a request each", choices, slmp);
    return 0;
}

CLI::App* add_gateway(CLI::App& app, bench::GatewayOptions& options)
{
    CLI::App* const gateway = app.add_subcommand(
        "gateway", "Reads simulated PLCs through an OPC UA server in front of them: our own, and "
                   "those of others.");
    gateway->add_option("--variables", options.variables, "registers that are Variables")
        ->check(CLI::Range(2, 30'000))
        ->capture_default_str();
    gateway->add_option("--reads", options.reads, "of one value; a tenth as many of all")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    gateway->add_option("--seconds", options.seconds, "of the Subscription")
        ->check(CLI::Range(1, 3'600))
        ->capture_default_str();
    gateway->add_option("--under-way", options.under_way, "requests at a time, of our own gateway")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    gateway->add_option("--peer", options.peers,
                        "a command that serves holding registers of the Modbus TCP device at port "
                        "{plc} of this machine as an OPC UA server at port {port}, without "
                        "security; may be repeated");
    gateway
        ->add_option("--peer-node", options.peer_node,
                     "NodeId of its Variables, {} stands for the register")
        ->capture_default_str();
    return gateway;
}

} // namespace

int main(int argc, char** argv)
{
    Choices choices;
    CLI::App app{
        "Reads words of simulated PLCs over loopback, with what the plan of requests saves "
        "and without."};
    app.add_option("--variables", choices.variables, "words")
        ->check(CLI::Range(1, 30'000))
        ->capture_default_str();
    app.add_option("--cycles", choices.cycles, "reads of all of them")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    app.add_option("--apart", choices.apart, "registers from one to the next")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    app.add_option("--under-way", choices.under_way, "requests at a time")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command_line::add_program_options(app, "busbar-backend-bench");
    bench::GatewayOptions gateways;
    const CLI::App* const gateway = add_gateway(app, gateways);
    CLI11_PARSE(app, argc, argv);
    if (gateway->parsed()) {
        return bench::measure_gateways(gateways);
    }
    if (choices.variables * choices.apart > 65'536) {
        give_up("--variables times --apart is more than 65,536 registers");
    }
    return run(choices);
}
