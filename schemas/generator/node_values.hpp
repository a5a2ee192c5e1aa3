#pragma once

#include <string>

#include <busbar/core/expected.hpp>
#include <model/nodeset/data_types.hpp>

#include "options.hpp"

namespace busbar::generator {

/// Values of NodeSet2 files in OPC UA Binary.
class NodeValues {
public:
    NodeValues(const nodeset::Document& document, const nodeset::DataTypeTable& types)
        : document_{document}, types_{types}
    {
    }

    /// The Variant that the <Value> of `node` stands for, encoded.
    [[nodiscard]] Expected<std::string, Failure> value(const nodeset::Node& node) const;
    /// The DataTypeDefinition of a DataType, encoded as a Variant; empty if it has none.
    [[nodiscard]] Expected<std::string, Failure> definition(const nodeset::Node& node) const;
    /// The RolePermissions, encoded as a Variant; empty if the node has none of its own.
    [[nodiscard]] static std::string permissions(const nodeset::Node& node);

private:
    const nodeset::Document& document_;
    const nodeset::DataTypeTable& types_;
};

} // namespace busbar::generator
