#pragma once

#include <cstdint>
#include <optional>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/model/space_reader.hpp>

namespace busbar::controller::detail {

/// Translates a NodeId from one AddressSpace to another by its NamespaceUri; nothing if the
/// namespace is missing there.
[[nodiscard]] std::optional<NodeId> translate(const NodeId& id, const model::SpaceReader& from,
                                              const model::SpaceReader& to);
/// Translates the mappings of nodes that both have.
[[nodiscard]] Mapping translate(const Mapping& mapping, const model::SpaceReader& from,
                                const model::SpaceReader& to);

/// Returns the mapping after an import that turned `before` into `after` (SH-082679, 9.4, Node
/// setting and mapping information handling). `imported` is the mapping in the imported file, whose
/// namespace has this `index` in `after`.
[[nodiscard]] Mapping merge(const Mapping& mapping, const model::SpaceReader& before,
                            Mapping imported, std::uint16_t index, const model::SpaceReader& after,
                            ModelReports& reports);

} // namespace busbar::controller::detail
