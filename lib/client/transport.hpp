#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/client/client.hpp>

#include "deadline_heap.hpp"

namespace busbar::client::detail {

/// The state of the one transport that a Client has, and the orders for the code that drives it.
class Transport {
public:
    enum class State : std::uint8_t { None, Ordered, Up, Dropping };

    void open(std::string url)
    {
        state_ = State::Ordered;
        lost_.reset();
        reason_.clear();
        order_ = TransportOrder{TransportOrder::Kind::Open, ++id_, std::move(url)};
    }
    /// The driver may be stuck with a dead connection: the Client continues without it then.
    void drop(TimePoint now) { drop(now, std::chrono::seconds{2}, false); }
    /// Drops likewise, but counts the transport as closed only when the peer has ended it too, or
    /// after `patience`.
    void drop_with_peer(TimePoint now, Duration patience) { drop(now, patience, true); }
    [[nodiscard]] std::optional<TransportOrder> next_order()
    {
        return std::exchange(order_, std::nullopt);
    }
    /// Returns false if the order is an old one.
    bool connected(std::uint64_t order)
    {
        const bool is_it = order == id_ && state_ == State::Ordered && !lost_;
        state_ = is_it ? State::Up : state_;
        return is_it;
    }
    void disconnected(std::uint64_t order, StatusCode why, std::string_view reason)
    {
        if (order != id_) {
            return;
        }
        if (state_ == State::Dropping) {
            state_ = State::None;
            order_.reset();
        } else if (state_ != State::None && !lost_) {
            lost_ = why.is_bad() ? why : StatusCode{status::Bad_ConnectionClosed};
            reason_ = reason;
        }
    }
    /// Ends a drop that was not confirmed.
    void check(TimePoint now)
    {
        if (state_ == State::Dropping && now >= give_up_at_) {
            state_ = State::None;
            order_.reset();
        }
    }
    [[nodiscard]] TimePoint next_deadline() const
    {
        return state_ == State::Dropping ? give_up_at_ : no_deadline;
    }
    [[nodiscard]] State state() const { return state_; }
    [[nodiscard]] bool is_none() const { return state_ == State::None; }
    /// The reason why it was lost, if it was not dropped.
    [[nodiscard]] std::optional<StatusCode> lost() const { return lost_; }
    /// The driver's words for it; empty if there are none.
    [[nodiscard]] const std::string& reason() const { return reason_; }

private:
    void drop(TimePoint now, Duration patience, bool awaits_peer)
    {
        if (state_ == State::None || state_ == State::Dropping) {
            return;
        }
        // It is closed, or the order was not taken yet.
        if (std::exchange(lost_, std::nullopt) || (state_ == State::Ordered && order_)) {
            state_ = State::None;
            order_.reset();
            return;
        }
        state_ = State::Dropping;
        give_up_at_ = deadline_after(now, patience);
        order_ = TransportOrder{TransportOrder::Kind::Drop, id_, {}, awaits_peer};
    }

    State state_{State::None};
    std::uint64_t id_{0};
    std::optional<TransportOrder> order_;
    std::optional<StatusCode> lost_;
    std::string reason_;
    TimePoint give_up_at_{no_deadline};
};

} // namespace busbar::client::detail
