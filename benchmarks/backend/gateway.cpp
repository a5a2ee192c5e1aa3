#include "gateway.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <busbar/client/attributes.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/harness/modbus_responder.hpp>
#include <busbar/harness/slmp_responder.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/net/system.hpp>
#include <busbar/types/ids.hpp>

#include "../bench/process.hpp"
#include "own_gateway.hpp"
#include "plc_thread.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

constexpr auto cycle = 200ms;

TimePoint now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

double ms_since(TimePoint begin)
{
    return std::chrono::duration<double, std::milli>(now() - begin).count();
}

[[noreturn]] void give_up(const std::string& what, StatusCode status)
{
    std::fprintf(stderr, "busbar-backend-bench: %s: %s\n", what.c_str(),
                 std::string{name(status)}.c_str());
    std::exit(1);
}

double median(std::vector<double> numbers)
{
    std::ranges::sort(numbers);
    return numbers.empty() ? 0 : numbers[numbers.size() / 2];
}

std::string replaced(std::string text, const std::string& what, const std::string& by)
{
    for (std::size_t at = 0; (at = text.find(what)) != std::string::npos;) {
        text.replace(at, what.size(), by);
    }
    return text;
}

/// The requests that a simulated PLC has had, whose thread counts them.
using Requests = std::atomic<std::uint64_t>;

/// What a client sees of one gateway.
struct Figures {
    double state_us{0};
    double one_us{0};
    double one_age_ms{0};
    double all_ms{0};
    double requests_of_read{0};
    double requests_of_cycle{0};
    double values_per_second{0};
    double processor_percent{0};
};

/// A client of a gateway without security.
class GatewayClient {
public:
    GatewayClient(const std::string& url, std::string node, const GatewayOptions& options,
                  const Requests& requests)
        : options_{options}, node_{std::move(node)}, requests_{requests},
          environment_{.random = &random_,
                       .wall_clock = &wall_clock_,
                       .log = &log_,
                       .validator = &validator_},
          client_{config_of(url), environment_}
    {
    }

