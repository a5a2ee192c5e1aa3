#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include <busbar/types/subscription.hpp>

namespace busbar::client::detail {

/// The Publish requests that wait at the server, and the acknowledgements that wait for the next
/// one (Part 4, 5.14.5). It sends nothing: who does tells it what became of each request.
///
/// An acknowledgement is kept until a request that carries it was answered, or its Subscription is
/// forgotten.
class PublishQueue {
public:
    using Acknowledgements = Array<SubscriptionAcknowledgement>;

    struct Outgoing {
        std::uint64_t number{0}; // names the request from now on
        Acknowledgements acknowledgements;
    };

    /// `max_requests`: as many wait at most, at least one.
    explicit PublishQueue(std::size_t max_requests);

    /// Another session: the server may allow as many requests as are configured.
    void begin_session();
    /// No request will be answered any more.
    void end_session();
    /// Forgets all requests and acknowledgements.
    void clear();

    /// How many more requests shall go out if `wanted` in all shall wait.
    [[nodiscard]] std::size_t missing(std::size_t wanted) const;
    /// The next request, with the oldest acknowledgements: 1,000 at most.
    [[nodiscard]] Outgoing add();
    /// The server carried the request out; what it acknowledged, with SubscriptionId 0 where that
    /// is forgotten. Nothing if the request is not known.
    [[nodiscard]] std::optional<Acknowledgements> answered(std::uint64_t number);
    /// It did not: what it was to acknowledge waits again. False if the request is not known.
    bool failed(std::uint64_t number);
    /// Bad_TooManyPublishRequests: from now on no more wait than do now, but one. False if none
    /// does, so that nothing tells when there is room.
    bool refuse();
    /// The server may have forgotten the requests that wait there: as many go out beside them. If
    /// it has not, it answers the old ones first (Part 4, 5.14.1.2), and a message in such an
    /// answer is as good as any. They end with their timeout at the latest, and until then no more
    /// are made.
    void renew();
    /// All that wait for an answer, be it overdue or not.
    [[nodiscard]] std::size_t size() const { return requests_.size(); }

    void acknowledge(std::uint32_t subscription_id, std::uint32_t sequence_number);
    /// The Subscription is not there any more.
    void forget(std::uint32_t subscription_id);

private:
    struct Request {
        /// The server was silent for so long that it may have forgotten it; its answer counts.
        bool is_overdue{false};
        Acknowledgements acknowledgements;
    };

    [[nodiscard]] std::size_t awaited() const;
    void keep(const SubscriptionAcknowledgement& acknowledgement);
    void take_back(Acknowledgements& acknowledgements);

    std::size_t configured_;
    std::size_t limit_;
    std::uint64_t last_number_{0};
    std::map<std::uint64_t, Request> requests_;
    std::deque<SubscriptionAcknowledgement> acknowledgements_;
};

} // namespace busbar::client::detail
