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
    /// Otherwise clients that subscribe to State would not learn of it.
    [[nodiscard]] bool outlasts_shutdown() const override { return true; }

    struct Message {
        Subscription& subscription;
        std::span<const std::byte> bytes;
        bool more_notifications;
    };
    void answer(const Message& message);
    /// Reports that the Subscription has ended.
    void answer_status_change(std::uint32_t subscription_id, std::span<const std::byte> message);
    void refuse(StatusCode status) { fault(status); }
    /// Returns the maximum size of a NotificationMessage that fits the client's limits, next to a
    /// list of this many available sequence numbers.
    [[nodiscard]] std::size_t room_for_message(std::size_t available) const;

private:
    friend class PublishPart;

    void acknowledge(const Session& session);
    [[nodiscard]] Array<DiagnosticInfo> diagnose(ReturnDiagnostics& diagnostics) const;
    void encode_results(binary::Writer& writer, const Array<DiagnosticInfo>& infos) const;

    SubscriptionTable& all_;
    /// The owner of the queue that it is in.
    PublishPart* part_{nullptr};
    std::vector<StatusCode> results_;
};

/// A session's part of Subscriptions: its own ones, the Publish requests that they may answer, and
/// the pending reports about those that have ended.
class PublishPart final : public SessionPart {
public:
    /// Returns the session's, created on first use.
    [[nodiscard]] static PublishPart& of(Session& session);
    /// Returns the session's, or null if it was never created.
    [[nodiscard]] static const PublishPart* find(const Session& session)
    {
        return static_cast<const PublishPart*>(session.publishing.get());
    }
    ~PublishPart() override;

    [[nodiscard]] const std::vector<Subscription*>& subscriptions() const { return subscriptions_; }
    void add(Subscription& subscription) { subscriptions_.push_back(&subscription); }
    /// After the last Subscription the waiting requests answer Bad_NoSubscription.
    void remove(Subscription& subscription);
    /// The session ends and does not own them any more.
    void forget_subscriptions() { subscriptions_.clear(); }

    struct StatusChange {
        std::uint32_t subscription_id;
        std::vector<std::byte> message;
    };
    /// Reports it with the next request; past `most` the oldest is dropped.
    void add_status_change(std::size_t most, StatusChange change);

    /// Returns false if there is nothing that a request could wait for.
    [[nodiscard]] bool has_anything() const
    {
        return !subscriptions_.empty() || !status_changes_.empty();
    }
    /// Queues the request. Past `most` the oldest answers Bad_TooManyPublishRequests.
    void enqueue(PublishOperation& request, std::size_t most);
    /// Number of waiting requests.
    [[nodiscard]] std::size_t waiting() const;
    /// Answers requests whose timeoutHint has passed with Bad_Timeout: call it before requests are
    /// taken (Part 4, 5.14.1.4, DequeuePublishReq).
    void refuse_overdue(TimePoint now);
    /// The session has moved to the channel of `peer`: requests of other channels answer
    /// Bad_SecureChannelClosed, so that no message is sent with them.
    void refuse_others(const Peer& peer);
    /// Returns the request that has waited longest; null if there is none. Skips requests that were
    /// answered elsewhere, for example for their timeout.
    [[nodiscard]] PublishOperation* next_request();
    /// Returns it and removes it.
    [[nodiscard]] PublishOperation* take_request();
    /// Serves the Subscriptions that wait for a request (Part 4, 5.14.1.2).
    void serve(TimePoint now);

private:
    friend class PublishOperation;

    void serve_status_changes();
    void forget_finished();
    /// Returns the waiting Subscription with the highest priority that has waited longest.
    [[nodiscard]] Subscription* next_subscription() const;

    std::vector<Subscription*> subscriptions_;
    /// The oldest first.
    std::vector<PublishOperation*> requests_;
    std::vector<StatusChange> status_changes_;
};

} // namespace busbar::server::detail
