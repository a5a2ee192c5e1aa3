#pragma once

#include <map>
#include <unordered_map>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/client/type_dictionary.hpp>

namespace busbar::client::detail {

/// The dictionaries of a server, whose names become DataTypes: those of OPC UA have their NodeIds,
/// and those of the dictionaries get unused ones.
class DictionaryTypes {
public:
    /// `known`: the DataTypes of OPC UA that dictionaries refer to.
    DictionaryTypes(const std::unordered_map<NodeId, binary::DataTypeEntry>& known,
                    std::size_t max_types);

    /// Adds a dictionary; types beyond `max_types` in all dictionaries are left out.
    void add(const NodeId& node, TypeDictionary dictionary);
    /// Call it when all are added: returns an entry for each type that a structure may contain.
    /// Unusable types are reported in `errors`.
    [[nodiscard]] std::vector<binary::DataTypeEntry>
    entries(std::vector<binary::DefinitionError>& errors) const;
    /// Defines `entry` by the description with this name in the dictionary of this node, or if the
    /// node is unknown in the only one that has the name; false, with the reason, if there is none
    /// or it cannot be used.
    [[nodiscard]] bool define(binary::DataTypeEntry& entry, const NodeId& node,
                              std::string_view name,
                              std::vector<binary::DefinitionError>& errors) const;

private:
    struct Type {
        NodeId dictionary;
        NodeId id;
        DictionaryType from;
    };

    [[nodiscard]] const Type* find(const NodeId& node, std::string_view name) const;
    [[nodiscard]] NodeId id_of(const DictionaryName& name) const;
    /// Returns the reason of a failure; empty if `entry` has a definition now.
    [[nodiscard]] std::string describe(const DictionaryType& type,
                                       binary::DataTypeEntry& entry) const;
    [[nodiscard]] std::string describe_structure(const DictionaryType& type,
                                                 binary::DataTypeEntry& entry) const;

    std::size_t max_types_;
    std::map<DictionaryName, NodeId> ids_;
    std::vector<Type> types_;
};

} // namespace busbar::client::detail
