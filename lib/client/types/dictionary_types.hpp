#pragma once

#include <map>
#include <unordered_map>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/client/type_dictionary.hpp>

namespace busbar::client::detail {

/// The dictionaries of a server, whose names become DataTypes: those of OPC UA have their NodeIds,
/// and those of the dictionaries get some that no node has.
class DictionaryTypes {
public:
    /// `known`: the DataTypes that dictionaries refer to as those of OPC UA.
    DictionaryTypes(const std::unordered_map<NodeId, binary::DataTypeEntry>& known,
                    std::size_t max_types);

    /// What is past `max_types` in all dictionaries is not there.
    void add(const NodeId& node, TypeDictionary dictionary);
    /// Once all are there: an entry for each type that a structure may contain. What cannot be used
    /// is told in `errors`.
    [[nodiscard]] std::vector<binary::DataTypeEntry>
    entries(std::vector<binary::DefinitionError>& errors) const;
    /// Defines `entry` by the description of that name in the dictionary of that node, or where
    /// that is not known in the only one that has the name; false, with the reason, if there is
    /// none or it cannot be used.
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
    /// The reason why not; empty if `entry` has a definition now.
    [[nodiscard]] std::string describe(const DictionaryType& type,
                                       binary::DataTypeEntry& entry) const;
    [[nodiscard]] std::string describe_structure(const DictionaryType& type,
                                                 binary::DataTypeEntry& entry) const;

    std::size_t max_types_;
    std::map<DictionaryName, NodeId> ids_;
    std::vector<Type> types_;
};

} // namespace busbar::client::detail
