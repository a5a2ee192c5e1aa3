#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "failure_cases.hpp"
#include "support/failing_worlds.hpp"

namespace message_allocation_failure_test {

/// The NotificationMessages of a Subscription when there is no memory to create or to send one:
/// each Notification arrives once and in order, at the latest when it is requested again.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t events_handle = 9;

/// A client that has had the first values of two Variables, and for which three more of each and
/// three events wait.
class MessageWorld : public FailureFixture {
public:
    MessageWorld() : subscription_{subscribe()}
    {
        CreateMonitoredItemsRequest request = items_request(subscription_);
        request.items_to_create[0].requested_parameters.client_handle = 1;
        request.items_to_create[1].requested_parameters.client_handle = 2;
        REQUIRE(client.call<CreateMonitoredItemsResponse>(request));
        request = failing::event_item(subscription_);
        request.items_to_create[0].requested_parameters.client_handle = events_handle;
        REQUIRE(client.call<CreateMonitoredItemsResponse>(request));
        REQUIRE(ask(client, gather()) == status::Good);
        for (std::int32_t value = 2; value <= 4; ++value) {
            memory.set(0, value);
            memory.set(1, value);
            server::Event event;
            event.message = LocalizedText{"a message that does not fit into a small string"};
            event.severity = 500;
            event.source_node = NodeId{0, id::Server};
            REQUIRE(server.raise_event(std::move(event)));
            pass(50ms, client);
        }
    }

    /// A Publish request whose answer is kept; Bad_NoData for a keep-alive.
    [[nodiscard]] FailureCase gather()
    {
        return {failing::publish_something().send,
                [this](TestClient& from, std::uint32_t id) -> StatusCode {
                    auto response = from.take<PublishResponse>(id);
                    if (!response) {
                        return response.error();
                    }
                    NotificationMessage& message = response->notification_message;
                    next_ = message.sequence_number;
                    if (message.notification_data.empty()) {
                        return status::Bad_NoData;
                    }
                    messages_[message.sequence_number] = std::move(message);
                    return status::Good;
                },
                false};
    }
    /// What each item brought, with what is asked for again.
    [[nodiscard]] std::map<std::uint32_t, std::size_t> gather_all()
    {
        StatusCode answer = status::Good;
        for (int i = 0; i < 10 && answer != status::Bad_NoData; ++i) {
            answer = ask(client, gather());
        }
        REQUIRE(answer == status::Bad_NoData);
        for (std::uint32_t number = 1; number < next_; ++number) {
            if (!messages_.contains(number)) {
                RepublishRequest request;
                request.subscription_id = subscription_;
                request.retransmit_sequence_number = number;
                auto response = client.call<RepublishResponse>(request);
                REQUIRE(response);
                messages_[number] = std::move(response->notification_message);
            }
        }
        std::map<std::uint32_t, std::size_t> counts;
        for (const auto& [number, message] : messages_) {
            count(message, counts);
        }
        return counts;
    }

private:
    static void count(const NotificationMessage& message,
                      std::map<std::uint32_t, std::size_t>& counts)
    {
        for (const ExtensionObject& part : message.notification_data) {
            if (const auto* const data = part.get_if<DataChangeNotification>()) {
                for (const MonitoredItemNotification& item : data->monitored_items) {
                    const std::size_t nth = ++counts[item.client_handle];
                    CHECK(item.value.value == Variant{static_cast<std::int32_t>(nth)});
                    CHECK(item.value.status == status::Good);
                }
            } else if (const auto* const list = part.get_if<EventNotificationList>()) {
                counts[events_handle] += list->events.size();
            }
        }
    }

    std::uint32_t subscription_;
    std::map<std::uint32_t, NotificationMessage> messages_;
    /// The number of the last message, and after a keep-alive that of the next.
    std::uint32_t next_{0};
};

/// False if nothing failed.
bool fail_once(std::size_t k, std::size_t most)
{
    MessageWorld world;
    const auto [answer, has_failed] = world.attempt(world.gather(), k, most);
    INFO("allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    CHECK(world.gather_all() ==
          std::map<std::uint32_t, std::size_t>{{1, 4}, {2, 4}, {events_handle, 3}});
    return has_failed;
}

} // namespace

TEST_CASE("what found no memory for its message comes with the next one, all and once")
{
    const std::size_t most = GENERATE(1U, 4U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("Publish", [&](std::size_t k) { return fail_once(k, most); });
}

} // namespace message_allocation_failure_test
