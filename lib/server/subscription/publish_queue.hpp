#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <busbar/types/subscription.hpp>

#include "server/session/service.hpp"
#include "server/session/session.hpp"

namespace busbar::server::detail {

class PublishPart;
class Subscription;
class SubscriptionTable;

/// Publish (Part 4, 5.14.5): waits in the queue of its session until a Subscription has something
/// to send.
class PublishOperation final : public OperationOf<PublishRequest> {
public:
    explicit PublishOperation(SubscriptionTable& all) : all_{all} {}
    ~PublishOperation() override;

    void start(ServiceContext& context) override;
    /// Or nobody who has subscribed to State would learn of it.
    [[nodiscard]] bool outlasts_shutdown() const override { return true; }

    struct Message {
        Subscription& subscription;
        std::span<const std::byte> bytes;
        bool more_notifications;
    };
    void answer(const Message& message);
    /// The Subscription is gone.
    void answer_status_change(std::uint32_t subscription_id, std::span<const std::byte> message);
    void refuse(StatusCode status) { fault(status); }
    /// Bytes that a NotificationMessage may have to fit the client's limits, next to a list of so
    /// many available sequence numbers.
    [[nodiscard]] std::size_t room_for_message(std::size_t available) const;

private:
    friend class PublishPart;

    void acknowledge(const Session& session);
    [[nodiscard]] Array<DiagnosticInfo> diagnose(ReturnDiagnostics& diagnostics) const;
    void encode_results(binary::Writer& writer, const Array<DiagnosticInfo>& infos) const;

    SubscriptionTable& all_;
    /// Whose queue it is in.
    PublishPart* part_{nullptr};
    std::vector<StatusCode> results_;
};

/// What a session has of Subscriptions: which are its own, the Publish requests that they may
/// answer, and what there is to tell of those that are gone.
class PublishPart final : public SessionPart {
public:
    /// That of the session, made when it is not there yet.
    [[nodiscard]] static PublishPart& of(Session& session);
    /// The same, or null if it was never made.
    [[nodiscard]] static const PublishPart* find(const Session& session)
    {
        return static_cast<const PublishPart*>(session.publishing.get());
    }
    ~PublishPart() override;

    [[nodiscard]] const std::vector<Subscription*>& subscriptions() const { return subscriptions_; }
    void add(Subscription& subscription) { subscriptions_.push_back(&subscription); }
    /// Without any Subscription the requests that wait answer Bad_NoSubscription.
    void remove(Subscription& subscription);
    /// They are nobody's any more, as the session ends.
    void forget_subscriptions() { subscriptions_.clear(); }

    struct StatusChange {
        std::uint32_t subscription_id;
        std::vector<std::byte> message;
    };
    /// Tells it with the next request; past `most` the oldest is forgotten.
    void add_status_change(std::size_t most, StatusChange change);

    /// False if there is nothing that a request could wait for.
    [[nodiscard]] bool has_anything() const
    {
        return !subscriptions_.empty() || !status_changes_.empty();
    }
    /// Queues the request. Of more than `most` the oldest answers Bad_TooManyPublishRequests.
    void enqueue(PublishOperation& request, std::size_t most);
    /// How many wait.
    [[nodiscard]] std::size_t waiting() const;
    /// Those whose timeoutHint has passed answer Bad_Timeout: to be called before requests are
    /// taken (Part 4, 5.14.1.4, DequeuePublishReq).
    void refuse_overdue(TimePoint now);
    /// The session has moved to the channel of `peer`: what came by another one answers
    /// Bad_SecureChannelClosed, so that it takes no message with it.
    void refuse_others(const Peer& peer);
    /// The request that waits longest; null if there is none. Requests that were answered by
    /// others, for their timeout say, are passed over.
    [[nodiscard]] PublishOperation* next_request();
    /// The same, and takes it out.
    [[nodiscard]] PublishOperation* take_request();
    /// Lets those that wait for a request have what there is (Part 4, 5.14.1.2).
    void serve(TimePoint now);

private:
    friend class PublishOperation;

    void serve_status_changes();
    void forget_finished();
    /// Of the Subscriptions that wait: the highest priority, then the one that waits longest.
    [[nodiscard]] Subscription* next_subscription() const;

    std::vector<Subscription*> subscriptions_;
    /// Oldest first.
    std::vector<PublishOperation*> requests_;
    std::vector<StatusChange> status_changes_;
};

} // namespace busbar::server::detail
