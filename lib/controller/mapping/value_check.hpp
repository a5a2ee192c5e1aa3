#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/controller/mapping_check.hpp>
#include <busbar/controller/value_shape.hpp>
#include <busbar/model/space_reader.hpp>

#include "part_text.hpp"

namespace busbar::controller::detail {

/// Returns the error code of a place where nothing can be mapped.
[[nodiscard]] ModelCode code_of(NodePlace place);

/// Checks the mapping of one Variable or Argument against its declaration.
class ValueCheck {
public:
    ValueCheck(const model::SpaceReader& space, const binary::DynamicTypes& types,
               const ModelLimits& limits, ModelReports& reports)
        : space_{space}, types_{types}, reports_{reports}, limits_{limits.max_elements,
                                                                   limits.max_structure_levels,
                                                                   limits.max_elements}
    {
    }

    /// Checks a value. Reports put `prefix` before the parts: "Input[0]" for an Argument.
    void check(const NodeId& node, const std::string& prefix, const ValueDeclaration& declaration,
               const MappedPart& value);
    /// Number of words of the Variable with this mapping, or unmapped; 0 if it cannot have labels.
    [[nodiscard]] std::size_t words(const ValueDeclaration& declaration,
                                    const MappedPart* value) const;

    /// Tells whether all labels of a Variable with this mapping are numbers, which can be scaled.
    [[nodiscard]] bool is_numeric(const ValueDeclaration& declaration,
                                  const MappedPart& value) const;

private:
    void check_specification(const ValueDeclaration& declaration, const MappedPart& value);
    void check_part(const MappedPart& part, const std::string& path, const ValueShape& shape);
    void check_siblings(const MappedPart& part, const std::string& path);
    void check_label(const MappedPart& part, const std::string& path, const ValueShape& shape);
    void report(ModelCode code, const std::string& path, std::string_view found);

    const model::SpaceReader& space_;
    const binary::DynamicTypes& types_;
    ModelReports& reports_;
    ShapeLimits limits_;
    const NodeId* node_{nullptr};
    const std::string* prefix_{nullptr};
};

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
