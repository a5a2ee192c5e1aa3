#include "growth.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include <busbar/core/attribute_id.hpp>
#include <busbar/core/log.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "memory_server.hpp"

namespace busbar::bench {

namespace {

constexpr int rounds = 5;
/// How often a series is measured.
constexpr int repetitions = 3;
constexpr std::size_t parts = 16;
constexpr std::size_t items_per_request = 1'000;
constexpr std::size_t values_per_read = 1'000;
/// Longer than a measurement: nothing is sampled or published meanwhile.
constexpr double one_hour_ms = 3'600'000;

/// Microseconds of the server for one of the variables, all over them, where `together` are read by
/// one request.
Result<double> read_cost(MemoryServer& server, Guest& guest, std::size_t variables,
                         std::size_t reads, std::size_t together = 1)
{
    // A prime, so that neighbours are not read one after the other.
    constexpr std::size_t stride = 104'729;
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    for (std::size_t i = 0; i < together; ++i) {
        request.nodes_to_read.emplace_back().attribute_id =
            static_cast<std::uint32_t>(AttributeId::Value);
    }
    double best = std::numeric_limits<double>::max();
    std::size_t place = 0; // goes on from round to round: no cache has seen the node before
    for (int round = 0; round < rounds; ++round) {
        static_cast<void>(server.take_time_us());
        for (std::size_t i = 0; i < reads; i += together) {
            for (ReadValueId& item : request.nodes_to_read) {
                place = (place + stride) % variables;
                item.node_id = server.node(place);
            }
            const auto response = guest.call<ReadResponse>(request);
            if (!response || response->results.size() != together ||
                response->results[0].status.is_bad()) {
                return fail(response ? StatusCode{status::Bad_NoData} : response.error());
            }
        }
        const std::size_t values = (reads + together - 1) / together * together;
        best = std::min(best, server.take_time_us() / static_cast<double>(values));
    }
    return best;
}

/// Makes all from `first` to `last` part by part. The cost of one is the median of the parts: now
/// and then one of them has a table grow, which is not what each costs.
template <typename Create>
Result<double> create_cost(MemoryServer& server, std::size_t first, std::size_t last, Create create)
{
    const std::size_t size = (last - first + parts - 1) / parts;
    std::vector<double> costs;
    while (first < last) {
        const std::size_t next = std::min(first + size, last);
        static_cast<void>(server.take_time_us());
        if (const Result<void> created = create(first, next); !created) {
            return fail(created.error());
        }
        costs.push_back(server.take_time_us() / static_cast<double>(next - first));
        first = next;
    }
    const auto middle = costs.begin() + static_cast<std::ptrdiff_t>((costs.size() - 1) / 2);
    std::nth_element(costs.begin(), middle, costs.end());
    return *middle;
}

/// `create` makes those from the first to before the last that it is told.
template <typename Create>
Result<void> measure(Series& series, const std::vector<std::size_t>& counts, MemoryServer& server,
                     Create create, const std::function<Result<double>()>& read)
{
    std::size_t before = 0;
    for (const std::size_t count : counts) {
        if (count <= before) {
            return fail(status::Bad_InvalidArgument);
        }
        const auto create_us = create_cost(server, before, count, create);
        const auto read_us = create_us ? read() : fail(create_us.error());
        if (!read_us) {
            return fail(read_us.error());
        }
        series.points.push_back({count, *create_us, *read_us});
        before = count;
    }
    return {};
}

Result<Series> sessions(const GrowthOptions& options)
{
    Series series{"sessions", {}};
    MemoryServer server;
    server.add_variables(1);
    auto reader = server.admit();
    if (!reader) {
        return fail(reader.error());
    }
    std::vector<std::unique_ptr<Guest>> others;
    const auto create = [&](std::size_t first, std::size_t last) -> Result<void> {
        for (std::size_t i = first; i < last; ++i) {
            auto guest = server.admit();
            if (!guest) {
                return fail(guest.error());
            }
            others.push_back(*std::move(guest));
        }
        return {};
    };
    const auto done = measure(series, options.sessions, server, create,
                              [&] { return read_cost(server, **reader, 1, options.reads); });
    return done ? Result<Series>{std::move(series)} : fail(done.error());
}

/// Deletes all down to none, and has the points say what that costs.
template <typename Delete>
Result<void> measure_deletion(Series& series, MemoryServer& server, Delete remove)
{
    for (std::size_t i = series.points.size(); i > 0; --i) {
        const std::size_t first = i > 1 ? series.points[i - 2].count : 0;
        const auto cost = create_cost(server, first, series.points[i - 1].count, remove);
        if (!cost) {
            return fail(cost.error());
        }
        series.points[i - 1].delete_us = *cost;
    }
    return {};
}

/// Monitors the variables from `first` to before `last`, and keeps the ids of the items.
Result<void> monitor(MemoryServer& server, Guest& guest, std::uint32_t subscription,
                     std::size_t first, std::size_t last, std::vector<std::uint32_t>& ids)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = subscription;
    for (std::size_t i = first; i < last; ++i) {
        MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
        item.item_to_monitor.node_id = server.node(i);
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.client_handle = static_cast<std::uint32_t>(i);
        item.requested_parameters.sampling_interval = one_hour_ms;
        item.requested_parameters.queue_size = 1;
    }
    const auto response = guest.call<CreateMonitoredItemsResponse>(request);
    if (!response) {
        return fail(response.error());
    }
    for (const MonitoredItemCreateResult& result : response->results) {
        if (result.status_code.is_bad()) {
            return fail(result.status_code);
        }
        ids.push_back(result.monitored_item_id);
    }
    return {};
}

Result<void> forget(Guest& guest, std::uint32_t subscription, std::span<const std::uint32_t> ids)
{
    DeleteMonitoredItemsRequest request;
    request.subscription_id = subscription;
    request.monitored_item_ids.assign(ids.begin(), ids.end());
    const auto response = guest.call<DeleteMonitoredItemsResponse>(request);
    if (!response) {
        return fail(response.error());
    }
    const auto bad = std::find_if(response->results.begin(), response->results.end(),
                                  [](StatusCode one) { return one.is_bad(); });
    return bad == response->results.end() ? Result<void>{} : fail(*bad);
}

/// `together` in each request that creates or deletes.
Result<Series> items(const GrowthOptions& options, const char* name, std::size_t together)
{
    Series series{name, {}};
    if (options.items.empty()) {
        return series;
    }
    MemoryServer server;
    server.add_variables(options.items.back());
    auto reader = server.admit();
    auto owner = server.admit();
    if (!reader || !owner) {
        return fail(reader ? owner.error() : reader.error());
    }
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = one_hour_ms;
    request.requested_lifetime_count = 1'000;
    request.requested_max_keep_alive_count = 100;
    request.publishing_enabled = true;
    const auto subscription = (*owner)->call<CreateSubscriptionResponse>(request);
    if (!subscription) {
        return fail(subscription.error());
    }
    std::vector<std::uint32_t> ids;
    const auto in_requests = [&](auto one) {
        return [one, together](std::size_t first, std::size_t last) -> Result<void> {
            Result<void> done;
            for (; done && first < last; first += together) {
                done = one(first, std::min(first + together, last));
            }
            return done;
        };
    };
    const std::uint32_t id = subscription->subscription_id;
    auto done = measure(
        series, options.items, server, in_requests([&](std::size_t first, std::size_t last) {
            return monitor(server, **owner, id, first, last, ids);
        }),
        [&] { return read_cost(server, **reader, options.items.back(), options.reads); });
    if (done) {
        done = measure_deletion(
            series, server, in_requests([&](std::size_t first, std::size_t last) {
                return forget(**owner, id, std::span{ids}.subspan(first, last - first));
            }));
    }
    return done ? Result<Series>{std::move(series)} : fail(done.error());
}

Result<Series> items_together(const GrowthOptions& options)
{
    return items(options, "items", items_per_request);
}

Result<Series> items_alone(const GrowthOptions& options)
{
    return items(options, "items, each by a request of its own", 1);
}

Result<Series> variables(const GrowthOptions& options, const char* name, std::size_t together)
{
    Series series{name, {}};
    MemoryServer server;
    auto reader = server.admit();
    if (!reader) {
        return fail(reader.error());
    }
    std::size_t there = 0;
    const auto create = [&](std::size_t, std::size_t last) -> Result<void> {
        server.add_variables(last);
        there = last;
        return {};
    };
    const auto done = measure(series, options.variables, server, create, [&] {
        return read_cost(server, **reader, there,
                         together == 1 ? options.reads : options.reads * 20, together);
    });
    return done ? Result<Series>{std::move(series)} : fail(done.error());
}

Result<Series> variables_alone(const GrowthOptions& options)
{
    return variables(options, "variables", 1);
}

Result<Series> variables_together(const GrowthOptions& options)
{
    return variables(options, "variables, each of 1000 in a Read", values_per_read);
}

/// Keeps the least of each cost.
void take_least(Series& series, const Series& again)
{
    for (std::size_t i = 0; i < series.points.size(); ++i) {
        Point& point = series.points[i];
        const Point& other = again.points[i];
        point.create_us = std::min(point.create_us, other.create_us);
        point.read_us = std::min(point.read_us, other.read_us);
        point.delete_us = std::min(point.delete_us, other.delete_us);
    }
}

} // namespace

Result<std::vector<Series>> measure_growth(const GrowthOptions& options)
{
    NullLog log;
    const net::ServerLoop loop{log}; // sets the allocator as for every server
    std::vector<Series> all;
    for (const auto measured :
         {sessions, items_together, items_alone, variables_alone, variables_together}) {
        auto series = measured(options);
        // Other programs disturb some costs: only what is there each time is a step. Pages that
        // were given back meanwhile cost again in each series, as they do for users.
        for (int i = 1; series && i < repetitions; ++i) {
            const auto again = measured(options);
            if (!again) {
                return fail(again.error());
            }
            take_least(*series, *again);
        }
        if (!series) {
            return fail(series.error());
        }
        all.push_back(*std::move(series));
    }
    return all;
}

} // namespace busbar::bench
