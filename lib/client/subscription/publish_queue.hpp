#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include <busbar/types/subscription.hpp>

namespace busbar::client::detail {

/// The Publish requests that wait at the server, and the acknowledgements that wait for the next
/// one (Part 4, 5.14.5). It sends nothing: the sender reports the result of each request.
///
/// An acknowledgement is kept until a request with it was answered, or its Subscription is
/// forgotten.
class PublishQueue {
public:
    using Acknowledgements = Array<SubscriptionAcknowledgement>;

    struct Outgoing {
        std::uint64_t number{0}; // identifies the request from now on
        Acknowledgements acknowledgements;
    };

    /// At most `max_requests` wait, at least one.
    explicit PublishQueue(std::size_t max_requests);

    /// A new session began: the server may allow as many requests as are configured.
    void begin_session();
    /// Pending requests will not be answered any more.
    void end_session();
    /// Forgets all requests and acknowledgements.
    void clear();

    /// Returns how many more requests to send if `wanted` in all shall wait.
    [[nodiscard]] std::size_t missing(std::size_t wanted) const;
    /// Returns the next request, with the oldest acknowledgements, at most 1,000.
    [[nodiscard]] Outgoing add();
    /// The server carried the request out. Returns its acknowledgements, with SubscriptionId 0 for
    /// forgotten ones; nothing if the request is unknown.
    [[nodiscard]] std::optional<Acknowledgements> answered(std::uint64_t number);
    /// The server did not carry it out: its acknowledgements wait again. False if the request is
    /// unknown.
    bool failed(std::uint64_t number);
    /// Handles Bad_TooManyPublishRequests: from now on one less than at present may wait. False if
    /// none waits, so that nothing tells when there is room.
    bool refuse();
    /// The server may have forgotten the requests that wait there: the same number is sent in
    /// addition. If it has not, it answers the old ones first (Part 4, 5.14.1.2), and a message in
    /// such an answer is as good as any. They end with their timeout at the latest, and until then
    /// no more are sent.
    void renew();
    /// Number of requests that wait for an answer, overdue or not.
    [[nodiscard]] std::size_t size() const { return requests_.size(); }

    void acknowledge(std::uint32_t subscription_id, std::uint32_t sequence_number);
    /// The Subscription does not exist any more.
    void forget(std::uint32_t subscription_id);

private:
    struct Request {
        /// The server was silent for so long that it may have forgotten the request; its answer is
        /// still accepted.
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
