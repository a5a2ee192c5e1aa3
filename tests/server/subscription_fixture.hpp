#pragma once

#include <string>
#include <vector>

#include <busbar/server/memory_source.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "support/server_fixture.hpp"

namespace busbar::test {

inline constexpr Duration cycle = std::chrono::milliseconds{100};

/// Sources outlive the server.
struct SubscriptionParts {
    FixedWallClock source_clock;
    server::MemorySource memory{source_clock};
};

/// A server with variables in memory, and clients that subscribe to them.
class SubscriptionFixture : public SubscriptionParts, public ServerFixture {
public:
    explicit SubscriptionFixture(const server::SubscriptionLimits& limits = small_limits())
        : ServerFixture{config(limits)}, source_{server.add_source(memory)}
    {
    }
    explicit SubscriptionFixture(model::AddressSpace space)
        : ServerFixture{config(small_limits()), std::move(space)}, source_{
                                                                       server.add_source(memory)}
    {
    }
    [[nodiscard]] static server::SubscriptionLimits small_limits()
    {
        server::SubscriptionLimits limits;
        limits.max_publish_requests = 5;
        return limits;
    }
    [[nodiscard]] static server::ServerConfig config(const server::SubscriptionLimits& limits)
    {
        server::ServerConfig config = insecure_config();
        config.limits.subscriptions = limits;
        return config;
    }

