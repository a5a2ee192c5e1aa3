#pragma once

#include <cstdint>

#include <busbar/core/data_value.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::server::detail {

struct Core;
class Session;

/// What a Subscription counts (Part 5, 12.15); what it has at present is not in there.
struct SubscriptionCounters {
    SubscriptionDiagnosticsDataType values;
    std::uint32_t round{0};
};

/// What a server counts of itself (Part 5, 6.3.3): plain numbers, which services change where
/// things happen. What is there at present, such as sessions, is counted when it is read.
class Diagnostics {
public:
    /// Of the counters only.
    ServerDiagnosticsSummaryDataType summary;

    [[nodiscard]] bool is_enabled() const { return is_enabled_; }
    /// Looks whether somebody has changed EnabledFlag: once it is set again, counting begins anew.
    void take_flag(const model::AddressSpace& space);

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

/// Who wants a value of the server itself.
struct ValueReader {
    const UserIdentity& user;
    /// Over a channel that nobody else can read.
    bool is_encrypted{false};

    /// SessionSecurityDiagnostics are for users who have logged in, over encrypted channels; others
    /// get Bad_UserAccessDenied (Part 5, 6.3.4).
    [[nodiscard]] bool may_see_security() const
    {
        return is_encrypted && user.token_type != UserTokenType::Anonymous;
    }
};

/// The value of a Variable below Server.ServerDiagnostics, i=2274; Bad_NodeIdUnknown for any other
/// node, Bad_NotReadable while diagnostics are off.
[[nodiscard]] Result<Variant> diagnostic_value(const Core& core, std::uint32_t id,
                                               const ValueReader& reader);

} // namespace busbar::server::detail
