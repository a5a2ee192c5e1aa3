#include "good_client.hpp"

#include <algorithm>
#include <string>

#include <busbar/core/attribute_id.hpp>
#include <busbar/core/text.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::bench {

namespace {

/// Between two Reads.
constexpr std::chrono::milliseconds pause_of_reads{1};
/// For connects, while the server may be starting again.
constexpr std::chrono::milliseconds longest_restart{5'000};
constexpr std::chrono::milliseconds pause_of_connects{20};

} // namespace

GoodClient::GoodClient(Load& load) : load_{&load}
{
    request_.timestamps_to_return = TimestampsToReturn::Neither;
    ReadValueId& item = request_.nodes_to_read.emplace_back();
    item.node_id = NodeId{0, id::Server_ServerStatus_State};
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
}

Result<void> GoodClient::connect()
{
    const TimePoint begin = clock_now();
    for (;;) {
        loop_ = std::make_unique<net::ClientLoop>();
        const auto connected = load_->open(*loop_, true, patience);
        if (connected || clock_now() - begin > longest_restart) {
            return connected;
        }
        std::this_thread::sleep_for(pause_of_connects);
    }
}

Result<void> GoodClient::read_while(const std::function<bool(double)>& goes_on, HostileRow& row)
{
    std::vector<double> times;
    const TimePoint begin = clock_now();
    do {
        const TimePoint start = clock_now();
        const auto event = loop_->call(request_);
        times.push_back(elapsed_us(start));
        if (!event || event->status.is_bad()) {
            ++row.failed;
            if (const auto connected = connect(); !connected) {
                return connected;
            }
        }
        std::this_thread::sleep_for(pause_of_reads);
    } while (goes_on(elapsed_us(begin) / 1e6));
    std::sort(times.begin(), times.end());
    row.reads = times.size();
    row.median_us = times[times.size() / 2];
    row.p90_us = times[times.size() * 9 / 10];
    row.p99_us = times[times.size() * 99 / 100];
    row.worst_us = times.back();
    return {};
}

GoodSubscriber::GoodSubscriber(Load& load)
    : rows_{fail(status::Bad_NothingToDo)}, thread_{[&] { rows_ = load.run_subscriptions(); }}
{
    std::this_thread::sleep_for(warm_up);
}

Result<void> GoodSubscriber::finish(HostileRow& row)
{
    thread_.join();
    if (!rows_) {
        return fail(rows_.error());
    }
    row.publishes = rows_->front().publishes;
    row.longest_gap_ms = rows_->front().worst_interval_ms;
    return {};
}

Newcomers::Newcomers(Load& load, const Tally& tally, HostileRow& row, std::size_t threads,
                     std::size_t per_second)
    : tally_{tally}, row_{row}
{
    const std::chrono::milliseconds apart{1'000 * threads / per_second};
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < threads; ++i) {
        threads_.emplace_back([this, &load, first = begin + i * apart / threads, apart] {
            come_and_go(load, first, apart);
        });
    }
}

Newcomers::~Newcomers()
{
    is_over_ = true;
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

void Newcomers::come_and_go(Load& load, std::chrono::steady_clock::time_point next,
                            std::chrono::milliseconds apart)
{
    for (; !is_over_; next = std::max(next + apart, std::chrono::steady_clock::now())) {
        std::this_thread::sleep_until(next);
        net::ClientLoop loop;
        const TimePoint start = clock_now();
        const std::size_t before = tally_.answered + tally_.refused;
        const auto opened = load.open(loop, true, patience);
        note(opened, elapsed_us(start) / 1e3, tally_.answered + tally_.refused - before);
        loop.close();
    }
}

void Newcomers::note(const Result<void>& opened, double took_ms, std::size_t before)
{
    const std::scoped_lock lock{mutex_};
    row_.worst_login_ms = std::max(row_.worst_login_ms, took_ms);
    row_.most_before_login = std::max(row_.most_before_login, before);
    ++(opened ? row_.logins : row_.failed_logins);
    if (!opened && row_.status.empty()) {
        row_.status = name(opened.error());
    }
}

} // namespace busbar::bench
