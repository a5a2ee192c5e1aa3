#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/controller/mapping.hpp>

namespace busbar::controller::detail {

/// A step from a value to one of its parts.
struct PartStep {
    MappedPart::Kind kind{MappedPart::Kind::Element};
    std::uint32_t number{0};
    std::string name{};
};

/// Parses a path as part_path writes it, such as "[1].Name"; nothing for any other text, for more
/// than `max_levels` steps and for numbers from `max_elements` on.
[[nodiscard]] std::optional<std::vector<PartStep>>
read_part_path(std::string_view text, std::size_t max_levels, std::uint32_t max_elements);

/// Collects the parts of a value, which may come in any order; each is found in constant time.
class PartTree {
public:
    PartTree() = default;
    explicit PartTree(MappedPart part) : part_{std::move(part)} {}

    /// Returns the part at these steps. Creates it if it does not exist, and marks the arrays and
    /// structures around it. Null if elements and fields would be side by side, or an array would
    /// have more than three dimensions.
    [[nodiscard]] MappedPart* at(const std::vector<PartStep>& steps);
    /// Returns the value with all parts, elements sorted by number and fields by first use.
    [[nodiscard]] MappedPart take();

private:
    [[nodiscard]] PartTree* child(const PartStep& step);

    MappedPart part_;
    std::vector<std::unique_ptr<PartTree>> children_;
    std::unordered_map<std::string, PartTree*> by_key_;
};

/// The current place of a walk through parts. Places are linked and live on the stack.
struct PartPlace {
    const PartPlace* above{nullptr};
    const MappedPart* part{nullptr};
};

/// Writes the path of a place: "[2].Speed", empty for the whole value.
[[nodiscard]] inline std::string path_of(const PartPlace& place)
{
    const std::string above = place.above == nullptr ? std::string{} : path_of(*place.above);
    return place.part == nullptr ? above : part_path(above, *place.part);
}

} // namespace busbar::controller::detail
