#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/data_value.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/node.hpp>
#include <busbar/server/access_control.hpp>

namespace busbar::server::detail {

/// The source of Variables outside namespace 0 whose values LiveValues has. It is not one of
/// DataSources.
inline constexpr std::uint32_t live_values_source = model::no_source - 1;

/// The reader of a value of the server itself.
struct ReadingUser {
    const UserIdentity& user;
    /// The channel is encrypted.
    bool is_encrypted{false};

    /// SessionSecurityDiagnostics are for users who have logged in, over encrypted channels; others
    /// get Bad_UserAccessDenied (Part 5, 6.3.4).
    [[nodiscard]] bool may_see_security() const
    {
        return is_encrypted && user.token_type != UserTokenType::Anonymous;
    }
};

/// Values that the server computes when they are read: those below its own Object.
class LiveValues {
public:
    LiveValues() = default;
    LiveValues(const LiveValues&) = delete;
    LiveValues& operator=(const LiveValues&) = delete;

    /// Returns the present value with its source timestamp; Bad_NodeIdUnknown for a Variable whose
    /// value the address space or a data source has.
    [[nodiscard]] virtual Result<DataValue> find(const NodeId& node,
                                                 const ReadingUser& reader) const = 0;

protected:
    ~LiveValues() = default;
};

/// Nodes that take memory only once a client looks for them: those below Variables of the
/// live_values_source.
class LateNodes {
public:
    LateNodes() = default;
    LateNodes(const LateNodes&) = delete;
    LateNodes& operator=(const LateNodes&) = delete;

    /// Adds the missing nodes below the Variable with this handle and returns their number. If
    /// there is not enough memory the next call adds the rest.
    virtual std::size_t add_below(model::NodeIndex variable, std::uint64_t handle) = 0;

protected:
    ~LateNodes() = default;
};

} // namespace busbar::server::detail
