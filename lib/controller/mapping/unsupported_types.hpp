#pragma once

#include <vector>

#include <busbar/model/space_reader.hpp>

namespace busbar::controller::detail {

/// The types of namespace 0 whose instances RD81OPC96 does not support (SH-082679, 2.1). Refers to
/// `space`, whose types must not change.
class UnsupportedTypes {
public:
    explicit UnsupportedTypes(const model::SpaceReader& space);

    /// Returns the unsupported type, or subtype of one, that an Object or Variable is an instance
    /// of or has values of; no_node if there is none. Nodes of namespace 0 belong to the product
    /// and never count.
    [[nodiscard]] model::NodeIndex of(model::NodeIndex node) const;

private:
    /// Returns `type` if it is an unsupported type or a subtype of one.
    [[nodiscard]] model::NodeIndex listed(model::NodeIndex type) const;

    const model::SpaceReader& space_;
    std::vector<model::NodeIndex> types_; // ascending
};

} // namespace busbar::controller::detail
