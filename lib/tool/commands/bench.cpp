#include <algorithm>
#include <memory>

#include <busbar/client/attributes.hpp>
#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool {

namespace {

using Clock = std::chrono::steady_clock;

struct BenchArguments {
    std::vector<std::string> nodes;
    double seconds{2};
    std::size_t in_flight{32};
};

/// The results of one load.
struct Measured {
    std::string load;
    double per_second{0}; // requests
    /// Duration of each request, sorted.
    std::vector<double> milliseconds;

    [[nodiscard]] double at(double share) const
    {
        const auto last = static_cast<double>(milliseconds.size() - 1);
        return milliseconds[static_cast<std::size_t>(share * last)];
    }
};

ReadRequest request_for(const std::vector<NodeId>& nodes)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Source;
    for (const NodeId& node : nodes) {
        request.nodes_to_read.push_back(client::attribute_of(node));
    }
    return request;
}

/// Keeps a number of Read requests in progress for a time.
class ReadLoad {
public:
    ReadLoad(Connection& connection, const std::vector<NodeId>& nodes)
        : connection_{&connection}, request_{request_for(nodes)}
    {
    }

    Measured run(std::string name, std::size_t in_flight, double seconds)
    {
        const auto begin = Clock::now();
        end_ = begin +
               std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{seconds});
        for (std::size_t i = 0; i < in_flight; ++i) {
            send();
        }
        const bool is_done = connection_->blocking().run_until([this] { return under_way_ == 0; });
        if (!is_done) {
            throw Interrupted{};
        }
        if (error_.is_bad()) {
            throw Failure{error_, name};
        }
        const std::chrono::duration<double> passed = Clock::now() - begin;
        std::sort(times_.begin(), times_.end());
        const double per_second = static_cast<double>(times_.size()) / passed.count();
        return {std::move(name), per_second, std::move(times_)};
    }

private:
    void send()
    {
        ++under_way_;
        connection_->client().call<ReadResponse>(
            request_, [this, sent = Clock::now()](const Result<ReadResponse>& response) {
                const auto now = Clock::now();
                --under_way_;
                if (!response) {
                    error_ = response.error();
                    return;
                }
                const std::chrono::duration<double, std::milli> time = now - sent;
                times_.push_back(time.count());
                if (now < end_) {
                    send();
                }
            });
    }

    Connection* connection_;
    ReadRequest request_;
    Clock::time_point end_;
    std::size_t under_way_{0};
    StatusCode error_;
    std::vector<double> times_;
};

/// The number of values that a subscription delivers, and their regularity.
struct Delivered {
    double per_second{0};
    double interval{0}; // milliseconds between two deliveries, on average
    double worst{0};
};

Delivered subscribe(Connection& connection, const std::vector<NodeId>& nodes, double seconds)
{
    std::uint64_t values = 0;
    std::vector<Clock::time_point> arrivals;
    client::SubscriptionHandlers handlers;
    handlers.on_data = [&](std::span<const client::DataChange> changes) {
        values += changes.size();
        arrivals.push_back(Clock::now());
    };
    client::SubscriptionSettings settings;
    settings.publishing_interval = std::chrono::milliseconds{100};
    auto& subscriptions = connection.client().subscriptions();
    const auto subscription =
        connection.value(subscriptions.create(settings, std::move(handlers)), "the subscription");
    std::vector<client::ItemSettings> items;
    for (const NodeId& node : nodes) {
        items.emplace_back().node = node;
        items.back().queue_size = 100;
    }
    static_cast<void>(connection.value(subscriptions.add_items(subscription, std::move(items)),
                                       "the monitored items"));
    const bool is_complete = connection.blocking().run_for(
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>{seconds}));
    static_cast<void>(subscriptions.remove(subscription));
    connection.blocking().run_for(std::chrono::milliseconds{1});
    if (!is_complete) {
        throw Interrupted{};
    }
    Delivered delivered;
    delivered.per_second = static_cast<double>(values) / seconds;
    for (std::size_t i = 1; i < arrivals.size(); ++i) {
        const std::chrono::duration<double, std::milli> gap = arrivals[i] - arrivals[i - 1];
        delivered.interval += gap.count() / static_cast<double>(arrivals.size() - 1);
        delivered.worst = std::max(delivered.worst, gap.count());
    }
    return delivered;
}

