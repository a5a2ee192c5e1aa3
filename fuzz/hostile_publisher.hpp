#pragma once

#include <optional>
#include <vector>

#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "fuzz_script.hpp"
#include "support/rogue_server.hpp"

namespace busbar::fuzz {

/// The Subscriptions of a server as far as its clients can tell: it grants whatever they ask for,
/// and the script says what it publishes. Answers a RogueServer's `other`.
class HostilePublisher {
public:
    using Body = std::vector<std::byte>;

    explicit HostilePublisher(Script& script) : script_{&script} {}

    [[nodiscard]] std::optional<Body> answer(const NodeId& id, binary::Reader& reader)
    {
        for (const auto& [request, handle] : services) {
            if (id.is(request)) {
                return (this->*handle)(reader);
            }
        }
        return std::nullopt;
    }
    /// What a Publish request gets: zeros of the script are the next message of the newest
    /// Subscription, with a value.
    [[nodiscard]] Body publish()
    {
        PublishResponse response;
        response.subscription_id = last_subscription_ - script_->byte() % 4;
        response.more_notifications = script_->byte() % 2 != 0;
        response.notification_message = message(++last_number_);
        const int leap = script_->byte();
        last_number_ += static_cast<std::uint32_t>(leap < 128 ? leap : leap - 256);
        for (int i = script_->byte() % 4; i > 0; --i) {
            response.results.push_back(status());
            response.available_sequence_numbers.push_back(last_number_ - script_->byte());
        }
        return test::body_of(response);
    }

private:
    using Answer = Body (HostilePublisher::*)(binary::Reader&);

    template <typename Request>
    [[nodiscard]] static Request read(binary::Reader& reader)
    {
        Request request;
        decode(reader, request);
        return request;
    }
    [[nodiscard]] StatusCode status()
    {
        static constexpr std::array codes{status::Good,
                                          status::Bad_SubscriptionIdInvalid,
                                          status::Bad_MonitoredItemIdInvalid,
                                          status::Bad_Timeout,
                                          status::Good_SubscriptionTransferred,
                                          status::Bad_TooManyMonitoredItems,
                                          status::Bad_SequenceNumberUnknown,
                                          status::Bad_NodeIdUnknown};
        return codes.at(script_->byte() % codes.size());
    }
    [[nodiscard]] NotificationMessage message(std::uint32_t number)
    {
        NotificationMessage message;
        message.sequence_number = number;
        message.publish_time.ticks = script_->byte();
        for (int parts = 1 + script_->byte() % 3; parts > 0; --parts) {
            if (auto part = notification()) {
                message.notification_data.push_back(*std::move(part));
            }
        }
        return message;
    }
    [[nodiscard]] std::optional<ExtensionObject> notification()
    {
        switch (script_->byte() % 5) {
        case 0: {
            DataChangeNotification data;
            data.monitored_items.push_back({handle(), DataValue{Variant{std::int32_t{1}}}});
            return ExtensionObject::from(std::move(data));
        }
        case 1: {
            EventNotificationList events;
            events.events.push_back({handle(), {Variant{true}}});
            return ExtensionObject::from(std::move(events));
        }
        case 2:
            return ExtensionObject::from(StatusChangeNotification{status(), {}});
        case 3:
            return ExtensionObject::from(SubscriptionAcknowledgement{1, 2}); // no notification
        default:
            return std::nullopt;
        }
    }
    [[nodiscard]] std::uint32_t handle()
    {
        const std::size_t choice = script_->byte();
        return choice < handles_.size() ? handles_[choice] : static_cast<std::uint32_t>(choice);
    }

