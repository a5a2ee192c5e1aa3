#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/date_time.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::server::detail {

class Session;

/// What a Subscription counts (Part 5, 12.15); what it has at present is not in there.
struct SubscriptionCounters {
    SubscriptionDiagnosticsDataType values;
    std::uint32_t round{0};
};

/// What a server counts of itself (Part 5, 6.3.3): plain numbers, which services change where
/// things happen and the diagnostics read. What is there at present, such as sessions, is counted
/// when it is read.
class Counters {
public:
    /// Of the counters only.
    ServerDiagnosticsSummaryDataType summary;

    [[nodiscard]] bool is_enabled() const { return is_enabled_; }
    /// What there is at present.
    struct Present {
        std::size_t sessions;
        std::size_t subscriptions;
    };
    /// Looks whether somebody has changed EnabledFlag: once it is set again, counting begins anew,
    /// with what there is.
    void take_flag(const model::AddressSpace& space, const Present& present);

    /// A request of the session came, by the encoding id of its type.
    void count_request(Session& session, std::uint32_t encoding_id, DateTime now);
    /// It was answered by a ServiceFault. `session` is null if the request had none.
    void count_fault(Session* session, std::uint32_t encoding_id, StatusCode status);

    /// The session's counters; what it counted before they began anew does not count.
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
    /// Sessions whose counters began earlier begin again.
    std::uint32_t round_{0};

    [[nodiscard]] SessionDiagnosticsDataType& counters(Session& session) const;
};

} // namespace busbar::server::detail
