#pragma once

#include <string>
#include <vector>

#include <busbar/model/address_space.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model {

/// An AddressSpace with the namespace "urn:test" and verbs that add nodes to it.
struct ModelFixture {
    AddressSpace space;
    std::uint16_t ns{space.add_namespace("urn:test").value()};
    NodeIndex objects{space.find(id::ObjectsFolder)};

    [[nodiscard]] NewNode named(const std::string& name, NodeIndex parent) const
    {
        NewNode node;
        node.id = NodeId{ns, String{name}};
        node.browse_name = QualifiedName{ns, String{name}};
        node.parent = parent;
        return node;
    }
    NodeIndex add_folder(const std::string& name, NodeIndex parent)
    {
        return space.add_folder(named(name, parent)).value();
    }
    NodeIndex add_int32(const std::string& name, NodeIndex parent)
    {
        NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        return space.add_variable(named(name, parent), variable).value();
    }
    [[nodiscard]] NodeIndex find(const std::string& name) const
    {
        return space.find(NodeId{ns, String{name}});
    }
    [[nodiscard]] std::vector<std::string> children(NodeIndex node) const
    {
        std::vector<std::string> names;
        ReferenceCursor cursor = space.references(node);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward &&
                space.is_subtype_of(reference->type, id::HierarchicalReferences)) {
                names.push_back(space.browse_name(reference->target).name.str());
            }
        }
        return names;
    }
};

/// True if all of namespace 0 was built in.
[[nodiscard]] inline bool is_full(const AddressSpace& space)
{
    return space.node_count() > 4'000;
}

template <typename T>
[[nodiscard]] StatusCode status_of(const Result<T>& result)
{
    return result ? status::Good : result.error();
}

} // namespace busbar::model
