#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/client/attributes.hpp>
#include <busbar/client/type_cache.hpp>
#include <busbar/client/value_text.hpp>

#include "binary/dynamic_samples.hpp"
#include "scripted_requester.hpp"
#include "server_requester.hpp"

namespace busbar::client::type_cache_test {

namespace {

using binary::DataTypeEntry;
using busbar::test::encoding_of;
using busbar::test::ScriptedRequester;
using busbar::test::type_id;

/// A server with the DataTypes of `entries`.
struct TypeServer {
    TypeServer()
    {
        requester.on<ReadRequest, ReadResponse>([this](const ReadRequest& request) {
            ReadResponse response;
            for (const ReadValueId& item : request.nodes_to_read) {
                ++reads;
                response.results.push_back(read_one(item));
            }
            return response;
        });
        requester.on<BrowseRequest, BrowseResponse>([this](const BrowseRequest& request) {
            BrowseResponse response;
            for (const BrowseDescription& item : request.nodes_to_browse) {
                ++browses;
                response.results.push_back(browse_one(item));
            }
            return response;
        });
    }
    [[nodiscard]] const DataTypeEntry* find(const NodeId& id) const
    {
        const auto found = std::find_if(entries.begin(), entries.end(),
                                        [&](const DataTypeEntry& entry) { return entry.id == id; });
        return found == entries.end() ? nullptr : &*found;
    }
    [[nodiscard]] DataValue read_one(const ReadValueId& item) const
    {
        if (item.node_id == enum_strings) {
            return DataValue{Variant{
                Array<LocalizedText>{LocalizedText{"Off"}, LocalizedText{}, LocalizedText{"On"}}}};
        }
        const bool is_variable = item.node_id.is_numeric() && item.node_id.numeric() > variables;
        const DataTypeEntry* const entry = find(
            is_variable ? NodeId{item.node_id.namespace_index(), item.node_id.numeric() - variables}
                        : item.node_id);
        if (entry == nullptr || is_down) {
            return DataValue{is_down ? status::Bad_Timeout : status::Bad_NodeIdUnknown};
        }
        if (item.attribute_id == static_cast<std::uint32_t>(AttributeId::DataType)) {
            return DataValue{Variant{entry->id}}; // of a Variable of that name
        }
        switch (AttributeId{item.attribute_id}) {
        case AttributeId::BrowseName:
            return DataValue{Variant{QualifiedName{2, entry->name}}};
        case AttributeId::IsAbstract:
            return DataValue{Variant{entry->is_abstract}};
        default:
            break;
        }
        if (const auto* structure = std::get_if<StructureDefinition>(&entry->definition)) {
            return DataValue{Variant{ExtensionObject::from(*structure)}};
        }
        if (const auto* names = std::get_if<EnumDefinition>(&entry->definition)) {
            return DataValue{Variant{ExtensionObject::from(*names)}};
        }
        return DataValue{status::Bad_AttributeIdInvalid};
    }
    [[nodiscard]] BrowseResult browse_one(const BrowseDescription& item) const
    {
        BrowseResult result;
        const auto add = [&](const NodeId& target, QualifiedName name) {
            ReferenceDescription& reference = result.references.emplace_back();
            reference.node_id = target;
            reference.browse_name = std::move(name);
        };
        if (item.reference_type_id.is(id::HasEncoding) &&
            item.browse_direction == BrowseDirection::Inverse) {
            for (const DataTypeEntry& entry : entries) {
                if (encoding(entry) == item.node_id) {
                    add(entry.id, {2, entry.name});
                }
            }
            return result;
        }
        const DataTypeEntry* const entry = find(item.node_id);
        if (entry == nullptr) {
            result.status_code = status::Bad_NodeIdUnknown;
        } else if (item.reference_type_id.is(id::HasEncoding) && !encoding(*entry).is_null()) {
            add(NodeId{2, "xml"}, {0, "Default XML"});
            add(encoding(*entry), {0, "Default Binary"});
        } else if (item.reference_type_id.is(id::HasSubtype)) {
            add(base(*entry), {0, "base"});
        } else if (item.reference_type_id.is(id::HasProperty) && entry->name == String{"Old"}) {
            add(enum_strings, {0, "EnumStrings"});
        }
        return result;
    }
    [[nodiscard]] NodeId encoding(const DataTypeEntry& entry) const
    {
        if (!has_encodings) {
            return {};
        }
        const auto* const structure = std::get_if<StructureDefinition>(&entry.definition);
        return structure != nullptr && entry.encoding_id.is_null() ? structure->default_encoding_id
                                                                   : entry.encoding_id;
    }
    [[nodiscard]] static NodeId base(const DataTypeEntry& entry)
    {
        const auto* const structure = std::get_if<StructureDefinition>(&entry.definition);
        return structure != nullptr && entry.base.is_null() ? structure->base_data_type
                                                            : entry.base;
    }

