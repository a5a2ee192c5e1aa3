#include "session_memory.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "load.hpp"
#include "own_server.hpp"
#include "process.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

constexpr int waiting_publishes = 2;
constexpr auto publishing_interval = 1s;
/// For what the server does when nobody asks: it frees what has ended, and in its time gives free
/// memory back to the system.
constexpr auto settling_time = 500ms;
constexpr auto return_time = 12s;
constexpr std::chrono::minutes session_patience{30};

ReadValueId variable()
{
    ReadValueId value;
    value.node_id = NodeId{0, id::Server_ServerStatus_State};
    value.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    return value;
}

/// One session over a connection of its own.
class Member {
public:
    [[nodiscard]] Result<void> open(Load& load) { return load.open(loop_, true, session_patience); }

    /// A Subscription of so many items, whose first values come with its first cycle; the Publish
    /// requests behind that wait.
    [[nodiscard]] Result<void> subscribe(std::size_t items)
    {
        CreateSubscriptionRequest request;
        request.requested_publishing_interval =
            static_cast<double>(std::chrono::milliseconds{publishing_interval}.count());
        request.requested_lifetime_count = 10'000;
        request.requested_max_keep_alive_count = 3'000;
        request.publishing_enabled = true;
        const auto event = loop_.call(request);
        const auto made =
            event ? event->response<CreateSubscriptionResponse>() : fail(event.error());
        const auto added = made ? monitor(made->subscription_id, items) : fail(made.error());
        Result<void> done = added;
        for (int i = 0; done && i < 1 + waiting_publishes; ++i) {
            const auto sent = loop_.client().send(PublishRequest{});
            done = sent ? Result<void>{} : fail(sent.error());
        }
        return done ? take() : done;
    }
    [[nodiscard]] Result<void> ask(std::size_t values)
    {
        const auto sent = loop_.client().send(read_of(values));
        return sent ? Result<void>{} : fail(sent.error());
    }
    /// Sends what there is to send, and hardly takes an answer.
    void push() { static_cast<void>(loop_.wait(1ms)); }
    void close() { loop_.close(); }
    [[nodiscard]] Result<void> take()
    {
        const auto last = loop_.call(read_of(1));
        return last ? Result<void>{} : fail(last.error());
    }

private:
    [[nodiscard]] static ReadRequest read_of(std::size_t values)
    {
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Both;
        for (std::size_t i = 0; i < values; ++i) {
            request.nodes_to_read.push_back(variable());
        }
        return request;
    }
    [[nodiscard]] Result<void> monitor(std::uint32_t subscription, std::size_t items)
    {
        CreateMonitoredItemsRequest request;
        request.subscription_id = subscription;
        for (std::size_t i = 0; i < items; ++i) {
            MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
            item.item_to_monitor = variable();
            item.monitoring_mode = MonitoringMode::Reporting;
            item.requested_parameters.client_handle = static_cast<std::uint32_t>(i);
            item.requested_parameters.sampling_interval = 1'000;
            item.requested_parameters.queue_size = 1;
        }
        const auto event = loop_.call(request);
        const auto made =
            event ? event->response<CreateMonitoredItemsResponse>() : fail(event.error());
        if (!made) {
            return fail(made.error());
        }
        const auto bad = std::find_if(made->results.begin(), made->results.end(),
                                      [](const auto& one) { return one.status_code.is_bad(); });
        return bad == made->results.end() ? Result<void>{} : fail(bad->status_code);
    }

    net::ClientLoop loop_;
};

using Members = std::vector<std::unique_ptr<Member>>;

template <typename Work>
Result<void> each_of(const Members& members, Work work)
{
    for (const auto& member : members) {
        if (const Result<void> done = work(*member); !done) {
            return done;
        }
    }
    return {};
}

double own_mb(const OwnServer& server, std::chrono::milliseconds after = settling_time)
{
    std::this_thread::sleep_for(after);
    return own_memory_mb(server.process());
}

/// The system knows the peak of all memory alone; the pages of files are no fewer now than then.
double own_peak_mb(const OwnServer& server)
{
    const Memory memory = memory_of(server.process());
    return memory.peak_mb - memory.now_mb + own_memory_mb(server.process());
}

