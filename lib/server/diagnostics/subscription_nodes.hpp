#pragma once

#include <cstdint>
#include <unordered_map>

#include <busbar/model/address_space.hpp>

#include "diagnostics_needs.hpp"
#include "server/subscription/subscription_needs.hpp"
#include "session_nodes.hpp"

namespace busbar::server::detail {

/// A Variable for each Subscription below the server's SubscriptionDiagnosticsArray (Part 5, 7.11
/// and 7.12), to which the array of its session refers, too. Its BrowseName is the SubscriptionId;
/// its fields are added when a client looks for them. There are none while diagnostics are off, nor
/// in a namespace 0 without the types.
class SubscriptionNodes final : public SubscriptionObserver {
public:
    SubscriptionNodes(const DiagnosticsNeeds& needs, const SessionNodes& sessions)
        : needs_{needs}, sessions_{sessions}
    {
    }

    void added(const Subscription& subscription) override;
    void moved(const Subscription& subscription) override;
    void removed(const Subscription& subscription) override;
    /// Adds the fields of a Subscription's Variable, by its handle; returns their number.
    std::size_t add_fields(model::NodeIndex variable, std::uint64_t handle);
    /// Adds or removes the Variables of all Subscriptions if diagnostics were switched on or off.
    /// Those of sessions must exist by then.
    void take_flag();

private:
    void remove_left();

    struct Entry {
        model::NodeHandle element;
        /// The session's array that refers to it, if any.
        model::NodeHandle array;
        /// The Subscription was deleted: there was no memory to remove its nodes.
        bool is_left{false};
        bool has_fields{false};
    };

    /// Makes only the array of the Subscription's session refer to it.
    void refer(const Subscription& subscription, Entry& entry) const;

    const DiagnosticsNeeds& needs_;
    const SessionNodes& sessions_;
    std::unordered_map<std::uint32_t, Entry> entries_;
    /// Number of entries with is_left.
    std::size_t left_{0};
    bool is_shown_{true};
};

} // namespace busbar::server::detail
