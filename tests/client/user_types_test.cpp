#include <catch2/catch.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/client/attributes.hpp>
#include <busbar/client/connection.hpp>
#include <busbar/types/data_types.hpp>

#include "client_fixture.hpp"

namespace user_types_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr const char* press_uri = "urn:busbar:test:press";

/// A structure as busbar-generate makes it of a model.
struct Stroke {
    std::int32_t count{0};

    static const StructureType type;

    friend bool operator==(const Stroke&, const Stroke&) = default;
};

void encode(binary::Writer& writer, const Stroke& value)
{
    busbar::encode(writer, value.count);
}

void decode(binary::Reader& reader, Stroke& value)
{
    busbar::decode(reader, value.count);
}

constinit const StructureType Stroke::type =
    busbar::detail::make_structure_type<Stroke>("Stroke", press_uri, {3000, {}}, {5000, {}});

binary::TypeRegistry::Table press_types()
{
    static constexpr const StructureType* types[] = {&Stroke::type};
    return types;
}

/// A Variable of every server, with a Stroke and a Range.
void add_stroke(server::Server& server)
{
    auto& space = server.address_space();
    const std::uint16_t index = space.add_namespace(press_uri).value();
    model::NewNode node;
    node.id = NodeId{1, "stroke"};
    node.browse_name = QualifiedName{index, "stroke"};
    node.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Structure};
    variable.value_rank = 1;
    variable.value = Variant{Array<ExtensionObject>{ExtensionObject::from(Stroke{7}, index),
                                                    ExtensionObject::from(Range{1, 2})}};
    REQUIRE(space.add_variable(node, variable));
}

struct Plant : ClientFixture {
    explicit Plant(client::ClientConfig config) : ClientFixture{std::move(config)}
    {
        add_stroke(site->server);
        connect();
    }
    [[nodiscard]] static client::ClientConfig with_types()
    {
        auto config = named_user();
        config.types = {press_types()};
        return config;
    }
    Array<ExtensionObject> read_objects()
    {
        Array<ExtensionObject> objects;
        client::read(client, {client::attribute_of(NodeId{1, "stroke"})},
                     [&](const std::vector<DataValue>& values) {
                         CHECK(values.at(0).status == status::Good);
                         objects = values.at(0).value.array_if<ExtensionObject>() != nullptr
                                       ? *values.at(0).value.array_if<ExtensionObject>()
                                       : Array<ExtensionObject>{};
                     });
        run();
        REQUIRE(objects.size() == 2);
        CHECK(objects[1].get_if<Range>() != nullptr);
        return objects;
    }
};

} // namespace

TEST_CASE("Structures of a user's types are objects, wherever the server has their namespace",
          "[unit:Attribute Client Read Complex]")
{
    Plant plant{Plant::with_types()};
    REQUIRE(plant.is_ready());
    auto stroke = plant.read_objects()[0];
    REQUIRE(stroke.get_if<Stroke>() != nullptr);
    CHECK(stroke.get_if<Stroke>()->count == 7);
    // The next server has another namespace before it.
    const auto before = stroke.encoding_id().namespace_index();
    plant.is_reachable = false;
    plant.restart(plant.server_config);
    REQUIRE(plant.site->server.address_space().add_namespace("urn:busbar:test:other"));
    add_stroke(plant.site->server);
    plant.is_reachable = true;
    plant.advance(std::chrono::seconds{40});
    REQUIRE(plant.is_ready());
    stroke = plant.read_objects()[0];
    CHECK(stroke.encoding_id().namespace_index() == before + 1);
    CHECK(stroke.get_if<Stroke>() != nullptr);
}

TEST_CASE("Structures of types that a client was not given are bytes")
{
    Plant plant{Plant::named_user()};
    const auto objects = plant.read_objects();
    CHECK(objects[0].get_if<Stroke>() == nullptr);
    CHECK(objects[0].body() == ExtensionObject::Body::Binary);
}

TEST_CASE("An event's response is decoded with the types that are given")
{
    ReadResponse response;
    response.results.push_back(DataValue{Variant{ExtensionObject::from(Stroke{9}, 3)}});
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, NodeId{0, ReadResponse::binary_encoding_id});
    encode(writer, response);
    client::ConnectionEvent event;
    event.body = sink.take(writer.written());
    binary::TypeRegistry types{client::standard_types()};
    types.add(3, press_types());
    const auto known = event.response<ReadResponse>({}, types);
    REQUIRE(known);
    const auto* object = known->results[0].value.get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    REQUIRE(object->get_if<Stroke>() != nullptr);
    CHECK(object->get_if<Stroke>()->count == 9);
    const auto unknown = event.response<ReadResponse>();
    REQUIRE(unknown);
    CHECK(unknown->results[0].value.get_if<ExtensionObject>()->get_if<Stroke>() == nullptr);
}

} // namespace user_types_test