    /// A variable of the memory source.
    NodeId add_variable(const char* name, Variant value, std::uint32_t data_type = id::Int32,
                        std::int32_t value_rank = -1)
    {
        model::NewVariable variable;
        variable.source = source_;
        variable.handle = memory.add(std::move(value));
        variable.data_type = NodeId{0, data_type};
        variable.value_rank = value_rank;
        handles_.push_back(variable.handle);
        return add_variable(name, variable);
    }
    NodeId add_variable(const char* name, const model::NewVariable& variable)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_variable(node, variable));
        return node.id;
    }
    /// Gives the variable that was added as the n-th its value.
    void set(std::size_t variable, Variant value, StatusCode status = {})
    {
        source_clock.time = wall_clock.time;
        memory.set(handles_[variable], std::move(value), status);
    }

    [[nodiscard]] static CreateSubscriptionRequest subscription_request(double interval = 100)
    {
        CreateSubscriptionRequest request;
        request.requested_publishing_interval = interval;
        request.requested_lifetime_count = 30;
        request.requested_max_keep_alive_count = 3;
        request.publishing_enabled = true;
        return request;
    }
    /// The new Subscription's id.
    std::uint32_t subscribe(TestClient& client,
                            const CreateSubscriptionRequest& request = subscription_request())
    {
        const auto response = client.call<CreateSubscriptionResponse>(request);
        REQUIRE(response);
        return response->subscription_id;
    }

    [[nodiscard]] static MonitoredItemCreateRequest item_request(const NodeId& node,
                                                                 std::uint32_t client_handle = 1)
    {
        MonitoredItemCreateRequest item;
        item.item_to_monitor.node_id = node;
        item.item_to_monitor.attribute_id = 13;
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.client_handle = client_handle;
        item.requested_parameters.sampling_interval = 50;
        item.requested_parameters.queue_size = 1;
        item.requested_parameters.discard_oldest = true;
        return item;
    }
    static Result<CreateMonitoredItemsResponse>
    create_items(TestClient& client, std::uint32_t subscription,
                 std::initializer_list<MonitoredItemCreateRequest> items,
                 TimestampsToReturn timestamps = TimestampsToReturn::Neither)
    {
        CreateMonitoredItemsRequest request;
        request.subscription_id = subscription;
        request.timestamps_to_return = timestamps;
        request.items_to_create = items;
        return client.call<CreateMonitoredItemsResponse>(request);
    }
    static MonitoredItemCreateResult
    monitor(TestClient& client, std::uint32_t subscription, const MonitoredItemCreateRequest& item,
            TimestampsToReturn timestamps = TimestampsToReturn::Neither)
    {
        const auto response = create_items(client, subscription, {item}, timestamps);
        REQUIRE(response);
        REQUIRE(response->results.size() == 1);
        return response->results[0];
    }
    static StatusCode set_mode(TestClient& client, std::uint32_t subscription, std::uint32_t item,
                               MonitoringMode mode)
    {
        SetMonitoringModeRequest request;
        request.subscription_id = subscription;
        request.monitoring_mode = mode;
        request.monitored_item_ids = {item};
        const auto response = client.call<SetMonitoringModeResponse>(request);
        return response ? response->results[0] : response.error();
    }
    static StatusCode set_publishing(TestClient& client, std::uint32_t subscription, bool enabled)
    {
        SetPublishingModeRequest request;
        request.publishing_enabled = enabled;
        request.subscription_ids = {subscription};
        const auto response = client.call<SetPublishingModeResponse>(request);
        return response ? response->results[0] : response.error();
    }
    static StatusCode remove(TestClient& client, std::uint32_t subscription)
    {
        DeleteSubscriptionsRequest request;
        request.subscription_ids = {subscription};
        const auto response = client.call<DeleteSubscriptionsResponse>(request);
        return response ? response->results[0] : response.error();
    }
    static TransferResult transfer(TestClient& client, std::uint32_t subscription,
                                   bool sends_initial_values = false)
    {
        TransferSubscriptionsRequest request;
        request.subscription_ids = {subscription};
        request.send_initial_values = sends_initial_values;
        const auto response = client.call<TransferSubscriptionsResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    static Result<RepublishResponse> republish(TestClient& client, std::uint32_t subscription,
                                               std::uint32_t sequence_number)
    {
        RepublishRequest request;
        request.subscription_id = subscription;
        request.retransmit_sequence_number = sequence_number;
        return client.call<RepublishResponse>(request);
    }

    static std::uint32_t
    publish(TestClient& client,
            std::initializer_list<SubscriptionAcknowledgement> acknowledgements = {})
    {
        PublishRequest request;
        request.subscription_acknowledgements = acknowledgements;
        return client.send(request);
    }
    /// Bad_WouldBlock while the request waits.
    static Result<PublishResponse> take(TestClient& client, std::uint32_t request)
    {
        return client.take<PublishResponse>(request);
    }
    static StatusCode status_of(TestClient& client, std::uint32_t request)
    {
        const auto response = take(client, request);
        return response ? StatusCode{} : response.error();
    }
    /// What data a message has.
    static std::vector<MonitoredItemNotification> data(const NotificationMessage& message)
    {
        std::vector<MonitoredItemNotification> all;
        for (const ExtensionObject& part : message.notification_data) {
            if (const auto* changes = part.get_if<DataChangeNotification>()) {
                all.insert(all.end(), changes->monitored_items.begin(),
                           changes->monitored_items.end());
            }
        }
        return all;
    }
    /// Publishes, lets `time` pass and gives the data that came, with an earlier request too.
    std::vector<MonitoredItemNotification> next_data(TestClient& client, Duration time)
    {
        publish(client);
        advance(time);
        client.run();
        std::vector<MonitoredItemNotification> all;
        while (!client.messages.empty()) {
            const auto response = take(client, client.messages.front().request_id);
            const auto more = response ? data(response->notification_message)
                                       : std::vector<MonitoredItemNotification>{};
            all.insert(all.end(), more.begin(), more.end());
        }
        return all;
    }
    static StatusCode status_change(const NotificationMessage& message)
    {
        if (message.notification_data.size() != 1) {
            return status::Bad_NotFound;
        }
        const auto* change = message.notification_data[0].get_if<StatusChangeNotification>();
        return change != nullptr ? change->status : StatusCode{status::Bad_NotFound};
    }

private:
    std::uint32_t source_{0};
    std::vector<std::uint64_t> handles_;
};

} // namespace busbar::test
