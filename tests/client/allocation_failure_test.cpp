#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/client/attributes.hpp>
#include <busbar/client/discovery.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/resolve_nodes.hpp>
#include <busbar/client/text_access.hpp>
#include <busbar/client/type_cache.hpp>
#include <busbar/client/view.hpp>
#include <busbar/model/data_types.hpp>

#include "failure_world.hpp"
#include "support/failing_worlds.hpp"

namespace allocation_failure_test {

/// Each request of a client with the k-th of the client's allocations failing, for k = 1, 2,
/// ... until it goes through. Its handler is called once, with Bad_OutOfMemory or because the
/// connection ended, and soon the client answers as ever.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const NodeId state_node{0, id::Server_ServerStatus_State};

struct Row {
    const char* request;
    void (*ask)(ClientWorld&);
};

ReadValueId state_value()
{
    return client::attribute_of(state_node, AttributeId::Value);
}

void call_read(ClientWorld& world)
{
    ReadRequest request;
    request.nodes_to_read = {state_value()};
    world.client.call<ReadResponse>(std::move(request), [&world](const auto& response) {
        world.answer(response ? response->response_header.service_result : response.error());
    });
}

void read(ClientWorld& world)
{
    client::ServiceOptions options;
    options.max_items_per_request = 1;
    options.max_parallel = 1;
    client::read(
        world.client, std::vector<ReadValueId>{state_value(), state_value(), state_value()},
        [&world](const std::vector<DataValue>& values) { world.answer_all(values); }, {}, options);
}

void write(ClientWorld& world)
{
    client::write(world.client, {client::value_for(NodeId{1, "level"}, DataValue{Variant{7}})},
                  [&world](const auto& results) { world.answer_all(results); });
}

void call(ClientWorld& world)
{
    client::call(world.client, {{NodeId{0, id::ObjectsFolder}, NodeId{1, "start"}, {}}},
                 [&world](const auto& results) { world.answer_all(results); });
}

void translate(ClientWorld& world)
{
    BrowsePath path;
    path.starting_node = NodeId{0, id::ObjectsFolder};
    path.relative_path.elements.resize(1);
    path.relative_path.elements[0].include_subtypes = true;
    path.relative_path.elements[0].target_name = QualifiedName{1, "level"};
    client::translate(world.client, {path},
                      [&world](const auto& results) { world.answer_all(results); });
}

void browse(ClientWorld& world)
{
    client::browse(world.client, {client::children_of(NodeId{0, id::ObjectsFolder})},
                   [&world](const auto& results) { world.answer_all(results); });
}

void browse_in_parts(ClientWorld& world)
{
    client::BrowseLimits limits;
    limits.references_per_answer = 1;
    client::browse(
        world.client, {client::children_of(NodeId{0, id::ObjectsFolder})},
        [&world](const auto& results) { world.answer_all(results); }, limits);
}

void find_servers(ClientWorld& world)
{
    client::find_servers(world.client, "opc.tcp://localhost:4840", [&world](const auto& found) {
        world.answer(found ? StatusCode{} : found.error());
    });
}

void register_nodes(ClientWorld& world)
{
    client::register_nodes(world.client, {state_node},
                           [&world](const auto& results) { world.answer_all(results); });
}

void get_endpoints(ClientWorld& world)
{
    client::get_endpoints(world.client, "opc.tcp://localhost:4840", [&world](const auto& found) {
        world.answer(found ? StatusCode{} : found.error());
    });
}

void browse_tree(ClientWorld& world)
{
    client::browse_tree(world.client, {NodeId{1, "plant"}}, client::children_of(NodeId{}),
                        [&world](const client::BrowsedTree& tree) {
                            for (const client::TreeNode& node : tree.nodes) {
                                if (node.status.is_bad()) {
                                    return world.answer(node.status);
                                }
                            }
                            world.answer(tree.is_complete && tree.nodes.size() == 5
                                             ? status::Good
                                             : status::Bad_InternalError);
                        });
}

void resolve_path(ClientWorld& world)
{
    client::resolve(
        world.client,
        {NodeId{1, "level"}, client::NodeAddress::path("/Objects/1:plant/1:left/1:deep").value()},
        [&world](const auto& results) { world.answer_all(results); });
}

/// The names have no namespaces: it is browsed for them.
void search_path(ClientWorld& world)
{
    client::resolve(world.client,
                    {client::NodeAddress::path("/Objects/plant/left/deep").value(),
                     client::NodeAddress::path("/Objects/plant/left").value()},
                    [&world](const auto& results) { world.answer_all(results); });
}

void search_twins(ClientWorld& world)
{
    client::resolve_nodes(world.client, {client::NodeAddress::path("/Objects/plant/twin").value()},
                          [&world](const std::vector<client::ResolvedNode>& found) {
                              const StatusCode why = found[0].id.error();
                              world.answer(why == status::Bad_TooManyMatches &&
                                                   found[0].candidates.size() == 2
                                               ? StatusCode{}
                                               : why);
                          });
}

constexpr std::string_view dictionary_uri = "urn:plant:dictionary";

/// Stands for a parser: there is one dictionary only.
Checked<client::TypeDictionary> parse_dictionary(std::span<const std::byte> /*xml*/,
                                                 const client::DictionaryLimits& /*limits*/)
{
    client::DictionaryType valve;
    valve.name = "Valve";
    valve.fields.push_back(
        {"opening of the valve", {"http://opcfoundation.org/BinarySchema/", "Double"}});
    return client::TypeDictionary{std::string{dictionary_uri}, {std::move(valve)}};
}

/// A structure with a definition, an enumeration that has its names in a property, and a structure
/// that only a type dictionary describes.
void add_types(model::AddressSpace& space)
{
    StructureDefinition axis;
    axis.default_encoding_id = NodeId{1, "Axis.Binary"};
    axis.fields.resize(2);
    axis.fields[0].name = "position of the axis";
    axis.fields[0].data_type = NodeId{0, id::Double};
    axis.fields[1].name = "mode of the axis";
    axis.fields[1].data_type = NodeId{1, "Mode"};
    axis.fields[0].value_rank = axis.fields[1].value_rank = -1;
    REQUIRE(model::add_structure_type(space, ClientWorld::node("Axis", space.find(id::Structure)),
                                      axis));
    const auto mode =
        space.add_data_type(ClientWorld::node("Mode", space.find(id::Enumeration)), {});
    REQUIRE(mode);
    model::NewNode strings = ClientWorld::node("Mode.EnumStrings", *mode);
    strings.browse_name = QualifiedName{0, "EnumStrings"};
    model::NewVariable names;
    names.data_type = NodeId{0, id::LocalizedText};
    names.value_rank = 1;
    names.value = Variant{Array<LocalizedText>{LocalizedText{"Off"}, LocalizedText{"On"}}};
    REQUIRE(space.add_property(strings, names));

    const auto valve =
        space.add_data_type(ClientWorld::node("Valve", space.find(id::Structure)), {});
    REQUIRE(valve);
    model::NewNode encoding = ClientWorld::node("Valve.Binary", *valve);
    encoding.browse_name = QualifiedName{0, "Default Binary"};
    encoding.reference_type = NodeId{0, id::HasEncoding};
    const auto encoded =
        space.add_object(encoding, model::NewObject{NodeId{0, id::DataTypeEncodingType}, 0});
    REQUIRE(encoded);
    model::NewVariable text;
    text.data_type = NodeId{0, id::ByteString};
    text.value = Variant{ByteString{std::vector<std::byte>(1)}};
    const auto dictionary = space.add_variable(
        ClientWorld::node("dictionary", space.find(id::OPCBinarySchema_TypeSystem)), text);
    REQUIRE(dictionary);
    text.data_type = NodeId{0, id::String};
    text.value = Variant{"Valve"};
    const auto description =
        space.add_variable(ClientWorld::node("Valve.Description", *dictionary), text);
    REQUIRE(description);
    REQUIRE(space.add_reference(*encoded, NodeId{0, id::HasDescription}, *description));
}

/// Good if everything is known of the type.
StatusCode is_known(ClientWorld& world, const char* name)
{
    const Uncounted in_test;
    const auto types = world.types->types();
    const binary::DynamicType* const type = types->find(NodeId{1, name});
    if (type == nullptr || type->fields.empty()) {
        return status::Bad_OutOfMemory;
    }
    const binary::DynamicType* const mode = types->find(NodeId{1, "Mode"});
    const bool has_mode = mode != nullptr && !mode->values.empty();
    return name == std::string_view{"Valve"} || has_mode ? StatusCode{} : status::Bad_OutOfMemory;
}

client::TypeCache& types_of(ClientWorld& world)
{
    const Uncounted in_test;
    if (!world.types) {
        add_types(world.site.server.address_space());
        world.types.emplace(world.client, client::TypeCacheLimits{}, parse_dictionary);
    }
    return *world.types;
}

void learn_type(ClientWorld& world)
{
    types_of(world).learn({NodeId{1, "Axis"}}, [&world] { world.answer(is_known(world, "Axis")); });
}

void learn_value(ClientWorld& world)
{
    types_of(world).learn_values(
        {Variant{ExtensionObject::from_binary(NodeId{1, "Axis.Binary"},
                                              ByteString{std::vector<std::byte>(12)})}},
        [&world] { world.answer(is_known(world, "Axis")); });
}

void learn_from_dictionary(ClientWorld& world)
{
    types_of(world).learn({NodeId{1, "Valve"}},
                          [&world] { world.answer(is_known(world, "Valve")); });
}

void write_text(ClientWorld& world)
{
    client::write_text(world.client, types_of(world), NodeId{1, "level"}, "12",
                       [&world](const client::Accessed<void>& done) {
                           world.answer(done ? StatusCode{} : done.error().status);
                       });
}

void call_text(ClientWorld& world)
{
    client::call_text(
        world.client, types_of(world), NodeId{0, id::ObjectsFolder}, NodeId{1, "start"}, {},
        [&world](const auto& done) { world.answer(done ? StatusCode{} : done.error().status); });
}

constexpr Row rows[] = {
    {"Read", call_read},
    {"Read in parts", read},
    {"Write", write},
    {"Call", call},
    {"TranslateBrowsePathsToNodeIds", translate},
    {"Browse", browse},
    {"Browse in parts", browse_in_parts},
    {"FindServers", find_servers},
    {"RegisterNodes", register_nodes},
    {"GetEndpoints", get_endpoints},
    {"a tree", browse_tree},
    {"a path", resolve_path},
    {"a path without namespaces", search_path},
    {"a path that means two nodes", search_twins},
    {"DataTypes", learn_type},
    {"DataTypes of values", learn_value},
    {"DataTypes of a type dictionary", learn_from_dictionary},
    {"writing a text", write_text},
    {"calling with texts", call_text},
};

/// What has thousands makes one type like the other.
std::size_t next(std::size_t k)
{
    return k < 300 ? k + 1 : k + std::max<std::size_t>(7, k / 10);
}

bool fail_once(const Row& row, std::size_t k)
{
    ClientWorld world;
    REQUIRE(world.is_ready());
    fail_allocation(k);
    const StatusCode answer = world.ask(row.ask);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.request << ", allocation " << k << ": " << name(answer) << "\n"
                     << world.site.log.text);
    CHECK(world.thrown == 0);
    if (has_failed) {
        CHECK((answer == status::Good || answer == status::Bad_OutOfMemory ||
               answer == status::Bad_ConnectionClosed));
        world.advance(60s);
        CHECK(world.is_ready());
    }
    CHECK((answer == status::Good || has_failed));
    CHECK(world.ask(row.ask) == status::Good);
    return has_failed;
}

} // namespace

TEST_CASE("an allocation that fails ends one request of a client, or its connection")
{
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.request)
        {
            check_failing_worlds(
                row.request, [&](std::size_t k) { return fail_once(row, k); }, next);
        }
    }
}

} // namespace allocation_failure_test
