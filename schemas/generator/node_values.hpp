#pragma once

#include <string>
#include <unordered_map>

#include <busbar/core/types.hpp>
#include <tl/expected.hpp>

#include "hierarchy.hpp"
#include "options.hpp"

namespace busbar::generator {

/// Values of NodeSet2 files in OPC UA Binary.
class NodeValues {
public:
    NodeValues(const nodeset::Document& document, const Hierarchy& hierarchy);

    /// The Variant that the <Value> of `node` stands for, encoded.
    [[nodiscard]] tl::expected<std::string, Failure> value(const nodeset::Node& node) const;
    /// The DataTypeDefinition of a DataType, encoded as a Variant; empty if it has none.
    [[nodiscard]] tl::expected<std::string, Failure> definition(const nodeset::Node& node) const;

private:
    [[nodiscard]] const nodeset::Node* data_type(std::string_view name) const;

    const nodeset::Document& document_;
    const Hierarchy& hierarchy_;
    std::unordered_map<std::string, const nodeset::Node*> data_types_;
};

} // namespace busbar::generator
