#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <busbar/net/server_loop.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The addresses and ports in a configuration; clients find the server at the first.
[[nodiscard]] std::vector<FurtherListener> listeners_of(const ControllerConfig& config);
/// Tells whether the address belongs to this machine and the port is free, or 0. Opens nothing and
/// logs nothing.
[[nodiscard]] bool can_listen(const FurtherListener& listener);

/// The listeners of a controller: those of the configuration, or substitutes until these can be
/// opened. Used on the server's thread.
class Listening {
public:
    using Listeners = std::vector<FurtherListener>;

    /// `told` are the listeners to open, at least one. Opens nothing yet. `loop` must outlive this
    /// object.
    Listening(net::ServerLoop& loop, Listeners told)
        : loop_{&loop}, told_{std::move(told)}, now_{.port = told_.front().port}
    {
    }

    /// Opens all of them, or none.
    [[nodiscard]] Configured<void> begin();
    /// Lets clients connect: until then their connections are refused.
    [[nodiscard]] Configured<void> listen();
    /// Opens substitutes after begin() has failed: those used `last`, if any. If these cannot be
    /// opened either, listens for administrators at this machine only, and the server is halted.
    [[nodiscard]] Configured<void> begin_elsewhere(Listeners last);

    /// The port by which clients find the server.
    [[nodiscard]] std::uint16_t port() const { return now_.port; }
    [[nodiscard]] const Listeners& told() const { return told_; }
    [[nodiscard]] bool is_elsewhere() const { return !now_.elsewhere.empty(); }
    /// True if only administrators at this machine are served.
    [[nodiscard]] bool is_halted() const { return now_.is_halted; }
    /// Puts the substitutes into a configuration, if there are any.
    void set_in(ControllerConfig& config) const;

    /// Checks that `next` can be opened, so that the controller does not end up without a listener.
    /// A port that is open now cannot be tried, but its address can.
    [[nodiscard]] Configured<void> check(const Listeners& next) const;
    /// Tells whether go_to() can open these while the others are open.
    [[nodiscard]] bool can_go_to(const Listeners& next) const;
    /// Opens these in addition to the open ones, and makes them the ones to open. stay() or
    /// go_back() follows.
    [[nodiscard]] Configured<void> go_to(Listeners next);
    /// Tells whether substitutes are in use and the proper listeners can be opened by now.
    [[nodiscard]] bool can_go_as_told() const;
    /// Replaces the substitutes by the proper listeners. stay() or go_back() follows; after a
    /// failure the substitutes are open again.
    [[nodiscard]] Configured<void> go_as_told();
    /// Closes the listeners that were open before, if they still are.
    void stay();
    /// Returns to the listeners that were open before.
    void go_back();

private:
    /// The listeners in use.
    struct Place {
        /// Empty if they are the proper ones.
        Listeners elsewhere{};
        std::uint16_t port{0};
        bool is_halted{false};
    };

    /// Opens them and returns the port of the first.
    [[nodiscard]] Configured<std::uint16_t> open(std::span<const FurtherListener> listeners);
    void close(std::span<const FurtherListener> listeners);

    net::ServerLoop* loop_;
    Listeners told_;
    Place now_;
    bool is_reserving_{true}; // until listen()
    /// State before go_to() or go_as_told(), until stay() or go_back().
    struct Left {
        Listeners told;
        Place place;
        bool is_closed;
    };
    std::optional<Left> left_;
};

} // namespace busbar::product
