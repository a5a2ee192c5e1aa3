#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/model/space_reader.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::tool::project {

/// "-1 (Scalar)", as the tool of SH-082679 shows it (9.4).
[[nodiscard]] std::string rank_text(std::int32_t rank);
/// "2,3"
[[nodiscard]] std::string dimensions_text(std::span<const std::uint32_t> dimensions);
/// The BrowseName without its namespace; of a node that is not there its NodeId.
[[nodiscard]] std::string plain_name(const model::SpaceReader& space, const NodeId& id);
/// The value of a Property; null if there is none.
[[nodiscard]] Variant property_of(const model::SpaceReader& space, model::NodeIndex node,
                                  const char* name);

/// An Argument of a Method, and what parts are called in a mapping table: "Input[0]", or
/// "Output[0]".
struct NamedArgument {
    std::string place;
    Argument argument;
};
/// Returns the Arguments of a Method by number, those of InputArguments first.
[[nodiscard]] std::vector<NamedArgument> arguments_of(const model::SpaceReader& space,
                                                      model::NodeIndex method);

} // namespace busbar::tool::project
