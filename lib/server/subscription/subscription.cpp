#include "subscription.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "notification_message.hpp"
#include "publish_queue.hpp"
#include "server/session/session.hpp"
#include "subscription_table.hpp"

namespace busbar::server::detail {

namespace {

SubscriptionOwner owner_of(const Session& session)
{
    return {session.user,
            session.address,
            session.client_application_uri,
            session.security.mode != MessageSecurityMode::None,
            is_encrypted(session),
            session.locale_ids};
}

} // namespace

Subscription::Subscription(SubscriptionTable& all, std::uint32_t id, Session& session)
    : all_{all}, id_{id}, session_{&session}, since_{all.next_serial()},
      memory_{all.needs().limits.subscriptions.max_subscription_memory, &all.memory()},
      retransmission_{all.needs().limits.subscriptions.max_retransmission_messages, memory_}
{
    share_ =
        &all.shares().enter(session.user, session.address); // last, since it must be left again
}

Subscription::~Subscription()
{
    all_.timers().cancel(*this);
    remove_items(items_.size());
    if (share_ != nullptr) {
        all_.shares().leave(*share_);
    }
}

SubscriptionVariables Subscription::variables(const Input& input) const
{
    SubscriptionVariables v;
    v.is_created = true;
    v.publishing_enabled = publishing_enabled_;
    v.publishing_req_queued =
        session_ != nullptr && PublishPart::of(*session_).next_request() != nullptr;
    // The additional Notifications may have been removed with their items.
    v.more_notifications = more_notifications_ && notifications_available();
    v.notifications_available = notifications_available();
    v.message_sent = message_sent_;
    v.keep_alive_counter = keep_alive_counter_;
    v.max_keep_alive_count = parameters_.max_keep_alive_count;
    v.lifetime_counter = lifetime_counter_;
    v.requested_message_found = input.is_message_found;
    v.session_changed = input.session != session_;
    v.client_validated = input.is_client_validated;
    v.subscription_assigned_to_client = input.session == session_;
    return v;
}

const SubscriptionRow& Subscription::handle(SubscriptionEvent event, const Input& input)
{
    const SubscriptionRow* const row = find_row(state_, event, variables(input));
    // A subscription that is Closed is removed and gets no event; in all other states each event
    // has a row for any values of the variables, as a test shows.
    static constexpr SubscriptionRow nothing{0,    {},  {}, nullptr, {}, SubscriptionState::Closed,
                                             true, true};
    if (row == nullptr) {
        return nothing;
    }
    for (const SubscriptionAction action : row->actions) {
        perform(action, *row, input);
    }
    const State before = std::exchange(state_, row->keeps_state ? state_ : row->next);
    if (state_ == State::Late && before != State::Late) {
        count(&SubscriptionDiagnosticsDataType::late_publish_request_count);
    } else if (state_ == State::KeepAlive && before != State::KeepAlive) {
        count(&SubscriptionDiagnosticsDataType::current_keep_alive_count);
    }
    return *row;
}

void Subscription::count(std::uint32_t SubscriptionDiagnosticsDataType::*counter,
                         std::uint32_t more)
{
    all_.needs().counters.count(counters_, counter, more);
}

void Subscription::perform(SubscriptionAction action, const SubscriptionRow& row,
                           const Input& input)
{
    using A = SubscriptionAction;
    switch (action) {
    case A::None:
    case A::DeleteMonitoredItems: // the table of Subscriptions does these when it removes this
    case A::DeleteClientPublReqQueue:
        break;
    case A::InitializeSubscription:
        parameters_ = *input.parameters;
        publishing_enabled_ = input.publishing_enabled;
        lifetime_counter_ = parameters_.lifetime_count + 1; // the timer decrements it
        keep_alive_counter_ = parameters_.max_keep_alive_count;
        start_publishing_timer(input.now);
        break;
    case A::SetMessageSent:
        message_sent_ = true;
        break;
    case A::ClearMessageSent:
        message_sent_ = false;
        break;
    case A::ResetLifetimeCounter:
        reset_lifetime_counter();
        break;
    case A::ResetKeepAliveCounter:
        keep_alive_counter_ = parameters_.max_keep_alive_count;
        break;
    case A::DecrementKeepAliveCounter:
        --keep_alive_counter_;
        break;
    case A::StartPublishingTimer:
        start_publishing_timer(input.now);
        break;
    case A::ReturnNotifications:
        return_notifications();
        break;
    case A::ReturnKeepAlive:
        return_keep_alive();
        break;
    case A::UpdateSubscriptionParams:
        update_parameters(*input.parameters, input.now);
        count(&SubscriptionDiagnosticsDataType::modify_count);
        break;
    case A::SetPublishingEnabled:
        set_publishing_enabled(input.publishing_enabled);
        break;
    case A::ClearMoreNotifications:
        more_notifications_ = false;
        break;
    case A::SetSession:
        set_session(*input.session);
        break;
    case A::IssueStatusChangeNotification:
        issue_status_change(row.event == SubscriptionEvent::TransferSubscriptions
                                ? status::Good_SubscriptionTransferred
                                : status::Bad_Timeout);
        break;
    }
}

void Subscription::expire(TimePoint now)
{
    if (session_ != nullptr) {
        PublishPart::of(*session_).refuse_overdue(now);
    }
    // Re-arm first, so that a throw below cannot stop the timer.
    all_.timers().set(*this, now + parameters_.publishing_interval);
    handle(SubscriptionEvent::PublishingTimer, {.now = now});
    if (state_ == State::Closed) {
        all_.remove(*this);
    }
}

void Subscription::start_publishing_timer(TimePoint now)
{
    // Counted from the time that was due, so that cycles do not drift; missed cycles are not
    // repeated.
    if (next_publishing_ == no_deadline) {
        next_publishing_ = end_of_first_cycle(now);
    } else {
        const TimePoint in_step = next_publishing_ + parameters_.publishing_interval;
        next_publishing_ = in_step > now ? in_step : now + parameters_.publishing_interval;
    }
    all_.timers().set(*this, next_publishing_);
    --lifetime_counter_;
}

/// Together with the session's latest Subscription of the same interval: messages that are ready in
/// one turn are sent at once, which costs a session of many Subscriptions a fraction of the system
/// calls. The first cycle is shorter for it, never longer. No more come together than there are
/// Publish requests for, if a client has half as many waiting as it may.
TimePoint Subscription::end_of_first_cycle(TimePoint now) const
{
    const TimePoint whole = now + parameters_.publishing_interval;
    const PublishPart* const part = session_ != nullptr ? PublishPart::find(*session_) : nullptr;
    if (part == nullptr) {
        return whole;
    }
    const auto& all = part->subscriptions();
    const auto latest = std::find_if(all.rbegin(), all.rend(), [this](const Subscription* other) {
        return other != this &&
               other->parameters_.publishing_interval == parameters_.publishing_interval;
    });
    if (latest == all.rend()) {
        return whole;
    }
    const TimePoint theirs = (*latest)->next_publishing_;
    const auto together = std::count_if(all.begin(), all.end(), [&](const Subscription* other) {
        return other->next_publishing_ == theirs;
    });
    const auto most = all_.needs().limits.subscriptions.max_publish_requests / 2;
    return theirs > now && theirs < whole && static_cast<std::size_t>(together) < most ? theirs
                                                                                       : whole;
}

void Subscription::set_publishing_enabled(bool is_enabled)
{
    if (std::exchange(publishing_enabled_, is_enabled) != is_enabled) {
        count(is_enabled ? &SubscriptionDiagnosticsDataType::enable_count
                         : &SubscriptionDiagnosticsDataType::disable_count);
    }
}

/// Part 4, 5.14.3.1: settings apply at once.
void Subscription::update_parameters(const SubscriptionParameters& parameters, TimePoint now)
{
    const bool is_other_interval =
        parameters.publishing_interval != parameters_.publishing_interval;
    parameters_ = parameters;
    keep_alive_counter_ = std::min(keep_alive_counter_, parameters.max_keep_alive_count);
    reset_lifetime_counter();
    if (is_other_interval) {
        next_publishing_ = end_of_first_cycle(now);
        all_.timers().set(*this, next_publishing_);
    }
}

std::uint32_t Subscription::next_sequence_number() const
{
    return sequence_number_ == UINT32_MAX ? 1 : sequence_number_ + 1;
}

bool Subscription::wants_publish_request() const
{
    // A late one waits for its data: ItemReviews serves it.
    return !is_in_review() &&
           (state_ == State::Late || (state_ == State::Normal && publishing_enabled_ &&
                                      more_notifications_ && notifications_available()));
}

/// Part 4, 5.14.1.4: continues while there are Notifications and requests.
void Subscription::return_notifications()
{
    if (session_ == nullptr) {
        return; // there is no request
    }
    PublishPart& part = PublishPart::of(*session_);
    const ServerLimits& limits = all_.needs().limits;
    // The responses to all requests of a session must fit the connection's queue together.
    const std::size_t most_bytes =
        std::min(limits.subscriptions.max_message_size,
                 limits.max_send_queue /
                     std::max<std::size_t>(limits.subscriptions.max_publish_requests, 1));
    do {
        PublishOperation* const request = part.take_request();
        if (request == nullptr) {
            return;
        }
        // It may have more to send endlessly: among equal priorities it is the others' turn now.
        last_served_ = all_.next_serial();
        // Without memory the Notifications wait for the next request.
        busbar::detail::Undo undo{[&] {
            more_notifications_ = notifications_available();
            request->refuse(status::Bad_OutOfMemory);
        }};
        retransmission_.make_place(); // before anything is taken
        count(&SubscriptionDiagnosticsDataType::publish_request_count);
        const DateTime now = all_.needs().wall_time();
        const std::size_t room = request->room_for_message(retransmission_.size() + 1);
        auto message = write_notifications(next_sequence_number(), now, ready_data_, ready_events_,
                                           {parameters_.max_notifications_per_publish,
                                            std::min(most_bytes, room),
                                            std::min(room, limits.max_send_queue / 2)},
                                           events_first_);
        more_notifications_ = notifications_available();
        if (!message) {
            undo.keep();
            request->refuse(message.error());
            if (message.error() == status::Bad_OutOfMemory) {
                return;
            }
            continue;
        }
        const std::span<const std::byte> bytes{*message};
        // The bytes keep their place.
        const std::uint32_t discarded = retransmission_.add(next_sequence_number(), *message);
        sequence_number_ = next_sequence_number();
        count(&SubscriptionDiagnosticsDataType::discarded_message_count, discarded);
        request->answer({*this, bytes, more_notifications_});
        undo.keep();
    } while (more_notifications_);
}

void Subscription::return_keep_alive()
{
    if (session_ == nullptr) {
        return;
    }
    if (PublishOperation* const request = PublishPart::of(*session_).take_request()) {
        busbar::detail::Undo undo{[&] { request->refuse(status::Bad_OutOfMemory); }};
        count(&SubscriptionDiagnosticsDataType::publish_request_count);
        const auto message = write_keep_alive(next_sequence_number(), all_.needs().wall_time());
        request->answer({*this, message, false});
        undo.keep();
    }
    last_served_ = all_.next_serial();
}

/// Without memory the client could not be told. An ending Subscription then continues until its
/// next publishing interval, since nothing else would report its end.
void Subscription::issue_status_change(StatusCode status)
{
    if (session_ == nullptr) {
        return;
    }
    const auto issue = [&] {
        PublishPart::of(*session_).add_status_change(
            all_.needs().limits.subscriptions.max_status_changes,
            {id_, write_status_change(next_sequence_number(), all_.needs().wall_time(), status)});
    };
    if (status.is_bad()) {
        issue();
    } else { // a client that lost it to another session would get the request refused
        busbar::detail::attempt(issue);
    }
}

void Subscription::set_session(Session& session)
{
    const UserIdentity before = user();
    PublishPart& part = PublishPart::of(session);
    Share& share = all_.shares().enter(session.user, session.address, items_.size());
    busbar::detail::Undo left{[&] { all_.shares().leave(share, items_.size()); }};
    part.add(*this);
    left.keep();
    if (session_ != nullptr) {
        PublishPart::of(*session_).remove(*this);
    }
    session_ = &session;
    owner_.reset();
    all_.shares().leave(*std::exchange(share_, &share), items_.size());
    if (SubscriptionObserver* const observer = all_.needs().observer) {
        busbar::detail::attempt([&] { observer->moved(*this); });
    }
    if (!(before == session.user)) {
        note_user_change();
    }
}

const SubscriptionOwner& Subscription::kept_owner() const
{
    static const SubscriptionOwner nobody; // after an end without memory
    return owner_ != nullptr ? *owner_ : nobody;
}

SubscriptionOwner Subscription::owner() const
{
    return session_ != nullptr ? owner_of(*session_) : kept_owner();
}

const UserIdentity& Subscription::user() const
{
    return session_ != nullptr ? session_->user : kept_owner().user;
}

std::span<const std::string> Subscription::locales() const
{
    return session_ != nullptr ? session_->locale_ids : kept_owner().locale_ids;
}

NodeRights Subscription::rights() const
{
    MessageSecurityMode mode = MessageSecurityMode::None;
    if (session_ != nullptr) {
        mode = session_->security.mode;
    } else if (kept_owner().is_signed) {
        mode = kept_owner().is_encrypted ? MessageSecurityMode::SignAndEncrypt
                                         : MessageSecurityMode::Sign;
    }
    return {all_.needs().space, user(), all_.needs().environment.access, mode};
}

bool Subscription::is_encrypted() const
{
    return session_ != nullptr ? detail::is_encrypted(*session_) : kept_owner().is_encrypted;
}

void Subscription::detach(std::unique_ptr<SubscriptionOwner> owner)
{
    owner_ = std::move(owner);
    session_ = nullptr;
    since_ = all_.next_serial();
}

void Subscription::update_share()
{
    Share& next = all_.shares().enter(session_->user, session_->address, items_.size());
    all_.shares().leave(*std::exchange(share_, &next), items_.size());
}

void Subscription::give_way(TimePoint now)
{
    busbar::detail::Undo undo{[this, before = lifetime_counter_] { lifetime_counter_ = before; }};
    lifetime_counter_ = 1; // row 27
    handle(SubscriptionEvent::PublishingTimer, {.now = now});
    undo.keep();
}

void Subscription::end()
{
    all_.timers().cancel(*this);
    if (session_ != nullptr) {
        PublishPart::of(*session_).remove(*this);
        busbar::detail::attempt(
            [&] { detach(std::make_unique<SubscriptionOwner>(owner_of(*session_))); });
        session_ = nullptr;
    }
    all_.shares().leave(*std::exchange(share_, nullptr), items_.size());
}

} // namespace busbar::server::detail