/// All ask before any of them takes an answer.
Result<void> flood(const Members& members, const SessionMemoryOptions& options)
{
    for (std::size_t i = 0; i < options.reads; ++i) {
        const auto asked =
            each_of(members, [&](Member& member) { return member.ask(options.values); });
        if (!asked) {
            return asked;
        }
    }
    for (const auto& member : members) {
        member->push();
    }
    return each_of(members, [](Member& member) { return member.take(); });
}

Result<SessionMemory> measure(const OwnServer& server, std::size_t sessions,
                              const SessionMemoryOptions& options)
{
    SessionMemory row;
    row.sessions = sessions;
    row.empty_mb = own_mb(server);
    Options to;
    to.url = server.url();
    to.policy = options.is_secure ? "Basic256Sha256" : "None";
    to.mode = options.is_secure ? "SignAndEncrypt" : "None";
    Load load{to};
    Result<void> done = load.prepare();
    Members members;
    while (done && members.size() < sessions) {
        done = members.emplace_back(std::make_unique<Member>())->open(load);
    }
    row.sessions_mb = own_mb(server);
    if (done && options.items != 0) {
        done = each_of(members, [&](Member& member) { return member.subscribe(options.items); });
        std::this_thread::sleep_for(publishing_interval);
    }
    if (done) {
        done = each_of(members, [](Member& member) { return member.take(); });
    }
    row.items_mb = own_mb(server);
    forget_peak(server.process());
    if (done) {
        done = flood(members, options);
    }
    row.peak_mb = own_peak_mb(server);
    row.flooded_mb = own_mb(server, return_time);
    for (const auto& member : members) {
        member->close();
    }
    members.clear();
    row.left_mb = own_mb(server, return_time);
    return done ? Result<SessionMemory>{row} : fail(done.error());
}

} // namespace

Result<std::vector<SessionMemory>> measure_session_memory(const SessionMemoryOptions& options)
{
    std::vector<std::unique_ptr<OwnServer>> servers;
    for (std::size_t i = 0; i < options.sessions.size(); ++i) {
        auto server = OwnServer::start(
            {.is_secure = options.is_secure, .is_unrationed = true, .is_large = true});
        if (!server) {
            return fail(server.error());
        }
        servers.push_back(*std::move(server));
    }
    std::vector<SessionMemory> rows;
    for (std::size_t i = 0; i < servers.size(); ++i) {
        const auto row = measure(*servers[i], options.sessions[i], options);
        if (!row) {
            return fail(row.error());
        }
        rows.push_back(*row);
    }
    return rows;
}

void print(const std::vector<SessionMemory>& rows, bool json)
{
    if (!json) {
        std::printf("%8s %9s %12s %12s %11s %11s %11s %8s\n", "sessions", "empty MB", "session kB",
                    "+ items kB", "peak kB", "flooded kB", "flooded MB", "left MB");
    }
    const char* separator = "";
    std::fputs(json ? "{\"rows\": [" : "", stdout);
    for (const SessionMemory& row : rows) {
        if (json) {
            std::printf("%s\n  {\"sessions\": %zu, \"empty_mb\": %.2f, \"session_kb\": %.1f, "
                        "\"with_items_kb\": %.1f, \"peak_kb\": %.1f, \"flooded_kb\": %.1f, "
                        "\"left_mb\": %.2f}",
                        separator, row.sessions, row.empty_mb, row.each_kb(row.sessions_mb),
                        row.each_kb(row.items_mb), row.each_kb(row.peak_mb),
                        row.each_kb(row.flooded_mb), row.left_mb);
            separator = ",";
        } else {
            std::printf("%8zu %9.1f %12.1f %12.1f %11.1f %11.1f %11.1f %8.1f\n", row.sessions,
                        row.empty_mb, row.each_kb(row.sessions_mb), row.each_kb(row.items_mb),
                        row.each_kb(row.peak_mb), row.each_kb(row.flooded_mb), row.flooded_mb,
                        row.left_mb);
        }
    }
    std::fputs(json ? "\n]}\n" : "", stdout);
}

} // namespace busbar::bench
