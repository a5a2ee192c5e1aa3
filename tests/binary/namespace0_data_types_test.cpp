#include <catch2/catch.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/dynamic_value.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/registry.hpp>

namespace namespace0_data_types_test {

using namespace busbar;
using binary::DynamicType;
using binary::DynamicTypes;

TEST_CASE("the DataTypes of namespace 0 are there to be compiled", "[binary][dynamic]")
{
    const DynamicTypes types = DynamicTypes::compile(binary::namespace0_data_types());
    CHECK(types.errors().empty());
    const DynamicType* const state = types.find(NodeId{0, id::ServerState});
    REQUIRE(state != nullptr);
    CHECK(state->kind == DynamicType::Kind::Enumeration);
    CHECK(state->values.at(3).name == "Suspended");
    const DynamicType* const status = types.find(NodeId{0, id::ServerStatusDataType});
    REQUIRE(status != nullptr);
    CHECK(status->base == types.find(NodeId{0, id::Structure}));
    CHECK(status->find_field("BuildInfo") == 3U);
    CHECK(types.find(NodeId{0, id::Duration})->built_in == BuiltInType::Double);
}

TEST_CASE("the definitions of namespace 0 are those of its generated types", "[binary][dynamic]")
{
    const DynamicTypes types = DynamicTypes::compile(binary::namespace0_data_types());
    REQUIRE_FALSE(binary::namespace0_types().empty());
    for (const StructureType* const type : binary::namespace0_types()) {
        const auto object =
            ExtensionObject::adopt(*type, type->create(), type->binary_encoding_id.in(0));
        INFO(type->name);
        const auto dynamic = binary::decode_dynamic(object, types);
        REQUIRE(dynamic);
        CHECK(dynamic->type().name == type->name);
        const auto bytes = binary::to_bytes(*dynamic);
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, object);
        REQUIRE(bytes);
        // Behind the NodeId, the encoding and the length.
        const auto whole = sink.take(writer.written());
        REQUIRE(whole.size() >= bytes->size());
        CHECK(std::equal(bytes->rbegin(), bytes->rend(), whole.rbegin()));
    }
}

} // namespace namespace0_data_types_test
