#include "appendix7_client.hpp"

#include <algorithm>
#include <string>
#include <thread>
#include <utility>

#include <busbar/client/response_limits.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>

#include "load.hpp"
#include "mapped_plant.hpp"

namespace busbar::bench {

namespace {

constexpr double interval_ms = 200;
constexpr std::chrono::seconds request_timeout{60};

NodeId node(std::string_view prefix, std::size_t number)
{
    return NodeId::parse(std::string{prefix} + mapped_name(number)).value_or(NodeId{});
}

ReadRequest read_request(std::string_view prefix, std::size_t count)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.nodes_to_read.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = node(prefix, i);
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    }
    return request;
}

WriteRequest write_request(std::string_view prefix, std::size_t count)
{
    WriteRequest request;
    request.nodes_to_write.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        WriteValue& item = request.nodes_to_write.emplace_back();
        item.node_id = node(prefix, i);
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.value = DataValue{Variant{static_cast<std::int16_t>(i)}};
    }
    return request;
}

/// Whether a value was read or written.
StatusCode status_of(const DataValue& value)
{
    const bool has_value = value.value.get_if<std::int16_t>() != nullptr;
    return value.status.is_good() && !has_value ? StatusCode{status::Bad_NoData} : value.status;
}

StatusCode status_of(StatusCode code)
{
    return code;
}

/// One request and its response, all of whose results must be good.
template <typename Response, typename Request>
Result<void> exchange(net::ClientLoop& loop, Request& request, std::size_t count)
{
    const auto event = loop.call(request);
    const auto response = event ? event->template response<Response>(generous_limits())
                                : Result<Response>{fail(event.error())};
    if (!response) {
        return fail(response.error());
    }
    const auto bad = std::find_if(response->results.begin(), response->results.end(),
                                  [](const auto& each) { return !status_of(each).is_good(); });
    if (bad != response->results.end()) {
        return fail(status_of(*bad));
    }
    return response->results.size() == count ? Result<void>{} : fail(status::Bad_NoData);
}

/// The mean in milliseconds. What is done once begins at another phase of the scan each time: that
/// it waits for the scan's end counts as much as it does for clients that know nothing of scans.
template <typename Once>
Result<double> mean_ms(int rounds, Once once)
{
    constexpr int phases = 20;
    constexpr int stride = 7;
    double sum = 0;
    for (int i = 0; i < rounds; ++i) {
        std::this_thread::sleep_for(MappedPlant::cycle * (i * stride % phases) / phases);
        const TimePoint begin = clock_now();
        if (const Result<void> done = once(); !done) {
            return fail(done.error());
        }
        sum += elapsed_us(begin) / 1e3;
    }
    return sum / rounds;
}

Result<double> subscription_ms(net::ClientLoop& loop, std::string_view prefix, std::size_t count,
                               int rounds)
{
    SubscribeOptions options;
    options.moving = std::string{prefix} + "M{}";
    options.still = std::string{prefix} + "S{}";
    options.publishing_ms = interval_ms;
    options.sampling_ms = interval_ms;
    options.seconds = rounds * interval_ms / 1e3;
    options.warm_up_seconds = std::min(options.warm_up_seconds, options.seconds);
    const auto row = subscribe(loop, options, count);
    if (!row) {
        return fail(row.error());
    }
    if (row->messages_lost != 0) {
        return fail(status::Bad_SequenceNumberInvalid);
    }
    return row->publishes != 0 && row->values_wrong == 0 ? Result<double>{row->mean_interval_ms}
                                                         : fail(status::Bad_DataLost);
}

} // namespace

Result<void> SevenClient::open(const std::string& url)
{
    Options wishes;
    wishes.url = url;
    wishes.policy = "Basic256Sha256";
    wishes.mode = "SignAndEncrypt";
    load_.emplace(std::move(wishes));
    const auto prepared = load_->prepare();
    return prepared ? load_->open(loop_, true, request_timeout) : prepared;
}

Result<double> SevenClient::measure_ms(std::string_view load, std::string_view prefix,
                                       std::size_t count, int rounds)
{
    if (load == "read") {
        auto request = read_request(prefix, count);
        return mean_ms(rounds, [&] { return exchange<ReadResponse>(loop_, request, count); });
    }
    if (load == "write") {
        auto request = write_request(prefix, count);
        return mean_ms(rounds, [&] { return exchange<WriteResponse>(loop_, request, count); });
    }
    // On a connection of its own, where no Publish of another one waits.
    net::ClientLoop loop;
    const auto opened = load_->open(loop, true, request_timeout);
    return opened ? subscription_ms(loop, prefix, count, rounds) : fail(opened.error());
}

} // namespace busbar::bench