    Body create(binary::Reader&)
    {
        CreateSubscriptionResponse response;
        response.subscription_id = ++last_subscription_;
        response.revised_publishing_interval = script_->byte() + 100;
        response.revised_lifetime_count = 60;
        response.revised_max_keep_alive_count = script_->byte() + 1U;
        last_number_ = 0;
        return test::body_of(response);
    }
    Body modify(binary::Reader&)
    {
        ModifySubscriptionResponse response;
        response.revised_publishing_interval = 100;
        response.revised_max_keep_alive_count = script_->byte();
        return test::body_of(response);
    }
    Body create_items(binary::Reader& reader)
    {
        CreateMonitoredItemsResponse response;
        for (const auto& item : read<CreateMonitoredItemsRequest>(reader).items_to_create) {
            if (handles_.size() < 256) {
                handles_.push_back(item.requested_parameters.client_handle);
            }
            response.results.push_back({status(), ++last_item_, 100, 1, {}});
        }
        return test::body_of(response);
    }
    Body modify_items(binary::Reader& reader)
    {
        ModifyMonitoredItemsResponse response;
        const auto request = read<ModifyMonitoredItemsRequest>(reader);
        for (std::size_t i = 0; i < request.items_to_modify.size(); ++i) {
            response.results.push_back({status(), 100, 1, {}});
        }
        return test::body_of(response);
    }
    /// A status for each.
    template <typename Request, typename Response, auto list>
    Body statuses(binary::Reader& reader)
    {
        Response response;
        const Request request = read<Request>(reader);
        for (std::size_t i = 0; i < (request.*list).size(); ++i) {
            response.results.push_back(status());
        }
        return test::body_of(response);
    }
    Body link(binary::Reader& reader)
    {
        SetTriggeringResponse response;
        const auto request = read<SetTriggeringRequest>(reader);
        response.add_results.resize(request.links_to_add.size());
        response.remove_results.resize(request.links_to_remove.size());
        return test::body_of(response);
    }
    Body transfer(binary::Reader& reader)
    {
        TransferSubscriptionsResponse response;
        const auto request = read<TransferSubscriptionsRequest>(reader);
        for (std::size_t i = 0; i < request.subscription_ids.size(); ++i) {
            const std::uint32_t number = last_number_ + script_->byte();
            response.results.push_back({status(), {number, number + 1}});
        }
        return test::body_of(response);
    }
    Body republish(binary::Reader& reader)
    {
        const auto request = read<RepublishRequest>(reader);
        if (script_->byte() % 2 == 0) {
            return test::fault(status::Bad_MessageNotAvailable);
        }
        RepublishResponse response;
        response.notification_message = message(request.retransmit_sequence_number);
        return test::body_of(response);
    }
    /// The answer comes when the script says so.
    Body keep(binary::Reader&) { return {}; }

    struct Service {
        std::uint32_t request;
        Answer handle;
    };
    static const std::array<Service, 12> services;

    Script* script_;
    std::uint32_t last_subscription_{0};
    std::uint32_t last_item_{0};
    std::uint32_t last_number_{0};
    std::vector<std::uint32_t> handles_;
};

inline constexpr std::array<HostilePublisher::Service, 12> HostilePublisher::services{{
    {PublishRequest::binary_encoding_id, &HostilePublisher::keep},
    {RepublishRequest::binary_encoding_id, &HostilePublisher::republish},
    {TransferSubscriptionsRequest::binary_encoding_id, &HostilePublisher::transfer},
    {CreateSubscriptionRequest::binary_encoding_id, &HostilePublisher::create},
    {ModifySubscriptionRequest::binary_encoding_id, &HostilePublisher::modify},
    {SetPublishingModeRequest::binary_encoding_id,
     &HostilePublisher::statuses<SetPublishingModeRequest, SetPublishingModeResponse,
                                 &SetPublishingModeRequest::subscription_ids>},
    {DeleteSubscriptionsRequest::binary_encoding_id,
     &HostilePublisher::statuses<DeleteSubscriptionsRequest, DeleteSubscriptionsResponse,
                                 &DeleteSubscriptionsRequest::subscription_ids>},
    {CreateMonitoredItemsRequest::binary_encoding_id, &HostilePublisher::create_items},
    {ModifyMonitoredItemsRequest::binary_encoding_id, &HostilePublisher::modify_items},
    {SetMonitoringModeRequest::binary_encoding_id,
     &HostilePublisher::statuses<SetMonitoringModeRequest, SetMonitoringModeResponse,
                                 &SetMonitoringModeRequest::monitored_item_ids>},
    {DeleteMonitoredItemsRequest::binary_encoding_id,
     &HostilePublisher::statuses<DeleteMonitoredItemsRequest, DeleteMonitoredItemsResponse,
                                 &DeleteMonitoredItemsRequest::monitored_item_ids>},
    {SetTriggeringRequest::binary_encoding_id, &HostilePublisher::link},
}};

} // namespace busbar::fuzz
