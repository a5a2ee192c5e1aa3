#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/controller/program_image.hpp>
#include <busbar/controller/program_types.hpp>

#include "plc_target.hpp"

namespace busbar::controller::detail {

/// Where a name leads to in a task's memory.
struct PlcPlace {
    const server::ImagePlace* place;
    std::byte* bytes;
    /// The variable that it is, or that it is in.
    std::uint32_t handle;

    [[nodiscard]] PlcTarget target() const { return {*place, bytes}; }
};

/// All that a name means; none if it means nothing.
using PlcFinder = std::function<std::vector<PlcPlace>(std::string_view name)>;

/// Finds variables of a program by their names, and what is in them: "Press.Axes",
/// "Stations[2].Count", the index counted as it is declared. Upper and lower case are the same.
class ProgramNames {
public:
    /// All must outlive it.
    ProgramNames(const ProgramTypes& types, const ProgramImage& image);

    [[nodiscard]] std::vector<PlcPlace> find(std::string_view path) const;

private:
    /// What has been found of a path.
    struct Position {
        PlcPlace place;
        ResolvedType type;
    };

    [[nodiscard]] bool enter_element(Position& position, std::string_view index) const;
    [[nodiscard]] bool enter_member(Position& position, std::string_view name) const;

    const ProgramTypes* types_;
    server::ImageMemory* memory_;
    const ProgramImage* image_;
    /// Handles by folded names.
    std::unordered_map<std::string, std::uint32_t> handles_;
};

} // namespace busbar::controller::detail
