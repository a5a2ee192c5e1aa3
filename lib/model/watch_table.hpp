#pragma once

#include <cstdint>
#include <unordered_map>

#include <busbar/core/function_ref.hpp>
#include <busbar/model/node_watch.hpp>

#include "record.hpp"

namespace busbar::model::detail {

/// The watches of nodes. Nodes without a watch cost nothing, and a change of one costs a look into
/// the table.
class WatchTable {
public:
    WatchTable() = default;
    WatchTable(const WatchTable&) = delete;
    WatchTable& operator=(const WatchTable&) = delete;
    ~WatchTable();

    void add(NodeIndex node, NodeAspect aspect, NodeWatch& watch);
    void remove(NodeWatch& watch);

    void tell(NodeIndex node, NodeAspect aspect)
    {
        if (!watches_.empty()) {
            tell(key(node, aspect), false);
        }
    }
    void tell_removed(NodeIndex node);
    /// Notifies the Binding watches of all nodes for which `is_meant` returns true.
    void tell_bindings(FunctionRef<bool(NodeIndex)> is_meant);

private:
    static constexpr unsigned aspect_bits = 2;

    [[nodiscard]] static std::uint64_t key(NodeIndex node, NodeAspect aspect)
    {
        return std::uint64_t{number(node)} << aspect_bits | static_cast<std::uint64_t>(aspect);
    }
    void tell(std::uint64_t key, bool is_removed);
    static void put_in_front(NodeWatch*& first, NodeWatch& watch);
    static void take_out(NodeWatch& watch);

    /// The first watch of each node and aspect, never null.
    std::unordered_map<std::uint64_t, NodeWatch*> watches_;
};

} // namespace busbar::model::detail
