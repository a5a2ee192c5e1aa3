#include "file_objects.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

#include "method_arguments.hpp"
#include "node_table.hpp"
#include "open_files.hpp"

namespace busbar::administration::detail {

namespace {

struct FileProperty {
    const char* name;
    std::uint32_t type;
    FileAspect aspect;
};

constexpr std::array file_properties{
    FileProperty{"Size", id::UInt64, FileAspect::Size},
    FileProperty{"Writable", id::Boolean, FileAspect::Writable},
    FileProperty{"UserWritable", id::Boolean, FileAspect::UserWritable},
    FileProperty{"OpenCount", id::UInt16, FileAspect::OpenCount},
    FileProperty{"MaxByteStringLength", id::UInt32, FileAspect::MaxByteStringLength},
    FileProperty{"LastModifiedTime", id::DateTime, FileAspect::LastModifiedTime},
};

/// Returns the NodeId "parent//name" in the parent's namespace.
NodeId node_below(const NodeId& parent, std::string_view name)
{
    return NodeId{parent.namespace_index(),
                  String{parent.string().str() + "//" + std::string{name}}};
}

} // namespace

Result<model::NodeIndex> add_file_object(model::AddressSpace& space, const model::NewNode& node,
                                         const FileFacts& facts, const NamedRoles& roles)
{
    model::NewObject object;
    object.type_definition = facts.type;
    auto added = space.add_object(node, object);
    if (!added) {
        return added;
    }
    space.set_node_access(*added, access_of(Thing::Files, NodeClass::Object, roles));
    const model::NodeAccess access = access_of(Thing::Files, NodeClass::Variable, roles);
    for (const FileProperty& each : file_properties) {
        model::NewNode property;
        property.id = node_below(node.id, each.name);
        property.browse_name = QualifiedName{0, each.name};
        property.parent = *added;
        model::NewVariable variable;
        variable.data_type = NodeId{0, each.type};
        variable.source = facts.source;
        variable.handle = facts.number * static_cast<std::uint64_t>(FileAspect::Count) +
                          static_cast<std::uint64_t>(each.aspect);
        const auto made = space.add_property(property, std::move(variable));
        if (!made) {
            return fail(made.error());
        }
        space.set_node_access(*made, access);
    }
    return added;
}

std::uint32_t max_piece(const server::Server& server)
{
    return std::min(static_cast<std::uint32_t>(max_read_size),
                    server.config().limits.decode.max_byte_string_length);
}

Result<model::NodeIndex> add_declared_method(model::AddressSpace& space,
                                             const DeclaredMethod& method, const NamedRoles& roles)
{
    const model::NodeIndex declaration = space.find(method.declaration);
    if (declaration == model::no_node) {
        return fail(status::Bad_NotSupported);
    }
    model::NewNode node;
    node.browse_name = space.browse_name(declaration);
    node.parent = method.parent;
    node.id = node_below(space.node_id(method.parent), node.browse_name.name.view());
    model::NewMethod facts;
    facts.input_arguments = declared_arguments(space, declaration, "InputArguments");
    facts.output_arguments = declared_arguments(space, declaration, "OutputArguments");
    facts.source = method.source;
    facts.handle = method.handle;
    auto added = space.add_method(node, facts);
    if (!added) {
        return added;
    }
    space.set_node_access(*added, access_of(method.thing, NodeClass::Method, roles));
    for (const char* arguments : {"InputArguments", "OutputArguments"}) {
        if (const model::NodeIndex property = child_of(space, *added, arguments);
            property != model::no_node) {
            space.set_node_access(property,
                                  access_of(method.thing, NodeClass::Variable, roles, true));
        }
    }
    return added;
}

} // namespace busbar::administration::detail
