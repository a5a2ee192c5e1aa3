#pragma once

#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

#include <busbar/model/instance.hpp>

#include "model_fixture.hpp"

namespace busbar::model {

using Names = std::vector<std::string>;

/// Verbs that declare types.
struct InstanceFixture : ModelFixture {
    NodeIndex add_type(const std::string& name, NodeIndex supertype, bool is_abstract = false)
    {
        return space.add_object_type(named(name, supertype), is_abstract).value();
    }
    NodeIndex add_type(const std::string& name)
    {
        return add_type(name, space.find(id::BaseObjectType));
    }
    /// The name of a declaration is what follows the last '.' of its identifier.
    [[nodiscard]] NewNode declared(const std::string& text, NodeIndex parent) const
    {
        NewNode node = named(text, parent);
        node.browse_name = QualifiedName{ns, text.substr(text.rfind('.') + 1)};
        node.reference_type = NodeId{0, id::HasComponent};
        return node;
    }
    void set_rule(NodeIndex node, std::uint32_t rule)
    {
        REQUIRE(space.add_reference(node, NodeId{0, id::HasModellingRule}, space.find(rule)));
    }
    NodeIndex declare_variable(const std::string& text, NodeIndex parent, std::uint32_t rule,
                               std::int32_t value = 0)
    {
        NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.access_level = Access::ReadWrite;
        variable.value = Variant{value};
        const NodeIndex node = space.add_variable(declared(text, parent), variable).value();
        set_rule(node, rule);
        return node;
    }
    NodeIndex declare_object(const std::string& text, NodeIndex parent, std::uint32_t rule,
                             const NodeId& type)
    {
        const NodeIndex node = space.add_object(declared(text, parent), {type, 0}).value();
        set_rule(node, rule);
        return node;
    }
    NodeIndex create(const std::string& name, NodeIndex type, const InstanceOptions& options = {})
    {
        return instantiate(space, named(name, objects), type, options).value();
    }
    [[nodiscard]] Names sorted_children(NodeIndex node) const
    {
        Names names = children(node);
        std::sort(names.begin(), names.end());
        return names;
    }
    [[nodiscard]] std::int32_t int_value(NodeIndex node) const
    {
        return *space.value(node).get_if<std::int32_t>();
    }

    static constexpr std::uint32_t mandatory = id::ModellingRule_Mandatory;
    static constexpr std::uint32_t optional = id::ModellingRule_Optional;
};

[[nodiscard]] inline std::size_t reference_count(const AddressSpace& space)
{
    std::size_t count = 0;
    space.for_each([&](NodeIndex node) {
        ReferenceCursor cursor = space.references(node);
        while (cursor.next()) {
            ++count;
        }
    });
    return count;
}

} // namespace busbar::model
