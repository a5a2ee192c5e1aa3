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

/// One step from a value to its parts.
struct PartStep {
    MappedPart::Kind kind{MappedPart::Kind::Element};
    std::uint32_t number{0};
    std::string name{};
};

/// "[1].Name" as part_path writes it; nothing for any other text, for more than `max_levels` steps
/// and for numbers from `max_elements` on.
[[nodiscard]] std::optional<std::vector<PartStep>>
read_part_path(std::string_view text, std::size_t max_levels, std::uint32_t max_elements);

/// The parts of a value while they come in any order; each is found in constant time.
class PartTree {
public:
    PartTree() = default;
    explicit PartTree(MappedPart part) : part_{std::move(part)} {}

    /// The part at these steps, which is made if it is not there, with what the arrays and
    /// structures around it then are. Null where elements and fields would stand side by side, and
    /// where an array would have more than three dimensions.
    [[nodiscard]] MappedPart* at(const std::vector<PartStep>& steps);
    /// With all parts, elements by their numbers and fields in the order of their first use.
    [[nodiscard]] MappedPart take();

private:
    [[nodiscard]] PartTree* child(const PartStep& step);

    MappedPart part_;
    std::vector<std::unique_ptr<PartTree>> children_;
    std::unordered_map<std::string, PartTree*> by_key_;
};

} // namespace busbar::controller::detail
