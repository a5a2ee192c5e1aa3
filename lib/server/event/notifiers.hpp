#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// Finds the notifiers that an event reaches: those above its source along HasEventSource and
/// HasNotifier (Part 3, 7.17 and 7.18). The nodes directly above a node are cached until that
/// node's references change, so that a notifier with many sources is searched once.
class Notifiers {
public:
    Notifiers(const model::AddressSpace& space, std::size_t max_notifiers)
        : space_{&space}, max_notifiers_{max_notifiers}
    {
    }
    Notifiers(const Notifiers&) = delete;
    Notifiers& operator=(const Notifiers&) = delete;

    /// Returns the Server object, followed by `source` itself, which may be no_node, and the nodes
    /// above it; each once, also if references form a circle, up to the limit. Valid until the next
    /// call.
    [[nodiscard]] const std::vector<model::NodeIndex>& above(model::NodeIndex source);
    /// Number of nodes for which the nodes directly above are cached.
    [[nodiscard]] std::size_t remembered() const { return directly_above_.size(); }

private:
    struct Above final : model::NodeWatch {
        explicit Above(Notifiers& o) : owner{o} {}
        void node_changed(model::NodeIndex node, bool) override
        {
            owner.directly_above_.erase(node); // and this with it
        }

        Notifiers& owner;
        std::vector<model::NodeIndex> nodes;
    };

    [[nodiscard]] const std::vector<model::NodeIndex>& directly_above(model::NodeIndex node);
    void add(model::NodeIndex node);

    const model::AddressSpace* space_;
    std::size_t max_notifiers_;
    std::unordered_map<model::NodeIndex, Above> directly_above_;
    std::vector<model::NodeIndex> found_;
    /// The last round in which a node was found.
    std::unordered_map<model::NodeIndex, std::uint64_t> seen_;
    std::uint64_t round_{0};
};

} // namespace busbar::server::detail
