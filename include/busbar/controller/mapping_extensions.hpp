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

/// Mapping in the <Extensions> of nodes in NodeSet2 files (seed 001, appendix 8). Of the target
/// busbar::model_mode, which needs pugixml.
namespace busbar::controller {

/// Of the elements <DataMapping> and <MethodMapping>. It stands in these elements themselves or in
/// the <Extension> around them; a declaration further out does not count.
inline constexpr std::string_view mapping_namespace =
    "https://www.mitsubishielectric.com/fa/OPCUA/extension/";

struct ReadMapping {
    Mapping mapping{};
    ModelReports reports{};
};

/// The mapping of the nodes in `extras`, which must be those of `space`.
///
/// A mapping that does not keep to the format, or a part of one without an attribute that it must
/// have or with one that there is none of, counts as not written and is reported. An optional
/// attribute of an impossible value is left out, with a warning; an attribute that exists but means
/// nothing where it stands is passed over. Names of elements and attributes are told apart by case;
/// besides `isArray` and `isStructure`, which the manual's table has, `IsArray` and `IsStructure`
/// are read, which all its examples have.
///
/// Takes `file` into reports; the lines of a file are not known any more. Numbers of elements and
/// dimensions are limited by `limits.max_elements`.
[[nodiscard]] BUSBAR_API ReadMapping read_mapping(const model::SpaceReader& space,
                                                  const model::NodeSetExtras& extras,
                                                  std::string_view file = {},
                                                  const ModelLimits& limits = {});

/// Replaces the mapping in `extras` of all nodes of the namespaces by that of `mapping`, of which
/// nothing is left where `mapping` has none; extensions of others stay as they are. Writes
/// `IsArray` and `IsStructure`. What drop_unmapped leaves out is not written, and each mapping gets
/// a new Sign.
BUSBAR_API void write_mapping(const Mapping& mapping, std::span<const std::uint16_t> namespaces,
                              model::NodeSetExtras& extras);

} // namespace busbar::controller
