#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <busbar/client/client.hpp>
#include <busbar/client/operation.hpp>
#include <busbar/client/type_cache.hpp>

#include "harness_names.hpp"
#include "moody_server.hpp"
#include "trace.hpp"

namespace busbar::test {

/// A user of the client library who never waits for ever: each request ends, each state of the
/// client passes or is told, and of each Subscription something is heard, from the server or from
/// the library.
class SilenceWatch {
public:
    SilenceWatch(World& world, MoodyServer& server, Trace& trace);

    /// Begins what is under way all the time: a request now and then, a change of user, a close.
    void act();
    /// Whether something waits for longer than it may; call it each few seconds.
    void check();
    /// The server is well from now on: the user does again what the library told to have failed.
    void begin_recovery();
    /// The server has been well for a while: all values must be there.
    void check_recovery();
    /// Ends with everything told.
    void leave();

    [[nodiscard]] std::uint64_t values() const { return values_; }
    [[nodiscard]] std::uint64_t ended() const { return ended_; }
    [[nodiscard]] std::uint64_t connections() const { return connections_; }

private:
    struct Item {
        TimePoint last_value;
        bool has_failed{false};
    };
    struct Watched {
        client::SubscriptionHandle handle{0};
        client::SubscriptionSettings settings;
        std::map<client::ItemHandle, Item> items;
        TimePoint told;
    };
    struct Waiting {
        std::string name;
        TimePoint until;
        client::Operation operation;
        bool has_ended{false};
    };

    void subscribe(std::size_t index);
    void add_items(Watched& watched, std::size_t count);
    void tell(std::size_t index) { watched_[index].told = world_.now(); }
    void begin(const char* name, Duration limit,
               const std::function<client::Operation(std::function<void()> done)>& start);
    void begin_one();
    void change_wishes();
    void violation(const std::string& what);
    [[nodiscard]] client::Client& client() { return host_.client(); }

    World& world_;
    MoodyServer& server_;
    Trace& trace_;
    Chance chance_;
    NullLog log_;
    std::vector<Watched> watched_;
    std::list<Waiting> waiting_;
    TimePoint state_since_;
    std::optional<TimePoint> user_change_;
    std::uint64_t values_{0};
    std::uint64_t ended_{0};
    std::uint64_t connections_{0};
    ClientHost host_;
    std::optional<client::TypeCache> types_;
};

} // namespace busbar::test
