#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/server/memory_source.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "session_use.hpp"
#include "support/failing_allocation.hpp"
#include "support/job_list.hpp"
#include "support/server_fixture.hpp"

namespace busbar::test {

/// A service's request and what its answer was worth: Good, Bad_WouldBlock for none, and else the
/// status of the fault or of the worst operation.
struct FailureCase {
    std::function<std::uint32_t(TestClient&)> send;
    std::function<StatusCode(TestClient&, std::uint32_t)> take;
    /// What it is about cannot be had over another connection.
    bool dies_with_connection{false};
};

inline StatusCode status_in(StatusCode result)
{
    return result;
}
template <typename Result>
StatusCode status_in(const Result& result)
{
    if constexpr (requires { result.status_code; }) {
        return result.status_code;
    } else {
        return result.status;
    }
}

template <typename Results>
StatusCode worst_in(const Results& results)
{
    for (const auto& result : results) {
        if (status_in(result).is_bad()) {
            return status_in(result);
        }
    }
    return status::Good;
}

template <typename Response>
StatusCode worst_of(const Response& response)
{
    if constexpr (std::is_same_v<Response, SetTriggeringResponse>) {
        return worst_in(response.add_results);
    } else if constexpr (requires { response.results; }) {
        return worst_in(response.results);
    }
    return response.response_header.service_result;
}

template <typename Response, typename Request>
FailureCase asking(Request request)
{
    return {[request = std::move(request)](TestClient& client) {
                Request sent = request;
                sent.request_header.authentication_token = client.authentication_token;
                sent.request_header.request_handle = ++client.last_handle;
                const auto id = client.channel.send([&](binary::Writer& writer) {
                    encode(writer, NodeId{0, Request::binary_encoding_id});
                    encode(writer, sent);
                });
                return id ? *id : 0;
            },
            [](TestClient& client, std::uint32_t id) {
                const auto response = client.take<Response>(id);
                return response ? worst_of(*response) : response.error();
            },
            false};
}

/// Does its jobs in FailureFixture::pass().
class LaterWorker final : public server::Worker {
public:
    [[nodiscard]] bool run(std::function<void()> job) override
    {
        const Uncounted in_test;
        jobs.push_back(std::move(job));
        return true;
    }

    std::vector<std::function<void()>> jobs;
};

/// Outlive the server.
struct FailureParts {
    struct FlagWaker final : server::Waker {
        void wake() override { is_awake = true; }
        bool is_awake{false};
    };

    FixedWallClock source_clock;
    server::MemorySource memory{source_clock};
    server::MethodTable table;
    FlagWaker flag_waker;
    LaterWorker worker;
    JobList channel_worker;
};

/// A server with something for each service, a client that asks, and another one beside it. What
/// the server does for the first is counted.
class FailureFixture : public FailureParts, public ServerFixture {
public:
    /// Which does the asymmetric work of its channels itself, or has it done.
    explicit FailureFixture(bool has_worker = false, server::ServerConfig used = config())
        : ServerFixture{flag_waker, has_worker ? &channel_worker : nullptr, std::move(used)}
    {
        source_ = server.add_source(memory);
        add_variable("level");
        add_variable("speed");
    }

