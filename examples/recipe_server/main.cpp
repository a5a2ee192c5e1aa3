// Structures of one's own: Recipe from a NodeSet2 file, as a C++ type, and Limits defined in code.
// usage: EXAMPLE_PASSWORD=... recipe-server [PORT]
#include <cstdlib>
#include <utility>

#include <recipe/nodes.hpp>
#include <recipe/registry.hpp>
#include <recipe/types.hpp>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/net/server_app.hpp>

using namespace busbar;

namespace {

/// The file gives both: `recipe::nodes()` has its DataTypes, `recipe::Recipe` is the structure.
Result<model::BoundValue> first_recipe(server::Server& server)
{
    model::AddressSpace& space = server.address_space();
    if (const auto added = space.add(recipe::nodes()); !added) {
        return fail(added.error());
    }
    const std::uint16_t ns = *space.namespace_index("urn:example:recipe");
    server.types().add(ns, recipe::types());
    const recipe::Recipe value{
        .name = "cover plate", .force = 12.5, .material = recipe::Material::Aluminium};
    return model::BoundValue{Variant{ExtensionObject::from(value, ns)}};
}

StructureField field(const char* name, std::uint32_t type)
{
    StructureField made;
    made.name = name;
    made.data_type = NodeId{0, type};
    made.value_rank = -1; // a scalar
    return made;
}

/// In code: the definition is compiled, and a DynamicValue has the fields by their names.
Result<model::BoundValue> first_limits(model::AddressSpace& space, std::uint16_t ns)
{
    StructureDefinition definition;
    definition.fields = {field("Least", id::Double), field("Most", id::Double)};
    model::NewNode node;
    node.browse_name = {ns, "Limits"};
    node.parent = space.find(id::Structure);
    const auto type = model::add_structure_type(space, node, definition);
    if (!type) {
        return fail(type.error());
    }
    model::DataTypes types;
    binary::DynamicValue limits{*types.of(space).find(space.node_id(*type))};
    return limits.set("Least", Variant{1.0})
        .and_then([&] { return limits.set("Most", Variant{250.0}); })
        .and_then([&] { return binary::to_extension_object(limits); })
        .transform(
            [](ExtensionObject value) { return model::BoundValue{Variant{std::move(value)}}; });
}

} // namespace

int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    net::ServerApp app{{"urn:example:recipe-server", "Recipe server", "server_pki"},
                       "opc.tcp://localhost:" + port};
    app.add_user("operator", std::getenv("EXAMPLE_PASSWORD"));
    const std::uint16_t ns = app.add_namespace("urn:example:press");
    if (server::Server* const server = app.server()) {
        const auto recipe = first_recipe(*server);
        const auto limits = first_limits(server->address_space(), ns);
        if (!recipe || !limits) {
            return 1;
        }
        app.add_variable({ns, "ActiveRecipe"}, *recipe, model::Access::ReadWrite);
        app.add_variable({ns, "ForceLimits"}, *limits);
    }
    return app.run();
}
