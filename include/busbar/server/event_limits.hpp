#pragma once

#include <cstddef>
#include <cstdint>

namespace busbar::server {

/// Limits of the EventFilter of one MonitoredItem; beyond any of these it is refused.
struct EventFilterLimits {
    std::size_t max_select_clauses{100};
    /// Elements of the whereClause, and operands of one element.
    std::size_t max_elements{64};
    std::size_t max_operands{64};
    std::size_t max_path_elements{16};
    /// Bytes of a LiteralOperand's value in OPC UA Binary.
    std::size_t max_literal_size{4'096};
};

/// The limits of events and of their filters.
struct EventLimits {
    EventFilterLimits filter;
    /// Events that application threads have raised and the server has not yet processed.
    std::size_t max_raised_events{1'024};
    /// Notifiers that one event may reach; those nearest to its source have precedence.
    std::size_t max_notifiers{1'000};
};

} // namespace busbar::server