    bool learn(std::vector<NodeId> types)
    {
        bool is_done = false;
        cache.learn(std::move(types), [&] { is_done = true; });
        CHECK_FALSE(is_done);
        return requester.run() && is_done;
    }
    bool learn_values(std::vector<Variant> values, std::vector<NodeId> nodes)
    {
        bool is_done = false;
        cache.learn_values(std::move(values), std::move(nodes), [&] { is_done = true; });
        return requester.run() && is_done;
    }
    bool learn_values(std::vector<Variant> values)
    {
        bool is_done = false;
        cache.learn_values(std::move(values), [&] { is_done = true; });
        CHECK_FALSE(is_done);
        return requester.run() && is_done;
    }

    ScriptedRequester requester;
    std::vector<DataTypeEntry> entries{test::plant_types()};
    NodeId enum_strings{2, "strings"};
    bool is_down{false};
    /// References HasEncoding.
    bool has_encodings{true};
    /// The Variable of a type has this much more in its NodeId.
    static constexpr std::uint32_t variables = 100'000;
    int reads{0};
    int browses{0};
    TypeCache cache{requester};
};

Variant object_of(const binary::DynamicValue& value)
{
    return Variant{binary::to_extension_object(value).value()};
}

} // namespace

TEST_CASE_METHOD(TypeServer, "The types of values are learned once, with what they need",
                 "[unit:Address Space Client DataTypeDefinition Attribute]")
{
    for (const binary::DynamicValue& value : test::samples()) {
        REQUIRE(learn_values({object_of(value)}));
        const auto types = cache.types();
        const auto again =
            binary::decode_dynamic(*object_of(value).get_if<ExtensionObject>(), *types);
        INFO(value.type().name);
        REQUIRE(again);
        CHECK(again->type().name == value.type().name);
        CHECK(binary::to_extension_object(*again) == binary::to_extension_object(value));
    }
    const int sent = requester.sent();
    REQUIRE(learn_values({object_of(test::full_part())}));
    CHECK(requester.sent() == sent);
    // A structure within a structure, whose field does not say of what type it is.
    const auto types = cache.types();
    CHECK(types->find_encoding(encoding_of(test::types::Measurement)) != nullptr);
}

TEST_CASE_METHOD(TypeServer, "What is in a structure that is just learned is looked at, too")
{
    REQUIRE(learn_values({Variant{Array<Variant>{object_of(test::full_container())}}}));
    CHECK(cache.types()->find_encoding(encoding_of(test::types::Measurement)) != nullptr);
    CHECK(cache.types()->find_encoding(encoding_of(test::types::Point3D)) != nullptr);
    TextOptions options;
    const auto types = cache.types();
    options.types = types.get();
    CHECK(to_text(object_of(test::full_container()), options).find("Mode: Auto (2)") !=
          std::string::npos);
}

TEST_CASE_METHOD(TypeServer, "Another namespace table makes types unknown; a snapshot stays")
{
    const std::size_t standard = cache.types()->size();
    REQUIRE(learn({type_id(test::types::Point)}));
    const auto before = cache.types();
    CHECK(before->size() == standard + 1);
    ++requester.info.revision;
    CHECK(cache.types()->size() == standard);
    CHECK(before->find(type_id(test::types::Point))->fields.size() == 2);
    REQUIRE(learn({type_id(test::types::Point)}));
    CHECK(cache.types()->size() == standard + 1);

    // In the middle of learning, too.
    bool is_done = false;
    cache.learn({type_id(test::types::Part)}, [&] { is_done = true; });
    requester.step();
    ++requester.info.revision;
    REQUIRE(requester.run());
    CHECK(is_done);
    CHECK(cache.types()->size() == standard);
}

TEST_CASE_METHOD(TypeServer, "Enumerations of older servers have names, too")
{
    entries.push_back(test::simple(50, "Old", NodeId{0, id::Enumeration}));
    REQUIRE(learn({type_id(50), type_id(test::types::Mode), NodeId{0, id::Int32}}));
    const auto types = cache.types();
    const binary::DynamicType* const old = types->find(type_id(50));
    REQUIRE(old != nullptr);
    REQUIRE(old->values.size() == 2);
    CHECK(old->values[1].name == "On");
    CHECK(old->values[1].value == 2);
    CHECK(types->find(type_id(test::types::Mode))->values.size() == 3);
}

TEST_CASE_METHOD(TypeServer, "Types of namespace 0 are known without asking",
                 "[unit:Base Info Client Type Pre-Knowledge]")
{
    const auto types = cache.types();
    CHECK(types->errors().empty());
    ServerStatusDataType status;
    status.state = ServerState::Suspended;
    status.build_info.product_name = String{"Press"};
    const Variant value{ExtensionObject::from(status)};
    REQUIRE(learn_values({value}));
    CHECK(requester.sent() == 0);
    TextOptions options;
    options.types = types.get();
    const std::string text = to_text(value, options);
    CHECK(text.find("State: Suspended (3)") != std::string::npos);
    CHECK(text.find("ProductName: \"Press\"") != std::string::npos);
    // As they come where the build's own decoder does not know them, too.
    const auto bytes = binary::to_bytes(status);
    REQUIRE(bytes);
    const Variant encoded{ExtensionObject::from_binary(NodeId{0, 864U}, ByteString{*bytes})};
    CHECK(to_text(encoded, options) == text);
    // Where a server says otherwise, it is not asked.
    REQUIRE(learn({NodeId{0, id::Range}, NodeId{0, id::ServerState}, NodeId{0, id::Duration}}));
    CHECK(requester.sent() == 0);
}

TEST_CASE_METHOD(TypeServer, "A server that does not describe its types is not asked again")
{
    entries.clear();
    const std::size_t standard = cache.types()->size();
    const Variant value = object_of(test::point(1, 2));
    REQUIRE(learn_values({value}));
    CHECK(cache.types()->size() == standard);
    const int sent = requester.sent();
    REQUIRE(learn_values({value}));
    CHECK(requester.sent() == sent);

    // But one that did not answer is.
    ++requester.info.revision;
    entries = test::plant_types();
    is_down = true;
    REQUIRE(learn_values({value}));
    CHECK(cache.types()->size() == standard);
    is_down = false;
    REQUIRE(learn_values({value}));
    CHECK(cache.types()->find_encoding(encoding_of(test::types::Point)) != nullptr);
}

TEST_CASE_METHOD(TypeServer, "An encoding that no node has is that of the Variable's DataType")
{
    has_encodings = false;
    const NodeId type = type_id(test::types::Point);
    const NodeId variable{type.namespace_index(), type.numeric() + variables};
    const Variant value = object_of(test::point(1, 2));
    NodeId encoding = encoding_of(test::types::Point);
    SECTION("DefaultEncodingId") {}
    SECTION("the DataType's own id")
    {
        encoding = type;
    }
    SECTION("an id of nothing")
    {
        encoding = NodeId{2, 4711U};
    }
    const ExtensionObject sent =
        ExtensionObject::from_binary(encoding, value.get_if<ExtensionObject>()->binary());
    REQUIRE(learn_values({Variant{sent}}));
    CHECK(cache.types()->find_encoding(encoding) == nullptr);
    REQUIRE(learn_values({Variant{Array<ExtensionObject>{ExtensionObject{}, sent}}}, {variable}));
    const auto types = cache.types();
    REQUIRE(types->find_encoding(encoding) != nullptr);
    CHECK(types->find_encoding(encoding)->name == "Point");
    const auto decoded = binary::decode_dynamic(sent, *types);
    REQUIRE(decoded);
    // And back as the server wrote it.
    CHECK(binary::to_extension_object(*decoded) == sent);
    const int before = requester.sent();
    REQUIRE(learn_values({Variant{sent}}, {variable}));
    CHECK(requester.sent() == before);
}

TEST_CASE_METHOD(TypeServer, "A value that is no such structure is not taken for one")
{
    const NodeId type = type_id(test::types::Point);
    const NodeId variable{type.namespace_index(), type.numeric() + variables};
    const ExtensionObject other = ExtensionObject::from_binary(
        NodeId{2, 4711U}, ByteString{std::as_bytes(std::span{"too short", 3})});
    REQUIRE(learn_values({Variant{other}}, {variable}));
    CHECK(cache.types()->find_encoding(NodeId{2, 4711U}) == nullptr);
    // The server is not asked again, and values with the right id are still known.
    const int sent = requester.sent();
    REQUIRE(learn_values({Variant{other}}, {variable}));
    CHECK(requester.sent() == sent);
    CHECK(cache.types()->find_encoding(encoding_of(test::types::Point)) != nullptr);
}

TEST_CASE_METHOD(TypeServer, "A cancelled lesson is repeated whole")
{
    const int steps = GENERATE(0, 1, 2, 3);
    bool is_done = false;
    Operation operation = cache.learn({type_id(test::types::Part)}, [&] { is_done = true; });
    for (int i = 0; i < steps; ++i) {
        requester.step();
    }
    operation.cancel();
    REQUIRE(requester.run());
    CHECK_FALSE(is_done);
    REQUIRE(learn({type_id(test::types::Part)}));
    CHECK(cache.types()->find(type_id(test::types::Part)) != nullptr);
}

TEST_CASE_METHOD(TypeServer, "Definitions that lie are not believed, nor followed for ever")
{
    const std::size_t standard = cache.types()->size();
    SECTION("a structure within itself")
    {
        entries = {test::structure(1, "Self", StructureDefinitionType::Structure,
                                   {test::field("Me", type_id(1))})};
        REQUIRE(learn({type_id(1)}));
        CHECK(cache.types()->find(type_id(1)) == nullptr);
    }
    SECTION("supertypes in a circle")
    {
        entries = {test::simple(1, "A", type_id(2)), test::simple(2, "B", type_id(1))};
        REQUIRE(learn({type_id(1)}));
        CHECK(cache.types()->size() == standard);
    }
    SECTION("an encoding whose type has another one")
    {
        entries[3].encoding_id = encoding_of(99);
        entries[3].definition = StructureDefinition{};
        const Variant value{ExtensionObject::from_binary(encoding_of(99), ByteString{})};
        REQUIRE(learn_values({value}));
        const int sent = requester.sent();
        REQUIRE(learn_values({value}));
        CHECK(requester.sent() == sent);
    }
    SECTION("types without end")
    {
        requester.on<ReadRequest, ReadResponse>([](const ReadRequest& request) {
            ReadResponse response;
            for (const ReadValueId& item : request.nodes_to_read) {
                StructureDefinition definition;
                const std::uint32_t n = item.node_id.numeric();
                definition.fields = {test::field("a", NodeId{2, n * 2}),
                                     test::field("b", NodeId{2, n * 2 + 1})};
                response.results.push_back(
                    AttributeId{item.attribute_id} == AttributeId::DataTypeDefinition
                        ? DataValue{Variant{ExtensionObject::from(definition)}}
                        : DataValue{});
            }
            return response;
        });
        TypeCacheLimits limits;
        limits.max_types = 100;
        TypeCache small{requester, limits};
        bool is_done = false;
        small.learn({NodeId{2, 1}}, [&] { is_done = true; });
        REQUIRE(requester.run());
        CHECK(is_done);
        CHECK(small.types()->size() == standard);
        limits.max_types = 5'000;
        limits.max_steps = 3;
        TypeCache shallow{requester, limits};
        is_done = false;
        shallow.learn({NodeId{2, 1}}, [&] { is_done = true; });
        REQUIRE(requester.run());
        CHECK(is_done);
    }
}

TEST_CASE("The types of a server's own values are learned")
{
    test::ServerFixture fixture;
    test::ServerRequester requester{fixture.log_in()};
    TypeCache cache{requester};
    std::vector<DataValue> values;
    read(requester, {attribute_of(NodeId{0, id::Server_ServerStatus})},
         [&](std::vector<DataValue> v) { values = std::move(v); });
    requester.run();
    REQUIRE(values.size() == 1);
    cache.learn_values({values[0].value}, [] {});
    cache.learn({NodeId{0, id::ServerState}}, [] {});
    requester.run();
    const auto types = cache.types();
    TextOptions options;
    options.types = types.get();
    CHECK(to_text(values[0], options).find("State: Running (0)") != std::string::npos);
    CHECK(types->find(NodeId{0, id::ServerState})->values.size() > 5);
}

} // namespace busbar::client::type_cache_test
