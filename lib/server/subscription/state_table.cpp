#include "state_table.hpp"

#include <algorithm>

namespace busbar::server::detail {

namespace {

using State = SubscriptionState;
using E = SubscriptionEvent;
using Variables = SubscriptionVariables;
using A = SubscriptionAction;
using Condition = bool (*)(const Variables&);
using Actions = std::array<A, 5>;

constexpr StateSet living{State::Normal, State::Late, State::KeepAlive};

constexpr bool always(const Variables&)
{
    return true;
}
constexpr bool has_nothing_to_report(const Variables& v)
{
    return !v.publishing_enabled || !v.notifications_available;
}
constexpr bool has_something_to_report(const Variables& v)
{
    return v.publishing_enabled && v.notifications_available;
}

constexpr SubscriptionRow go(unsigned number, StateSet states, E event, Condition condition,
                             Actions actions, State next)
{
    return {number, states, event, condition, actions, next, false, false};
}
constexpr SubscriptionRow stay(unsigned number, StateSet states, E event, Condition condition,
                               Actions actions)
{
    return {number, states, event, condition, actions, State::Closed, true, false};
}
constexpr SubscriptionRow refuse(SubscriptionRow row)
{
    row.is_refusal = true;
    return row;
}

// Rows 6 to 17 ignore the LifetimeCounter; row 27 is tried before them.
constexpr std::array rows{
    go(1, {State::Closed}, E::CreateSubscription, always, {}, State::Creating),
    refuse(go(
        2, {State::Creating}, E::Created, [](const Variables& v) { return !v.is_created; }, {},
        State::Closed)),
    go(
        3, {State::Creating}, E::Created, [](const Variables& v) { return v.is_created; },
        {A::InitializeSubscription, A::ClearMessageSent}, State::Normal),

    go(
        27, living, E::PublishingTimer, [](const Variables& v) { return v.lifetime_counter == 1; },
        {A::DeleteMonitoredItems, A::IssueStatusChangeNotification}, State::Closed),

    stay(4, {State::Normal}, E::PublishRequest,
         [](const Variables& v) { return !v.publishing_enabled || !v.more_notifications; }, {}),
    stay(5, {State::Normal}, E::PublishRequest,
         [](const Variables& v) { return v.publishing_enabled && v.more_notifications; },
         {A::ResetLifetimeCounter, A::ReturnNotifications, A::SetMessageSent}),
    stay(6, {State::Normal}, E::PublishingTimer,
         [](const Variables& v) { return v.publishing_req_queued && has_something_to_report(v); },
         {A::ResetLifetimeCounter, A::StartPublishingTimer, A::ReturnNotifications,
          A::SetMessageSent}),
    stay(7, {State::Normal}, E::PublishingTimer,
         [](const Variables& v) {
             return v.publishing_req_queued && !v.message_sent && has_nothing_to_report(v);
         },
         {A::ResetLifetimeCounter, A::StartPublishingTimer, A::ReturnKeepAlive, A::SetMessageSent}),
    go(
        8, {State::Normal}, E::PublishingTimer,
        [](const Variables& v) {
            return !v.publishing_req_queued && (!v.message_sent || has_something_to_report(v));
        },
        {A::StartPublishingTimer}, State::Late),
    // This cycle is the first without a message, and is counted (Errata 1.04.8 and 1.05).
    go(
        9, {State::Normal}, E::PublishingTimer,
        [](const Variables& v) {
            return v.message_sent && has_nothing_to_report(v) && v.max_keep_alive_count != 1;
        },
        {A::StartPublishingTimer, A::ResetKeepAliveCounter, A::DecrementKeepAliveCounter},
        State::KeepAlive),
    // A count of 1 ends here, and no row of KEEPALIVE handles a counter of 0: the actions of rows
    // 15 and 17 are due at once.
    go(
        9, {State::Normal}, E::PublishingTimer,
        [](const Variables& v) {
            return v.message_sent && has_nothing_to_report(v) && v.max_keep_alive_count == 1 &&
                   v.publishing_req_queued;
        },
        {A::ResetLifetimeCounter, A::StartPublishingTimer, A::ReturnKeepAlive,
         A::ResetKeepAliveCounter},
        State::KeepAlive),
    go(
        9, {State::Normal}, E::PublishingTimer,
        [](const Variables& v) {
            return v.message_sent && has_nothing_to_report(v) && v.max_keep_alive_count == 1 &&
                   !v.publishing_req_queued;
        },
        {A::StartPublishingTimer}, State::Late),

    go(
        10, {State::Late}, E::PublishRequest,
        [](const Variables& v) {
            return v.publishing_enabled && (v.notifications_available || v.more_notifications);
        },
        {A::ResetLifetimeCounter, A::ReturnNotifications, A::SetMessageSent}, State::Normal),
    go(
        11, {State::Late}, E::PublishRequest,
        [](const Variables& v) {
            return !v.publishing_enabled || (!v.notifications_available && !v.more_notifications);
        },
        // The new count is not in the table: without it the rest of row 17 would send one more with
        // the next cycle, and 5.14.1.1 counts cycles between messages.
        {A::ResetLifetimeCounter, A::ReturnKeepAlive, A::SetMessageSent, A::ResetKeepAliveCounter},
        State::KeepAlive),
    stay(12, {State::Late}, E::PublishingTimer, always, {A::StartPublishingTimer}),

    stay(13, {State::KeepAlive}, E::PublishRequest, always, {}),
    go(
        14, {State::KeepAlive}, E::PublishingTimer,
        [](const Variables& v) { return has_something_to_report(v) && v.publishing_req_queued; },
        {A::ResetLifetimeCounter, A::StartPublishingTimer, A::ReturnNotifications,
         A::SetMessageSent},
        State::Normal),
    stay(15, {State::KeepAlive}, E::PublishingTimer,
         [](const Variables& v) {
             return v.publishing_req_queued && v.keep_alive_counter == 1 &&
                    has_nothing_to_report(v);
         },
         {A::ResetLifetimeCounter, A::StartPublishingTimer, A::ReturnKeepAlive,
          A::ResetKeepAliveCounter}),
    stay(16, {State::KeepAlive}, E::PublishingTimer,
         [](const Variables& v) { return v.keep_alive_counter > 1 && has_nothing_to_report(v); },
         {A::StartPublishingTimer, A::DecrementKeepAliveCounter}),
    go(
        17, {State::KeepAlive}, E::PublishingTimer,
        [](const Variables& v) {
            return !v.publishing_req_queued &&
                   (v.keep_alive_counter == 1 || has_something_to_report(v));
        },
        {A::StartPublishingTimer}, State::Late),

    stay(18, living, E::ModifySubscription, always,
         {A::ResetLifetimeCounter, A::UpdateSubscriptionParams}),
    stay(19, living, E::SetPublishingMode, always,
         {A::ResetLifetimeCounter, A::SetPublishingEnabled, A::ClearMoreNotifications}),
    stay(20, living, E::Republish, [](const Variables& v) { return v.requested_message_found; },
         {A::ResetLifetimeCounter}),
    refuse(stay(21, living, E::Republish,
                [](const Variables& v) { return !v.requested_message_found; },
                {A::ResetLifetimeCounter})),
    refuse(stay(22, living, E::TransferSubscriptions,
                [](const Variables& v) { return !v.session_changed; }, {A::ResetLifetimeCounter})),
    stay(23, living, E::TransferSubscriptions,
         [](const Variables& v) { return v.session_changed && v.client_validated; },
         {A::IssueStatusChangeNotification, A::SetSession, A::ResetLifetimeCounter}),
    refuse(stay(24, living, E::TransferSubscriptions,
                [](const Variables& v) { return v.session_changed && !v.client_validated; }, {})),
    go(
        25, living, E::DeleteSubscriptions,
        [](const Variables& v) { return v.subscription_assigned_to_client; },
        {A::DeleteMonitoredItems, A::DeleteClientPublReqQueue}, State::Closed),
    refuse(stay(26, living, E::DeleteSubscriptions,
                [](const Variables& v) { return !v.subscription_assigned_to_client; },
                {A::ResetLifetimeCounter})),
};

} // namespace

std::span<const SubscriptionRow> subscription_rows()
{
    return rows;
}

const SubscriptionRow* find_row(SubscriptionState state, SubscriptionEvent event,
                                const SubscriptionVariables& variables)
{
    const auto* const found = std::find_if(rows.begin(), rows.end(), [&](const auto& row) {
        return row.event == event && row.states.has(state) && row.condition(variables);
    });
    return found == rows.end() ? nullptr : found;
}

} // namespace busbar::server::detail
