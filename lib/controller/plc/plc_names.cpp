#include "plc_names.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

namespace busbar::controller::detail {

namespace {

/// Takes the front of a path up to one of the characters, which stays in the path.
std::string_view take_front(std::string_view& path, std::string_view ends)
{
    const std::string_view front = path.substr(0, path.find_first_of(ends));
    path.remove_prefix(front.size());
    return front;
}

std::optional<std::int64_t> number_in(std::string_view text)
{
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional{number}
                                                                    : std::nullopt;
}

} // namespace

ProgramNames::ProgramNames(const ProgramTypes& types, const ProgramImage& image)
    : types_{&types}, memory_{&image.image()->memory()}, image_{&image}
{
    const auto variables = image.variables();
    for (std::uint32_t handle = 0; handle < variables.size(); ++handle) {
        handles_.emplace(fold_name(types.program().variables[variables[handle]].name), handle);
    }
}

std::vector<PlcPlace> ProgramNames::find(std::string_view path) const
{
    const auto found = handles_.find(fold_name(take_front(path, ".[")));
    if (found == handles_.end()) {
        return {};
    }
    const server::ImagePlace& place = memory_->layout()[found->second];
    const GlobalVariable& variable =
        types_->program().variables[image_->variables()[found->second]];
    Position position{{&place, memory_->bytes(place), found->second},
                      types_->resolve(variable.type)};
    while (!path.empty()) {
        const bool is_element = path.front() == '[';
        path.remove_prefix(1);
        const std::string_view step = take_front(path, is_element ? "]" : ".[");
        if (is_element) {
            if (path.empty() || !enter_element(position, step)) {
                return {};
            }
            path.remove_prefix(1);
        } else if (!enter_member(position, step)) {
            return {};
        }
    }
    return {position.place};
}

/// Enters an element of an array of structures; elements of other arrays have no places of their
/// own.
bool ProgramNames::enter_element(Position& position, std::string_view index) const
{
    const auto number = number_in(index);
    if (!number || position.type.dimensions.size() != 1 || !position.place.place->is_structure()) {
        return false;
    }
    const Bounds bounds = position.type.dimensions.front();
    if (*number < bounds.lower || *number > bounds.upper) {
        return false;
    }
    position.place.bytes +=
        static_cast<std::size_t>(*number - bounds.lower) * position.place.place->stride;
    position.type.dimensions.clear();
    return true;
}

bool ProgramNames::enter_member(Position& position, std::string_view name) const
{
    if (!position.place.place->is_structure() || position.type.is_array()) {
        return false;
    }
    const std::vector<Member>& members = position.type.type->members;
    const std::string folded = fold_name(name);
    const auto member = std::find_if(members.begin(), members.end(), [&](const Member& each) {
        return fold_name(each.name) == folded;
    });
    if (member == members.end()) {
        return false;
    }
    const auto number = static_cast<std::size_t>(member - members.begin());
    const server::ImagePlace& place = position.place.place->structure->members()[number];
    position.place.place = &place;
    position.place.bytes += place.offset;
    position.type = ResolvedType{types_->members(*position.type.type)[number]};
    return true;
}

} // namespace busbar::controller::detail
