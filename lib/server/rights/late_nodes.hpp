#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/model/node.hpp>

namespace busbar::server::detail {

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
