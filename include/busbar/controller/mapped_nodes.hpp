#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/controller/mapped_source.hpp>
#include <busbar/controller/mapping.hpp>
#include <busbar/controller/value_shape.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::controller {

/// The nodes that are served, and the mappings that are not.
struct MappedNodes {
    std::size_t variables{0};
    std::size_t methods{0};
    /// Mappings that cannot be served, one line each: of nodes that do not exist, and of parts that
    /// the values of their nodes do not have.
    std::vector<std::string> left_out{};
};

/// Adds the Variables and Methods of `mapping` that have labels to `source`, which a server must
/// have, and binds their nodes to it; call it before MappedSource::start. Initial values are those
/// of the address space. A Variable or an Argument of an unsupported type is bound too, and answers
/// Bad_NotSupported (SH-082679, 8.1). `types` must outlive the source.
[[nodiscard]] BUSBAR_API MappedNodes map_nodes(model::AddressSpace& space,
                                               const binary::DynamicTypes& types,
                                               const Mapping& mapping, MappedSource& source,
                                               const ShapeLimits& limits = {});

/// Binds the Variables of models that have no label and whose type or rank the product of the
/// manual of model mode does not support: they answer Bad_NotSupported (8.1). Without this call the
/// address space keeps their values. Returns their number.
BUSBAR_API std::size_t refuse_unsupported(model::AddressSpace& space,
                                          const binary::DynamicTypes& types, MappedSource& source,
                                          const ShapeLimits& limits = {});

} // namespace busbar::controller
