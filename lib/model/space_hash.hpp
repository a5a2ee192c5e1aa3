#pragma once

#include <cstdint>
#include <optional>

#include <busbar/model/space_reader.hpp>

namespace busbar::model::detail {

/// Returns a hash of the nodes of one namespace, or of all: their attributes, values and
/// references.
///
/// Two AddressSpaces with equal nodes have equal hashes, whatever the order of their nodes and
/// namespaces is; but bodies of structures are hashed as bytes, including the namespace indices in
/// them. For tests: it does not protect against intent.
[[nodiscard]] std::uint64_t space_hash(const SpaceReader& space,
                                       std::optional<std::uint16_t> only = std::nullopt);

} // namespace busbar::model::detail
