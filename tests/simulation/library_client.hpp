#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include <busbar/client/subscriptions.hpp>

#include "harness_names.hpp"
#include "notification_check.hpp"
#include "plant.hpp"
#include "trace.hpp"

namespace busbar::test {

/// The library's own client in the simulation. It has no more Publish requests than the server
/// keeps messages, so that whatever is lost with a connection can be asked for: of a Subscription
/// that lives on, nothing may be missing.
class LibraryClient {
public:
    static constexpr std::size_t publish_requests{6};

    LibraryClient(World& world, const Plant& plant, Trace& trace, std::size_t number);

    void start();
    /// Whether the last of all that was counted has arrived, with the plant and network quiet.
    void check_arrivals();
    void leave();

private:
    struct Watch {
        Plant::Kind kind;
        std::size_t counter;
        CountCheck check;
    };

    void subscribe(const client::SubscriptionSettings& settings, Plant::Kind kind,
                   std::size_t counters);
    void receive(std::span<const client::DataChange> changes);
    void refuse_gap(const client::Gap& gap);
    void violation(const std::string& what) { trace_.violation(number_, what); }

    World& world_;
    const Plant& plant_;
    Trace& trace_;
    std::size_t number_;
    NullLog log_;
    std::map<client::ItemHandle, Watch> watches_;
    std::map<client::SubscriptionHandle, std::vector<client::ItemHandle>> subscriptions_;
    ClientHost host_;
};

} // namespace busbar::test
