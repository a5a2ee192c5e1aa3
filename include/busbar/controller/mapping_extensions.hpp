#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_limits.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/nodeset_types.hpp>
#include <busbar/model/space_reader.hpp>

/// Mapping in the `<Extensions>` of nodes in NodeSet2 files (SH-082679, appendix 8). In
/// the target busbar::model_mode, which needs pugixml.
namespace busbar::controller {

/// The namespace of the elements `<DataMapping>` and `<MethodMapping>`. It is declared in these
/// elements themselves or in the `<Extension>` around them; a declaration further out is ignored.
inline constexpr std::string_view mapping_namespace =
    "https://www.mitsubishielectric.com/fa/OPCUA/extension/";

/// The namespace of the element `<Addition>`, which stands in an `<Extension>` of its own beside
/// such a mapping and has what the format does not: the attributes Quality and Scaling of a
/// Variable, Done of a Method, whose mapped OutputArguments are in it as those of `<Input>` are, in
/// an `<Output>`.
inline constexpr std::string_view addition_namespace = "urn:busbar:mapping";

/// The mapping of the extensions that could be read, and what is wrong with others.
struct ReadMapping {
    Mapping mapping{};
    ModelReports reports{};
};

/// Reads the mapping of the nodes in `extras`, which must be those of `space`.
///
/// A mapping that violates the format, or a part that lacks a required attribute or has an unknown
/// one, is skipped and reported. An optional attribute with an impossible value is left out, with a
/// warning; a known attribute without meaning in its place is ignored. Names of elements and
/// attributes are case-sensitive; besides `isArray` and `isStructure`, as in the manual's table,
/// `IsArray` and `IsStructure` are accepted, as in all its examples.
///
/// Reports name `file`; lines are not known any more. Numbers of elements and dimensions are
/// limited by `limits.max_elements`.
[[nodiscard]] BUSBAR_API ReadMapping read_mapping(const model::SpaceReader& space,
                                                  const model::NodeSetExtras& extras,
                                                  std::string_view file = {},
                                                  const ModelLimits& limits = {});

/// Replaces the mapping in `extras` of all nodes of the namespaces by that in `mapping`; a node
/// without an entry there loses its mapping; extensions of others stay as they are. Writes
/// `IsArray` and `IsStructure`. Parts that drop_unmapped removes are not written, and each mapping
/// gets a new Sign.
BUSBAR_API void write_mapping(const Mapping& mapping, std::span<const std::uint16_t> namespaces,
                              model::NodeSetExtras& extras);

} // namespace busbar::controller
