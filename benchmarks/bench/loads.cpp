#include "load.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

namespace busbar::bench {

namespace {

constexpr std::size_t fewest_runs = 5;
constexpr std::size_t most_runs = 5'000;
/// The requests that a load sends in turn.
constexpr std::size_t most_requests = 16;
/// What a chunk adds to a body, roughly; it hardly counts.
constexpr std::size_t frame_size = 80;

template <typename Structure>
std::size_t wire_size(const Structure& structure)
{
    const auto bytes = binary::to_bytes(structure);
    return frame_size + (bytes ? bytes->size() : 0);
}

/// Runs `once` for the time the options give; it answers false on failure.
template <typename Once>
Result<std::vector<double>> repeat(double seconds, Once once)
{
    std::vector<double> times;
    const TimePoint begin = clock_now();
    while (times.size() < fewest_runs ||
           (times.size() < most_runs && elapsed_us(begin) < seconds * 1e6)) {
        const TimePoint start = clock_now();
        const auto done = once();
        if (!done) {
            return fail(done.error());
        }
        times.push_back(elapsed_us(start));
    }
    return times;
}

} // namespace

TimePoint clock_now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

double elapsed_us(TimePoint since)
{
    return std::chrono::duration<double, std::micro>(clock_now() - since).count();
}

Row summarise(std::string load, std::vector<double> times_us)
{
    std::sort(times_us.begin(), times_us.end());
    Row row;
    row.load = std::move(load);
    row.runs = times_us.size();
    row.best_us = times_us.front();
    row.median_us = times_us[times_us.size() / 2];
    row.p99_us = times_us[times_us.size() * 99 / 100];
    row.per_second = 1e6 / row.median_us;
    return row;
}

NodeId Load::node(std::size_t number) const
{
    if (!aliases_.empty()) {
        return aliases_[number];
    }
    std::string text = options_.node;
    const std::size_t at = text.find("{}");
    if (at != std::string::npos) {
        text.replace(at, 2, std::to_string(numbers_[number]));
    }
    return NodeId::parse(text).value_or(NodeId{});
}

Result<void> Load::register_nodes(net::ClientLoop& loop)
{
    constexpr std::size_t at_once = 1'000;
    aliases_.clear();
    std::vector<NodeId> all;
    for (std::size_t first = 0; first < numbers_.size(); first += at_once) {
        RegisterNodesRequest request;
        for (std::size_t i = first; i < std::min(first + at_once, numbers_.size()); ++i) {
            request.nodes_to_register.push_back(node(i));
        }
        const auto event = loop.call(request);
        const auto response =
            event ? event->response<RegisterNodesResponse>(generous_limits()) : fail(event.error());
        if (!response) {
            return fail(response.error());
        }
        all.insert(all.end(), response->registered_node_ids.begin(),
                   response->registered_node_ids.end());
    }
    if (all.size() != numbers_.size()) {
        return fail(status::Bad_NoData);
    }
    aliases_ = std::move(all);
    return {};
}

Result<Row> Load::connect_load()
{
    std::vector<double> times;
    meter_.begin();
    for (std::size_t i = 0; i < options_.connects; ++i) {
        net::ClientLoop loop;
        const TimePoint start = clock_now();
        const auto opened = open(loop, true);
        if (!opened) {
            return fail(opened.error());
        }
        times.push_back(elapsed_us(start));
        loop.close();
    }
    const auto cost = meter_.end(times.size());
    Row row = summarise("connect and activate", std::move(times));
    row.server = cost;
    const std::uint32_t key_bits = server_certificate_ ? server_certificate_->key_bits() : 0;
    row.floor = connect_floor(security_, key_bits, wall_clock_.now());
    return row;
}

template <typename Once>
Result<Row> Load::measure(const std::string& load, std::size_t count, Once once)
{
    meter_.begin();
    auto times = repeat(options_.seconds, once);
    if (!times) {
        return fail(times.error());
    }
    const auto cost = meter_.end(times->size());
    Row row = summarise(load + " " + std::to_string(count), *std::move(times));
    row.server = cost;
    row.per_second *= static_cast<double>(count);
    return row;
}

template <typename Request, typename Add>
std::vector<Request> Load::requests_of(std::size_t count, Add add) const
{
    const std::size_t other =
        std::max<std::size_t>(numbers_.size() / std::max<std::size_t>(count, 1), 1);
    std::vector<Request> requests(std::min(other, most_requests));
    std::size_t place = 0;
    for (Request& request : requests) {
        for (std::size_t i = 0; i < count; ++i) {
            add(request, place++);
        }
    }
    return requests;
}

template <typename Response, typename Request, typename Check>
Result<Row> Load::exchange_load(const std::string& load, std::size_t count, net::ClientLoop& loop,
                                std::vector<Request> requests, Check check)
{
    std::size_t response_size = 0;
    std::size_t run = 0;
    auto row = measure(load, count, [&]() -> Result<void> {
        const auto event = loop.call(requests[run++ % requests.size()]);
        const auto response =
            event ? event->template response<Response>(generous_limits()) : fail(event.error());
        if (!response) {
            return fail(response.error());
        }
        response_size = event->body.size() + frame_size;
        const StatusCode bad =
            response->results.size() == count ? check(response->results) : status::Bad_NoData;
        return bad.is_good() ? Result<void>{} : fail(bad);
    });
    if (row) {
        row->floor = exchange_floor(wire_size(requests.front()), response_size, security_);
    }
    return row;
}

Result<Row> Load::read_load(net::ClientLoop& loop, std::size_t count)
{
    auto requests = requests_of<ReadRequest>(count, [&](ReadRequest& request, std::size_t place) {
        request.timestamps_to_return = TimestampsToReturn::Neither;
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = node(place);
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    });
    const auto check = [](const auto& results) {
        const auto bad = std::find_if(results.begin(), results.end(), [](const DataValue& value) {
            return !value.status.is_good();
        });
        return bad == results.end() ? StatusCode{} : bad->status;
    };
    return exchange_load<ReadResponse>("read", count, loop, std::move(requests), check);
}

Result<Row> Load::write_load(net::ClientLoop& loop, std::size_t count)
{
    auto requests = requests_of<WriteRequest>(count, [&](WriteRequest& request, std::size_t place) {
        WriteValue& item = request.nodes_to_write.emplace_back();
        item.node_id = node(place);
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.value = DataValue{Variant{static_cast<std::int16_t>(place)}};
    });
    const auto check = [](const auto& results) {
        const auto bad = std::find_if(results.begin(), results.end(),
                                      [](StatusCode code) { return code.is_bad(); });
        return bad == results.end() ? StatusCode{} : *bad;
    };
    return exchange_load<WriteResponse>("write", count, loop, std::move(requests), check);
}

Result<Row> Load::browse_load(net::ClientLoop& loop, std::size_t count)
{
    auto requests =
        requests_of<BrowseRequest>(count, [&](BrowseRequest& request, std::size_t place) {
            BrowseDescription& item = request.nodes_to_browse.emplace_back();
            item.node_id = node(place);
            item.browse_direction = BrowseDirection::Both;
            item.reference_type_id = NodeId{0, id::References};
            item.include_subtypes = true;
            item.result_mask = static_cast<std::uint32_t>(BrowseResultMask::All);
        });
    const auto check = [](const auto& results) {
        const auto empty =
            std::find_if(results.begin(), results.end(),
                         [](const BrowseResult& result) { return result.references.empty(); });
        return empty == results.end()        ? StatusCode{}
               : empty->status_code.is_bad() ? empty->status_code
                                             : StatusCode{status::Bad_NoData};
    };
    return exchange_load<BrowseResponse>("browse", count, loop, std::move(requests), check);
}

Result<Row> Load::in_flight_load(net::ClientLoop& loop, std::size_t in_flight)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = node(0);
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    std::size_t answers = 0;
    std::size_t open = 0;
    meter_.begin();
    const TimePoint begin = clock_now();
    while (elapsed_us(begin) < options_.seconds * 1e6) {
        for (; open < in_flight; ++open) {
            const auto sent = loop.client().send(request);
            if (!sent) {
                return fail(sent.error());
            }
        }
        const auto event = loop.wait();
        if (!event || event->kind != client::ConnectionEvent::Kind::Response ||
            event->status.is_bad()) {
            return fail(event ? event->status : status::Bad_Timeout);
        }
        ++answers;
        --open;
    }
    const double total = elapsed_us(begin);
    const auto cost = meter_.end(answers);
    for (; open != 0; --open) {
        static_cast<void>(loop.wait());
    }
    Row row;
    row.load = "one value, " + std::to_string(in_flight) + " in flight";
    row.runs = answers;
    row.median_us = total / static_cast<double>(answers);
    row.per_second = 1e6 / row.median_us;
    row.server = cost;
    return row;
}

} // namespace busbar::bench
