#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <busbar/net/server_loop.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// Where a configuration has the server listen; the first is where its clients find it.
[[nodiscard]] std::vector<FurtherListener> listeners_of(const ControllerConfig& config);
/// Whether the address is this machine's and the port is free, or 0. Opens nothing and logs
/// nothing.
[[nodiscard]] bool can_listen(const FurtherListener& listener);

/// Where a controller listens: where it is told to, or somewhere else until it can. On the server's
/// thread.
class Listening {
public:
    using Listeners = std::vector<FurtherListener>;

    /// Told to listen at these, which are not empty; opens nothing. `loop` must outlive it.
    Listening(net::ServerLoop& loop, Listeners told)
        : loop_{&loop}, told_{std::move(told)}, now_{.port = told_.front().port}
    {
    }

    /// Opens them, at all or at none.
    [[nodiscard]] Configured<void> begin();
    /// After begin() has failed: where it did `last`, which may be nowhere; if that cannot be
    /// opened either, for administrators at this machine only, and the server is halted.
    [[nodiscard]] Configured<void> begin_elsewhere(Listeners last);

    /// By which its clients find it.
    [[nodiscard]] std::uint16_t port() const { return now_.port; }
    [[nodiscard]] const Listeners& told() const { return told_; }
    [[nodiscard]] bool is_elsewhere() const { return !now_.elsewhere.empty(); }
    /// For administrators at this machine only: nobody else is served.
    [[nodiscard]] bool is_halted() const { return now_.is_halted; }
    /// Has a configuration say where it listens, if that is not where it is told to.
    void set_in(ControllerConfig& config) const;

    /// Whether `next` can be opened, so that it is not left with nothing in the end. One at a port
    /// that is open now cannot be tried there: its address can.
    [[nodiscard]] Configured<void> check(const Listeners& next) const;
    /// Whether go_to() can open these while the others are open.
    [[nodiscard]] bool can_go_to(const Listeners& next) const;
    /// Opens these beside what is open, and is told them from now on. stay() or go_back() follows.
    [[nodiscard]] Configured<void> go_to(Listeners next);
    /// Whether it listens elsewhere and can where it is told to by now.
    [[nodiscard]] bool can_go_as_told() const;
    /// Closes the others and opens these. stay() or go_back() follows; if it fails, it has gone
    /// back.
    [[nodiscard]] Configured<void> go_as_told();
    /// Leaves what was open before, if it is still.
    void stay();
    /// To what was open before.
    void go_back();

private:
    /// Where it is found.
    struct Place {
        /// Empty: as told.
        Listeners elsewhere{};
        std::uint16_t port{0};
        bool is_halted{false};
    };

    /// The port of the first.
    [[nodiscard]] Configured<std::uint16_t> open(std::span<const FurtherListener> listeners);
    void close(std::span<const FurtherListener> listeners);

    net::ServerLoop* loop_;
    Listeners told_;
    Place now_;
    /// What a go_to() or go_as_told() left, until stay() or go_back().
    struct Left {
        Listeners told;
        Place place;
        bool is_closed;
    };
    std::optional<Left> left_;
};

} // namespace busbar::product