    [[nodiscard]] static CreateSubscriptionRequest subscription_request()
    {
        CreateSubscriptionRequest request;
        request.requested_publishing_interval = 100;
        request.requested_lifetime_count = 30;
        request.requested_max_keep_alive_count = 3;
        request.publishing_enabled = true;
        return request;
    }
    /// A new Subscription of the client.
    std::uint32_t subscribe()
    {
        const auto made = client.call<CreateSubscriptionResponse>(subscription_request());
        REQUIRE(made);
        return made->subscription_id;
    }
    [[nodiscard]] static CreateMonitoredItemsRequest items_request(std::uint32_t subscription)
    {
        CreateMonitoredItemsRequest request;
        request.subscription_id = subscription;
        request.items_to_create.resize(2);
        request.items_to_create[0].item_to_monitor.node_id = own("level");
        request.items_to_create[1].item_to_monitor.node_id = own("speed");
        for (MonitoredItemCreateRequest& item : request.items_to_create) {
            item.item_to_monitor.attribute_id = 13;
            item.monitoring_mode = MonitoringMode::Reporting;
            item.requested_parameters.sampling_interval = 50;
            item.requested_parameters.queue_size = 5;
        }
        return request;
    }
    /// New items of both Variables.
    std::vector<std::uint32_t> monitor(std::uint32_t subscription)
    {
        const auto made = client.call<CreateMonitoredItemsResponse>(items_request(subscription));
        REQUIRE(made);
        return {made->results[0].monitored_item_id, made->results[1].monitored_item_id};
    }
    void add_method()
    {
        model::NewNode node;
        node.id = own("sum");
        node.browse_name = QualifiedName{1, "sum"};
        node.parent = server.address_space().find(id::ObjectsFolder);
        model::NewMethod method;
        method.input_arguments = {{"a", NodeId{0, id::Int32}, -1, {}, {}},
                                  {"b", NodeId{0, id::Int32}, -1, {}, {}}};
        method.output_arguments = {{"sum", NodeId{0, id::Int32}, -1, {}, {}}};
        method.source = server.add_source(table);
        method.handle = table.add([](server::MethodCall call) {
            const Uncounted in_test;
            call.succeed({Variant{call.input<std::int32_t>(0) + call.input<std::int32_t>(1)}});
        });
        REQUIRE(server.address_space().add_method(node, method));
    }

    [[nodiscard]] static server::ServerConfig config()
    {
        server::ServerConfig config = insecure_config();
        config.has_node_management = true;
        return config;
    }
    [[nodiscard]] static NodeId own(const char* name) { return NodeId{1, name}; }

    /// What is left of a request: sessions, Subscriptions, MonitoredItems, nodes.
    [[nodiscard]] std::vector<std::size_t> counts()
    {
        return {server.session_count(), server.subscription_count(), server.monitored_item_count(),
                server.address_space().node_count()};
    }

    /// Something that the server does.
    template <typename Work>
    void counted(Work work)
    {
        thrown += survives_counted(std::move(work)) ? 0 : 1;
    }
    /// Time passes for the server, its worker and that connection.
    void pass(Duration time, TestClient& asking)
    {
        now += time;
        wall_clock.time.ticks += time.count() / 100;
        for (const auto& job : std::exchange(worker.jobs, {})) {
            counted(job);
        }
        if (std::exchange(flag_waker.is_awake, false)) {
            counted([&] { server.handle_completions(now); });
        }
        if (server.next_deadline() <= now) {
            counted([&] { server.handle_deadline(now); });
        }
        if (asking.connection.next_deadline() <= now) {
            counted([&] { asking.connection.handle_deadline(now); });
        }
        counted([&] {
            while (server.next_changed()) {
            }
        });
        deliver(asking);
    }

