#pragma once

#include <cstdint>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::model {

/// The DataTypes of an AddressSpace, compiled on first use, and again when types have been added
/// since. One thread at a time.
class BUSBAR_API DataTypes {
public:
    /// Returns all DataTypes with their DataTypeDefinitions. The result, and everything that refers
    /// to it, is valid until the first call after a type was added. Every call must be for the same
    /// space.
    [[nodiscard]] const binary::DynamicTypes& of(const SpaceReader& space);

private:
    binary::DynamicTypes compiled_;
    std::uint64_t seen_types_{UINT64_MAX};
};

/// Collects the definitions of the nodes below BaseDataType (Part 3, 5.8.3).
[[nodiscard]] BUSBAR_API std::vector<binary::DataTypeEntry>
collect_data_types(const SpaceReader& space);

/// Adds a structure or union below `node.parent`, its supertype, and if it is concrete its encoding
/// node "Default Binary" with the id `definition.default_encoding_id` (null: one made from the
/// BrowseName). `definition.base_data_type` is set here. Errors as AddressSpace::add_data_type, and
/// Bad_NodeIdExists or Bad_NodeIdInvalid for the encoding's id.
BUSBAR_API Result<NodeIndex> add_structure_type(AddressSpace& space, const NewNode& node,
                                                StructureDefinition definition,
                                                bool is_abstract = false);

/// Adds an enumeration or option set below `node.parent` with the Property that Part 3, 5.8.3
/// requires: EnumStrings if the values are 0, 1, 2 and so on, else EnumValues; OptionSetValues for
/// an option set. Errors as AddressSpace::add_data_type, and Bad_NodeIdExists for the Property's
/// id.
BUSBAR_API Result<NodeIndex> add_enumeration_type(AddressSpace& space, const NewNode& node,
                                                  EnumDefinition definition);

} // namespace busbar::model
