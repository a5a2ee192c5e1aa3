#pragma once

#include <cstdint>
#include <optional>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/model/space_reader.hpp>

namespace busbar::controller::detail {

/// A NodeId of one AddressSpace in another by its NamespaceUri; nothing if that is not there.
[[nodiscard]] std::optional<NodeId> translate(const NodeId& id, const model::SpaceReader& from,
                                              const model::SpaceReader& to);
/// What is mapped of nodes that are in both.
[[nodiscard]] Mapping translate(const Mapping& mapping, const model::SpaceReader& from,
                                const model::SpaceReader& to);

/// What is mapped after an import, before and after which there are the two AddressSpaces
/// (SH-082679, 9.4, Node setting and mapping information handling). `imported` is the mapping in
/// the file of the namespace `index` of `after`.
[[nodiscard]] Mapping merge(const Mapping& mapping, const model::SpaceReader& before,
                            Mapping imported, std::uint16_t index, const model::SpaceReader& after,
                            ModelReports& reports);

} // namespace busbar::controller::detail
