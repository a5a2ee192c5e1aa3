#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

/// The state machine of a Subscription, exactly the table of Part 4, 5.14.1.2.
namespace busbar::server::detail {

enum class SubscriptionState : std::uint8_t { Closed, Creating, Normal, Late, KeepAlive };

enum class SubscriptionEvent : std::uint8_t {
    CreateSubscription,
    Created,
    PublishRequest,
    PublishingTimer,
    ModifySubscription,
    SetPublishingMode,
    Republish,
    TransferSubscriptions,
    DeleteSubscriptions,
};

/// The state variables (Part 4, 5.14.1.3) and the results of those functions of 5.14.1.4 that only
/// return a value.
struct SubscriptionVariables {
    bool is_created{false}; // CreateSubscription()
    bool publishing_enabled{false};
    bool publishing_req_queued{false};
    bool more_notifications{false};
    bool notifications_available{false};
    bool message_sent{false};
    std::uint32_t keep_alive_counter{0};
    std::uint32_t max_keep_alive_count{0};
    std::uint32_t lifetime_counter{0};
    bool requested_message_found{false};
    bool session_changed{false};
    bool client_validated{false};
    bool subscription_assigned_to_client{false};
};

/// The actions of a row, in their order. Left out are the actions that the Publish service does
/// once for all Subscriptions of a session, DeleteAckedNotificationMsgs() and
/// EnqueuePublishingReq(), and ReturnResponse(), which every row without refusal has.
enum class SubscriptionAction : std::uint8_t {
    None,
    InitializeSubscription,
    SetMessageSent,
    ClearMessageSent,
    ResetLifetimeCounter,
    ResetKeepAliveCounter,
    DecrementKeepAliveCounter,
    StartPublishingTimer, // and decrements the LifetimeCounter
    ReturnNotifications,  // with the Publish request that is queued first
    ReturnKeepAlive,      // likewise
    UpdateSubscriptionParams,
    SetPublishingEnabled,
    ClearMoreNotifications,
    SetSession,
    DeleteMonitoredItems,
    DeleteClientPublReqQueue,
    IssueStatusChangeNotification,
};

/// One or more states.
class StateSet {
public:
    constexpr StateSet(std::initializer_list<SubscriptionState> states)
    {
        for (const SubscriptionState state : states) {
            bits_ |= 1U << static_cast<unsigned>(state);
        }
    }
    [[nodiscard]] constexpr bool has(SubscriptionState state) const
    {
        return (bits_ >> static_cast<unsigned>(state) & 1U) != 0;
    }

private:
    unsigned bits_{0};
};

struct SubscriptionRow {
    /// Its number in the specification's table. Row 9 is split into three, by the counter's new
    /// value.
    unsigned number;
    StateSet states;
    SubscriptionEvent event;
    bool (*condition)(const SubscriptionVariables&);
    std::array<SubscriptionAction, 5> actions;
    /// If the same, the state does not change.
    SubscriptionState next;
    bool keeps_state;
    /// ReturnNegativeResponse().
    bool is_refusal;
};

/// All rows, in the order in which they are tried.
[[nodiscard]] std::span<const SubscriptionRow> subscription_rows();
/// Returns the row that applies; null if the event has no meaning in this state.
[[nodiscard]] const SubscriptionRow* find_row(SubscriptionState state, SubscriptionEvent event,
                                              const SubscriptionVariables& variables);

} // namespace busbar::server::detail
