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

/// The place in a task's memory that a name leads to.
struct PlcPlace {
    const server::ImagePlace* place;
    std::byte* bytes;
    /// The variable itself, or the one that contains the place.
    std::uint32_t handle;

    [[nodiscard]] PlcTarget target() const { return {*place, bytes}; }
};

/// Finds all places that a name denotes; none for an unknown name.
using PlcFinder = std::function<std::vector<PlcPlace>(std::string_view name)>;

/// Finds a program's variables, and members and elements in them, by name: "Press.Axes",
/// "Stations[2].Count", with indices as declared. Names are not case-sensitive.
class ProgramNames {
public:
    /// Both arguments must outlive this object.
    ProgramNames(const ProgramTypes& types, const ProgramImage& image);

    [[nodiscard]] std::vector<PlcPlace> find(std::string_view path) const;

private:
    /// The part of a path that is already resolved.
    struct Position {
        PlcPlace place;
        ResolvedType type;
    };

    [[nodiscard]] bool enter_element(Position& position, std::string_view index) const;
    [[nodiscard]] bool enter_member(Position& position, std::string_view name) const;

    const ProgramTypes* types_;
    server::ImageMemory* memory_;
    const ProgramImage* image_;
    /// Handles by folded name.
    std::unordered_map<std::string, std::uint32_t> handles_;
};

} // namespace busbar::controller::detail
