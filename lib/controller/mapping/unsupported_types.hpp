#pragma once

#include <vector>

#include <busbar/model/space_reader.hpp>

namespace busbar::controller::detail {

/// The types of namespace 0 whose instances RD81OPC96 does not support (SH-082679, 2.1). Refers to
/// `space`, whose types must stay what they are.
class UnsupportedTypes {
public:
    explicit UnsupportedTypes(const model::SpaceReader& space);

    /// Which of them, or subtype of them, an Object or Variable is an instance of, or has values
    /// of; no_node if of none. Nodes of namespace 0 are as the product has them: of none.
    [[nodiscard]] model::NodeIndex of(model::NodeIndex node) const;

private:
    /// `type` itself if it is one of them or below one.
    [[nodiscard]] model::NodeIndex listed(model::NodeIndex type) const;

    const model::SpaceReader& space_;
    std::vector<model::NodeIndex> types_; // ascending
};

} // namespace busbar::controller::detail