    void connect()
    {
        if (const auto connected = client_.connect(60s); !connected) {
            give_up("no session at the gateway", connected.error());
        }
        const TimePoint begin = now();
        while (read({node(0), node(options_.variables - 1)}).back().status.is_bad()) {
            if (now() - begin > 60s) {
                give_up("no value of the PLC", status::Bad_Timeout);
            }
            client_.run_for(100ms);
        }
    }
    Figures measure(pid_t process)
    {
        Figures figures;
        figures.state_us =
            time_of(options_.reads, {NodeId{0, id::Server_ServerStatus_State}}) * 1e3;
        ages_.clear();
        figures.one_us = time_of(options_.reads, {node(0)}) * 1e3;
        figures.one_age_ms = median(ages_);
        std::vector<NodeId> all;
        for (std::size_t i = 0; i < options_.variables; ++i) {
            all.push_back(node(i));
        }
        const std::size_t rounds = std::max<std::size_t>(options_.reads / 10, 1);
        const std::uint64_t before = requests_;
        figures.all_ms = time_of(rounds, all);
        figures.requests_of_read =
            static_cast<double>(requests_ - before) / static_cast<double>(rounds);
        subscribe(all, process, figures);
        client_.close();
        return figures;
    }

private:
    static client::ClientConfig config_of(const std::string& url)
    {
        client::ClientConfig config;
        config.endpoint_url = url;
        config.security.allows_none = true;
        config.reconnect.first = 200ms;
        config.reconnect.longest = 500ms;
        return config;
    }
    [[nodiscard]] NodeId node(std::size_t number) const
    {
        const std::string text = replaced(node_, "{}", std::to_string(number));
        return NodeId::parse(text).value_or(NodeId{});
    }
    std::vector<DataValue> read(const std::vector<NodeId>& nodes)
    {
        std::vector<ReadValueId> items;
        for (const NodeId& each : nodes) {
            items.push_back(client::attribute_of(each));
        }
        auto values = client_.wait_for<std::vector<DataValue>>(
            [&](auto done) { return client::read(client_.client(), std::move(items), done); });
        if (!values) {
            give_up("a Read", values.error());
        }
        return *std::move(values);
    }
    /// Milliseconds of a Read, the median of so many.
    double time_of(std::size_t times, const std::vector<NodeId>& nodes)
    {
        std::vector<double> all;
        for (std::size_t i = 0; i < times; ++i) {
            const TimePoint begin = now();
            const auto values = read(nodes);
            all.push_back(ms_since(begin));
            for (const DataValue& value : values) {
                if (value.status.is_bad()) {
                    give_up("a value", value.status);
                }
            }
            const auto age = wall_clock_.now().ticks - values.front().source_timestamp.ticks;
            ages_.push_back(static_cast<double>(age) / (DateTime::ticks_per_second / 1e3));
        }
        return median(all);
    }
    void subscribe(const std::vector<NodeId>& nodes, pid_t process, Figures& figures)
    {
        std::size_t values = 0;
        client::SubscriptionHandlers handlers;
        handlers.on_data = [&](std::span<const client::DataChange> changes) {
            values += changes.size();
        };
        std::vector<client::ItemSettings> items;
        for (const NodeId& each : nodes) {
            client::ItemSettings item;
            item.node = each;
            item.sampling_interval = cycle;
            items.push_back(std::move(item));
        }
        client::Subscriptions& subscriptions = client_.client().subscriptions();
        const auto subscription =
            subscriptions.create({.publishing_interval = cycle}, std::move(handlers));
        if (!subscription || !subscriptions.add_items(*subscription, std::move(items)) ||
            !client_.run_until([&] { return values >= nodes.size(); }, 60s)) {
            give_up("the Subscription", status::Bad_Timeout);
        }
        client_.run_for(2 * cycle);
        const std::uint64_t requests = requests_;
        const double processor = processor_time(process);
        values = 0;
        const TimePoint begin = now();
        client_.run_for(
            std::chrono::duration_cast<Duration>(std::chrono::duration<double>{options_.seconds}));
        const double seconds = ms_since(begin) / 1e3;
        const double cycles = seconds / std::chrono::duration<double>{cycle}.count();
        figures.requests_of_cycle = static_cast<double>(requests_ - requests) / cycles;
        figures.values_per_second = static_cast<double>(values) / seconds;
        figures.processor_percent = (processor_time(process) - processor) / seconds * 100;
        static_cast<void>(subscriptions.remove(*subscription)); // its handler ends with this call
        client_.run_for(cycle);
    }

    const GatewayOptions& options_;
    std::string node_;
    const Requests& requests_;
    net::SystemWallClock wall_clock_;
    crypto::SystemRandom random_;
    NullLog log_;
    crypto::InsecureAcceptAnyCertificate validator_;
    channel::ChannelEnvironment environment_;
    net::BlockingClient client_;
    std::vector<double> ages_;
};

void print_head(const GatewayOptions& options)
{
    std::printf("%zu registers; a Read of one and of all, and all of them at 200 ms, half of which "
                "change\n",
                options.variables);
    std::printf("%-24s %9s %9s %9s %9s %9s %9s %9s %9s\n", "", "state us", "one us", "age ms",
                "all ms", "requests", "a cycle", "values/s", "cpu %");
}

void print(const std::string& name, const Figures& figures)
{
    std::printf("%-24s %9.0f %9.0f %9.1f %9.2f %9.1f %9.1f %9.0f %9.1f\n", name.c_str(),
                figures.state_us, figures.one_us, figures.one_age_ms, figures.all_ms,
                figures.requests_of_read, figures.requests_of_cycle, figures.values_per_second,
                figures.processor_percent);
    std::fflush(stdout);
}

/// Calls `change` once in each cycle, whenever requests come.
class Program {
public:
    explicit Program(std::function<void()> change) : change_{std::move(change)} {}
    void step()
    {
        if (const TimePoint time = now(); time >= next_) {
            next_ = time + cycle / 2;
            change_();
        }
    }

private:
    std::function<void()> change_;
    TimePoint next_;
};