std::string number(double value, int digits)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

void print_json(Output& out, const std::vector<Measured>& reads, const Delivered& delivered)
{
    JsonLine json;
    json.open_object().key("reads").open_array();
    for (const Measured& read : reads) {
        json.open_object().member("load", read.load).member("perSecond", read.per_second);
        json.member("medianMs", read.at(0.5)).member("p99Ms", read.at(0.99));
        json.member("worstMs", read.at(1)).close_object();
    }
    json.close_array().key("subscription").open_object();
    json.member("valuesPerSecond", delivered.per_second);
    json.member("intervalMs", delivered.interval).member("worstIntervalMs", delivered.worst);
    out.line(json.close_object().close_object().document());
}

void print(Output& out, const std::vector<Measured>& reads, const Delivered& delivered)
{
    Table table{{{"LOAD", 16},
                 {"PER SECOND", 10, true},
                 {"MEDIAN", 9, true},
                 {"99 %", 9, true},
                 {"WORST", 9, true}}};
    for (const Measured& read : reads) {
        table.add({{read.load},
                   {number(read.per_second, 0)},
                   {number(read.at(0.5), 3) + " ms"},
                   {number(read.at(0.99), 3) + " ms"},
                   {number(read.at(1), 3) + " ms"}});
    }
    table.print(out);
    out.line("subscription every 100 ms: " + number(delivered.per_second, 0) +
             " values per second, " + number(delivered.interval, 1) + " ms apart, " +
             number(delivered.worst, 1) + " ms at worst");
}

Exit measure(Context& context, Connection& connection, const BenchArguments& arguments)
{
    std::vector<NodeId> nodes;
    for (const NamedNode& node : find_nodes(connection, arguments.nodes)) {
        nodes.push_back(id_of(connection, node));
    }
    const std::string one = "read " + std::to_string(nodes.size());
    std::vector<Measured> reads;
    reads.push_back(ReadLoad{connection, nodes}.run(one, 1, arguments.seconds));
    reads.push_back(ReadLoad{connection, nodes}.run(
        one + ", " + std::to_string(arguments.in_flight) + " at once", arguments.in_flight,
        arguments.seconds));
    const Delivered delivered = subscribe(connection, nodes, arguments.seconds);
    if (context.options.is_json) {
        print_json(context.out, reads, delivered);
    } else {
        print(context.out, reads, delivered);
    }
    return Exit::Good;
}

} // namespace

void add_bench(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("bench", "Measures briefly how fast a server answers.");
    const auto arguments = std::make_shared<BenchArguments>();
    command->add_option("NODE", arguments->nodes,
                        "server (optional), then nodes; the server's time by default");
    command->add_option("-s,--seconds", arguments->seconds, "for each of the three measurements")
        ->check(CLI::Range(0.1, 3'600.0))
        ->type_name("SECONDS")
        ->capture_default_str();
    command->add_option("--in-flight", arguments->in_flight, "requests at once, in the second")
        ->check(CLI::Range(1, 1'000))
        ->type_name("N")
        ->capture_default_str();
    when_chosen(*command, run, [arguments](Context& context) {
        take_url(arguments->nodes, context.options);
        if (arguments->nodes.empty()) {
            arguments->nodes.push_back(to_string(NodeId{0, id::Server_ServerStatus_CurrentTime}));
        }
        check_addresses(arguments->nodes);
        Connection connection{context};
        return measure(context, connection, *arguments);
    });
}

} // namespace busbar::tool