    /// Asks, and lets time pass until there is an answer.
    StatusCode ask(TestClient& asking, const FailureCase& asked)
    {
        const std::uint32_t id = asked.send(asking);
        const auto sent = take_output(asking.channel);
        counted([&] { static_cast<void>(asking.connection.feed(sent, now)); });
        deliver(asking);
        StatusCode answer = asked.take(asking, id);
        for (int i = 0; i < 10 && answer == status::Bad_WouldBlock; ++i) {
            pass(std::chrono::milliseconds{100}, asking);
            answer = asked.take(asking, id);
        }
        return answer;
    }
    struct Attempt {
        StatusCode answer;
        bool has_failed;
    };
    /// The client asks while the `k`-th allocation fails, and the ones after it up to `most`. If
    /// its connection ends of that it has another one.
    Attempt attempt(const FailureCase& asked, std::size_t k, std::size_t most)
    {
        fail_allocation(k, most);
        const StatusCode answer = ask(client, asked);
        const bool has_failed = has_allocation_failed();
        fail_allocation(0);
        CHECK(thrown == 0);
        if (client.is_closed()) {
            client = again(client);
        }
        return {answer, has_failed};
    }
    /// What Subscriptions of the client report of data in a while.
    [[nodiscard]] std::vector<MonitoredItemNotification> reported()
    {
        std::vector<MonitoredItemNotification> all;
        for (int i = 0; i < 6; ++i) {
            const std::uint32_t asked = client.send(PublishRequest{});
            pass(std::chrono::milliseconds{100}, client);
            const auto response = client.take<PublishResponse>(asked);
            for (const ExtensionObject& part :
                 response ? response->notification_message.notification_data
                          : Array<ExtensionObject>{}) {
                if (const auto* data = part.get_if<DataChangeNotification>()) {
                    all.insert(all.end(), data->monitored_items.begin(),
                               data->monitored_items.end());
                }
            }
        }
        return all;
    }
    /// A client whose channel is opened with the server's part counted; null if that does not
    /// accept it.
    [[nodiscard]] std::unique_ptr<TestClient> open(channel::SecuritySetting security)
    {
        std::optional<Result<server::Connection>> accepted;
        counted([&] { accepted.emplace(server.connect("192.0.2.1", now)); });
        if (!accepted || !*accepted) {
            return nullptr;
        }
        channel::ChannelEnvironment environment{.random = &random,
                                                .wall_clock = &wall_clock,
                                                .log = &log,
                                                .validator = &validator,
                                                .identity = &client_identity()};
        auto made = std::make_unique<TestClient>(*std::move(*accepted), security, environment, now,
                                                 TestClient::Silent{});
        carry(*made);
        return made;
    }
    /// Lets the client talk with the server until nothing moves, with the server's part counted.
    void carry(TestClient& to)
    {
        for (bool moves = true; moves;) {
            const auto request = take_output(to.channel);
            counted([&] { static_cast<void>(to.connection.feed(request, now)); });
            const bool has_worked = work_once();
            const auto out = to.connection.output();
            const std::vector<std::byte> answer{out.begin(), out.end()};
            counted([&] { to.connection.consume(answer.size()); });
            static_cast<void>(to.channel.feed(answer, now));
            while (to.channel.next_event()) {
            }
            moves = !request.empty() || !answer.empty() || has_worked;
        }
    }
    /// A connection that has taken over the session of one that ended.
    [[nodiscard]] TestClient again(const TestClient& ended)
    {
        TestClient next = ended.is_secure()
                              ? connect("Basic256Sha256", MessageSecurityMode::SignAndEncrypt)
                              : connect();
        next.adopt(ended);
        static_cast<void>(next.activate(ended.is_secure() ? next.user("operator", "operator-secret")
                                                          : TestClient::anonymous()));
        return next;
    }

    /// What was thrown out of the server.
    int thrown{0};
    TestClient client{log_in_manager()};
    TestClient other{log_in()};
    /// One that had something before.
    std::unique_ptr<TestClient> left;

private:
    /// Whom the RolePermissions of namespace 0 let change it.
    [[nodiscard]] TestClient log_in_manager()
    {
        users.everybody.access_level_mask = 0xFF;
        users.everybody.roles = {"ConfigureAdmin"};
        return log_in();
    }
    void add_variable(const char* name)
    {
        model::NewNode node;
        node.id = own(name);
        node.browse_name = QualifiedName{1, name};
        node.parent = server.address_space().find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.source = source_;
        variable.handle = memory.add(1);
        variable.data_type = NodeId{0, id::Int32};
        variable.access_level = model::Access::ReadWrite;
        REQUIRE(server.address_space().add_variable(node, variable));
    }
    /// What the thread of the channels' worker would do, and the server's when it is waked.
    bool work_once()
    {
        bool has_worked = false;
        counted([&] { has_worked = channel_worker.work_once(); });
        if (has_worked) {
            counted([&] { server.handle_completions(now); });
            counted([&] {
                while (server.next_changed()) {
                }
            });
        }
        return has_worked;
    }
    void deliver(TestClient& to)
    {
        const auto out = to.connection.output();
        const std::vector<std::byte> bytes{out.begin(), out.end()};
        counted([&] { to.connection.consume(bytes.size()); });
        static_cast<void>(to.channel.feed(bytes, now));
        to.run();
    }
    std::uint32_t source_{0};
};

} // namespace busbar::test
