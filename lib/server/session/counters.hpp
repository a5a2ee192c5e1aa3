#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/date_time.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::server::detail {

class Session;

/// The counters of a Subscription (Part 5, 12.15), without its present state.
struct SubscriptionCounters {
    SubscriptionDiagnosticsDataType values;
    std::uint32_t round{0};
};

/// The counters of a server (Part 5, 6.3.3): plain numbers, which services increment and the
/// diagnostics read. Present numbers, such as that of sessions, are counted when they are read.
class Counters {
public:
    /// Only its counters are used.
    ServerDiagnosticsSummaryDataType summary;

    [[nodiscard]] bool is_enabled() const { return is_enabled_; }
    /// Present numbers.
    struct Present {
        std::size_t sessions;
        std::size_t subscriptions;
    };
    /// Reads EnabledFlag, which a client may have changed: once it is set again, counting starts
    /// again with the present numbers.
    void take_flag(const model::AddressSpace& space, const Present& present);

    /// A request of the session arrived, with the encoding id of its type.
    void count_request(Session& session, std::uint32_t encoding_id, DateTime now);
    /// A request was answered by a ServiceFault. `session` is null if the request had none.
    void count_fault(Session* session, std::uint32_t encoding_id, StatusCode status);

    /// Returns the session's counters; counts from before the last restart of counting are ignored.
    [[nodiscard]] SessionDiagnosticsDataType values(const Session& session) const;

    void count(SubscriptionCounters& counters,
               std::uint32_t SubscriptionDiagnosticsDataType::*counter, std::uint32_t more) const
    {
        if (!is_enabled_) {
            return;
        }
        if (counters.round != round_) {
            counters = {{}, round_};
        }
        counters.values.*counter += more;
    }
    [[nodiscard]] SubscriptionDiagnosticsDataType values(const SubscriptionCounters& counters) const
    {
        return counters.round == round_ ? counters.values : SubscriptionDiagnosticsDataType{};
    }

private:
    bool is_enabled_{false};
    /// Sessions whose counters are older start again.
    std::uint32_t round_{0};

    [[nodiscard]] SessionDiagnosticsDataType& counters(Session& session) const;
};

} // namespace busbar::server::detail
