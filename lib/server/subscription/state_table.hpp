#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

/// The state machine of a Subscription, which is the table of Part 4, 5.14.1.2 and nothing else.
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

/// The state variables (Part 4, 5.14.1.3) and what the functions of 5.14.1.4 that only answer a
/// question answer.
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

/// What a row does, in this order of the row. Left out is what the Publish service does once for
/// all Subscriptions of a session, namely DeleteAckedNotificationMsgs() and EnqueuePublishingReq(),
/// and ReturnResponse(): a row without refusal has it.
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
    /// Its number in the specification's table. Row 9 is three, by what the counter comes to.
    unsigned number;
    StateSet states;
    SubscriptionEvent event;
    bool (*condition)(const SubscriptionVariables&);
    std::array<SubscriptionAction, 5> actions;
    /// Same: the state stays as it is.
    SubscriptionState next;
    bool keeps_state;
    /// ReturnNegativeResponse().
    bool is_refusal;
};

/// All rows, in the order in which they are tried.
[[nodiscard]] std::span<const SubscriptionRow> subscription_rows();
/// The row that applies; null if the event means nothing in that state.
[[nodiscard]] const SubscriptionRow* find_row(SubscriptionState state, SubscriptionEvent event,
                                              const SubscriptionVariables& variables);

} // namespace busbar::server::detail