/// A simulated PLC with Modbus TCP, every other register of which counts.
class ModbusPlc {
public:
    explicit ModbusPlc(std::size_t registers)
        : program_{[this, registers] {
              const auto table = device_.table(backend::ModbusTable::HoldingRegister);
              for (std::size_t i = 0; i < registers; i += 2) {
                  ++table[i];
              }
          }}
    {
    }

    void start()
    {
        thread_.start([this] {
            program_.step();
            requests = device_.executed();
        });
    }
    [[nodiscard]] std::uint16_t port() const { return thread_.port(); }

    Requests requests{0};

private:
    harness::ModbusDevice device_;
    harness::ModbusResponder responder_{device_};
    Program program_;
    PlcThread<harness::ModbusResponder> thread_{responder_};
};

/// The same with SLMP.
class SlmpPlc {
public:
    explicit SlmpPlc(std::size_t registers)
        : program_{[this, registers] {
              ++count_;
              for (std::size_t i = 0; i < registers; i += 2) {
                  responder_.set("D" + std::to_string(i), count_);
              }
          }}
    {
        constexpr std::uint32_t special_registers = 4'096;
        responder_.add_devices("D", static_cast<std::uint32_t>(registers));
        responder_.add_devices("SD", special_registers);
    }

    void start()
    {
        thread_.start([this] {
            program_.step();
            requests = responder_.served();
        });
    }
    [[nodiscard]] std::uint16_t port() const { return thread_.port(); }

    Requests requests{0};

private:
    harness::SlmpResponder responder_;
    std::uint16_t count_{0};
    Program program_;
    PlcThread<harness::SlmpResponder> thread_{responder_};
};

template <typename Plc>
void measure_own(const std::string& name, const GatewayOptions& options, OwnGatewayOptions own)
{
    Plc plc{options.variables};
    own.variables = options.variables;
    own.under_way = options.under_way;
    own.plc_port = plc.port();
    const OwnGateway gateway{own}; // before the PLC's thread
    plc.start();
    GatewayClient client{gateway.url(), "ns=2;s=R{}", options, plc.requests};
    client.connect();
    print(name, client.measure(gateway.process()));
    // The gateway ends first, since the PLC's thread ends with its connection.
}

std::uint16_t free_port()
{
    harness::ModbusDevice device;
    harness::ModbusResponder responder{device};
    return PlcThread<harness::ModbusResponder>{responder}.port();
}

/// The gateway of others, which a command starts.
class PeerGateway {
public:
    PeerGateway(const std::string& command, std::uint16_t plc_port, std::uint16_t port)
    {
        const std::string line =
            "exec " + replaced(replaced(command, "{plc}", std::to_string(plc_port)), "{port}",
                               std::to_string(port));
        process_ = ::fork();
        if (process_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
            ::_exit(1);
        }
    }
    PeerGateway(const PeerGateway&) = delete;
    PeerGateway& operator=(const PeerGateway&) = delete;
    ~PeerGateway()
    {
        if (process_ > 0) {
            ::kill(process_, SIGKILL);
            ::waitpid(process_, nullptr, 0);
        }
    }
    [[nodiscard]] pid_t process() const { return process_; }

private:
    pid_t process_{-1};
};

void measure_peer(const std::string& name, const std::string& command,
                  const GatewayOptions& options)
{
    ModbusPlc plc{options.variables};
    const std::uint16_t port = free_port();
    const PeerGateway gateway{command, plc.port(), port};
    plc.start();
    GatewayClient client{"opc.tcp://127.0.0.1:" + std::to_string(port), options.peer_node, options,
                         plc.requests};
    client.connect();
    print(name, client.measure(gateway.process()));
}

} // namespace

int measure_gateways(const GatewayOptions& options)
{
    print_head(options);
    measure_own<ModbusPlc>("modbus", options, {});
    measure_own<ModbusPlc>("modbus, a request each", options, {.has_no_plan = true});
    measure_own<SlmpPlc>("slmp", options, {.is_slmp = true});
    measure_own<SlmpPlc>("slmp, a request each", options, {.is_slmp = true, .has_no_plan = true});
    for (std::size_t i = 0; i < options.peers.size(); ++i) {
        measure_peer("peer " + std::to_string(i + 1), options.peers[i], options);
    }
    return 0;
}

} // namespace busbar::bench
