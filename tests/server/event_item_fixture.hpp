#pragma once

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "event_fixture.hpp"
#include "subscription_fixture.hpp"

namespace busbar::test {

/// A client with a Subscription whose items watch notifiers.
struct EventFixture : SubscriptionFixture {
    static constexpr Duration cycle = std::chrono::milliseconds{100};

    explicit EventFixture(const server::SubscriptionLimits& limits = small_limits())
        : SubscriptionFixture{limits}
    {
    }

    /// An item of the Server object that selects the message.
    static MonitoredItemCreateRequest event_request(EventFilter filter = selecting({"Message"}),
                                                    NodeId notifier = NodeId{0, id::Server})
    {
        auto item = item_request(notifier, 7);
        item.item_to_monitor.attribute_id = 12;
        item.requested_parameters.queue_size = 10;
        item.requested_parameters.filter = ExtensionObject::from(std::move(filter));
        return item;
    }
    void raise(const char* message, std::uint16_t severity = 1,
               const NodeId& source = NodeId{0, id::Server})
    {
        server::Event event;
        event.message = LocalizedText{message};
        event.severity = severity;
        event.source_node = source;
        CHECK(server.raise_event(std::move(event)));
        server.handle_completions(now);
    }
    /// The events of the next message.
    std::vector<EventFieldList> next_events(TestClient& to)
    {
        const std::uint32_t request = publish(to);
        advance(cycle);
        const auto response = take(to, request);
        std::vector<EventFieldList> all;
        if (!response) {
            return all;
        }
        for (const ExtensionObject& part : response->notification_message.notification_data) {
            if (const auto* list = part.get_if<EventNotificationList>()) {
                all.insert(all.end(), list->events.begin(), list->events.end());
            }
        }
        return all;
    }
    /// The first field of each, a text.
    std::vector<std::string> next_messages(TestClient& to)
    {
        std::vector<std::string> messages;
        for (const EventFieldList& event : next_events(to)) {
            messages.push_back(
                event.event_fields[0].value_or<LocalizedText>(LocalizedText{}).text.str());
        }
        return messages;
    }
    NodeId add_notifier(const char* name, std::uint8_t event_notifier = 1)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = server.address_space().find(id::ObjectsFolder);
        model::NewObject object;
        object.event_notifier = event_notifier;
        REQUIRE(server.address_space().add_object(node, object));
        return node.id;
    }
    void link(const NodeId& above, std::uint32_t type, const NodeId& below)
    {
        auto& space = server.address_space();
        REQUIRE(space.add_reference(space.find(above), NodeId{0, type}, space.find(below)));
    }

    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
};

} // namespace busbar::test
