#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/model/space_journal.hpp>

namespace busbar::model::detail {

/// Records changes of nodes that have a NodeVersion, for ModelChangeEvents (Part 3, 9.32). If no
/// node has one it costs a look into an empty table.
class Journal {
public:
    /// `node` has got, or loses, the property NodeVersion.
    void begin(NodeIndex node, NodeIndex property) { versioned_[node] = {property}; }
    void end(NodeIndex node) { versioned_.erase(node); }
    /// Returns the property, no_node if the node has none.
    [[nodiscard]] NodeIndex property_of(NodeIndex node) const;

    template <typename Visit>
    void for_each_property(Visit visit) const
    {
        for (const auto& [node, versioned] : versioned_) {
            visit(versioned.property);
        }
    }

    /// Adds the bits to the changes of a node that has a NodeVersion. `describe` fills in its ids.
    template <typename Describe>
    void note(NodeIndex node, unsigned verb, Describe describe)
    {
        const auto found = versioned_.find(node);
        if (found == versioned_.end()) {
            return;
        }
        auto& changes = pending_.changes;
        Versioned& versioned = found->second;
        if (versioned.round != round_) {
            if (changes.size() == max_changes) {
                pending_.is_complete = false;
                return;
            }
            const StatusCode thrown = busbar::detail::caught([&] {
                ModelChange made;
                describe(made);
                changes.push_back(std::move(made));
            });
            if (thrown.is_bad()) { // the change has happened nevertheless
                pending_.is_complete = false;
                return;
            }
            versioned.place = changes.size() - 1;
            versioned.round = round_;
        }
        ModelChange& change = changes[versioned.place];
        change.verb = static_cast<std::uint8_t>(change.verb | verb);
    }
    [[nodiscard]] bool is_empty() const { return pending_.changes.empty() && pending_.is_complete; }
    [[nodiscard]] ModelChanges take();
    /// Nodes of a later generation were added since the last take().
    std::uint32_t taken_generation{0};

private:
    static constexpr std::size_t max_changes = 1'000;

    struct Versioned {
        NodeIndex property{no_node};
        /// Index of its entry among the pending changes, if it got that in this round.
        std::size_t place{0};
        std::uint64_t round{0};
    };

    std::unordered_map<NodeIndex, Versioned> versioned_;
    ModelChanges pending_;
    std::uint64_t round_{1};
};

} // namespace busbar::model::detail
