#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include <busbar/model/node.hpp>

#include "record.hpp"

namespace busbar::model::detail {

/// The attributes that few nodes have, by node. Every Read looks up each of its nodes, most of
/// which have none: that takes a look at one bit.
class NodeAccessTable {
public:
    /// Returns null if there is none; valid until the node gets another one.
    [[nodiscard]] const NodeAccess* find(NodeIndex node) const
    {
        const std::uint32_t index = number(node);
        const std::size_t word = index / word_bits;
        if (word >= has_one_.size() || (has_one_[word] & bit(index)) == 0) {
            return nullptr;
        }
        return entries_.find(index)->second.get();
    }
    void set(NodeIndex node, NodeAccess access)
    {
        share(node, std::make_shared<const NodeAccess>(std::move(access)));
    }
    /// Shares one entry for many nodes: most nodes of namespace 0 have one of a few.
    void share(NodeIndex node, std::shared_ptr<const NodeAccess> access)
    {
        const std::uint32_t index = number(node);
        if (index / word_bits >= has_one_.size()) {
            has_one_.resize(index / word_bits + 1);
        }
        entries_.insert_or_assign(index, std::move(access));
        has_one_[index / word_bits] |= bit(index);
    }
    void erase(NodeIndex node)
    {
        if (find(node) != nullptr) {
            const std::uint32_t index = number(node);
            has_one_[index / word_bits] &= ~bit(index);
            entries_.erase(index);
        }
    }

private:
    static constexpr std::uint32_t word_bits = 64;

    [[nodiscard]] static std::uint64_t bit(std::uint32_t index)
    {
        return std::uint64_t{1} << (index % word_bits);
    }

    /// The bits of nodes, up to the last one with an entry.
    std::vector<std::uint64_t> has_one_;
    std::unordered_map<std::uint32_t, std::shared_ptr<const NodeAccess>> entries_;
};

} // namespace busbar::model::detail
