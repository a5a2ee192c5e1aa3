#pragma once

#include <cstdint>
#include <unordered_map>

#include <busbar/core/data_value.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>

#include "diagnostics_needs.hpp"
#include "server/rights/live_values.hpp"

namespace busbar::server::detail {

/// An Object for each activated session below SessionsDiagnosticsSummary (Part 5, 6.3.4 and 6.3.5),
/// whose parts are the elements of the arrays there: its NodeId is the session's. The fields of the
/// parts are added when a client looks for them. There are none while diagnostics are off (Part 5,
/// 6.3.3), nor in a namespace 0 without the types.
class SessionNodes {
public:
    explicit SessionNodes(const DiagnosticsNeeds& needs) : needs_{needs} {}

    /// Does nothing if the session has its Object, or may have none.
    void add(const Session& session);
    void remove(const Session& session);
    /// Adds or removes the Objects of all sessions if diagnostics were switched on or off.
    void take_flag();

    /// Adds the fields of a Variable of a session, by its handle; returns their number.
    std::size_t add_fields(model::NodeIndex variable, std::uint64_t handle);

    /// Returns the Object's array of Subscriptions; no_node if there is none.
    [[nodiscard]] model::NodeIndex subscriptions_of(const Session& session) const;
    /// Returns the value of a Variable of a session or a Subscription, by its handle;
    /// Bad_NodeIdUnknown for any other. Not every reader may see the security diagnostics.
    [[nodiscard]] Result<Variant> value(std::uint64_t handle, const ReadingUser& reader) const;

private:
    void remove_left();

    struct Entry {
        /// Null if only the nodes are left, because there was no memory to remove them.
        const Session* session;
        model::NodeHandle object;
        model::NodeHandle subscriptions;
        bool has_session_fields{false};
        bool has_security_fields{false};
    };

    const DiagnosticsNeeds& needs_;
    std::unordered_map<std::uint32_t, Entry> entries_;
    std::unordered_map<const Session*, std::uint32_t> numbers_;
    /// Entries without a session.
    std::size_t left_{0};
    std::uint32_t last_number_{0};
    bool is_shown_{true};
};

} // namespace busbar::server::detail
