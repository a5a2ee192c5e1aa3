#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/model/node.hpp>

namespace busbar::server::detail {

/// Nodes that take up memory only once somebody looks for them: what is below Variables of the
/// live_values_source.
class LateNodes {
public:
    LateNodes() = default;
    LateNodes(const LateNodes&) = delete;
    LateNodes& operator=(const LateNodes&) = delete;

    /// Adds what belongs below the Variable with that handle and is not there yet; how many nodes
    /// that were. Where there is no memory for all of them the next call adds the others.
    virtual std::size_t add_below(model::NodeIndex variable, std::uint64_t handle) = 0;

protected:
    ~LateNodes() = default;
};

} // namespace busbar::server::detail
