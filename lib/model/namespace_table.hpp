#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace busbar::model::detail {

/// The NamespaceArray (Part 3, 8.2.2): found by its index and by its URI, however many there are.
class NamespaceTable {
public:
    [[nodiscard]] std::size_t size() const { return uris_.size(); }
    [[nodiscard]] std::string_view uri(std::size_t index) const { return uris_[index]; }
    [[nodiscard]] std::optional<std::uint16_t> find(std::string_view uri) const
    {
        const auto found = indices_.find(uri);
        return found == indices_.end() ? std::nullopt : std::optional{found->second};
    }
    /// Requires fewer than 65,536 entries. Of equal ones the first is found.
    void add(std::string_view uri)
    {
        indices_.try_emplace(std::string{uri}, static_cast<std::uint16_t>(uris_.size()));
        uris_.emplace_back(uri);
    }
    /// Removes the last entries.
    void shrink(std::size_t size)
    {
        for (; uris_.size() > size; uris_.pop_back()) {
            const auto found = indices_.find(uris_.back());
            if (found->second == uris_.size() - 1) {
                indices_.erase(found);
            }
        }
    }

private:
    struct Hash : std::hash<std::string_view> {
        using is_transparent = void;
    };

    std::vector<std::string> uris_;
    std::unordered_map<std::string, std::uint16_t, Hash, std::equal_to<>> indices_;
};

} // namespace busbar::model::detail
