#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/client/type_cache.hpp>
#include <busbar/client/value_text.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "dictionary_samples.hpp"
#include "scripted_requester.hpp"

namespace busbar::client::dictionary_learning_test {

namespace {

using busbar::test::ScriptedRequester;

constexpr std::uint32_t type_base = 3'000;
constexpr std::uint32_t encoding_base = 5'000;
constexpr std::uint32_t description_base = 6'000;

/// A server before OPC UA 1.04: nodes have no DataTypeDefinition, and a type dictionary says what
/// lies in structures.
struct OldServer {
    OldServer()
    {
        requester.on<ReadRequest, ReadResponse>([this](const ReadRequest& request) {
            ReadResponse response;
            for (const ReadValueId& item : request.nodes_to_read) {
                response.results.push_back(is_down ? DataValue{status::Bad_Timeout}
                                                   : read_one(item));
            }
            return response;
        });
        requester.on<BrowseRequest, BrowseResponse>([this](const BrowseRequest& request) {
            BrowseResponse response;
            for (const BrowseDescription& item : request.nodes_to_browse) {
                response.results.push_back(browse_one(item));
            }
            return response;
        });
    }

    /// The number of a node whose id begins with `base`; nothing if it is none of ours.
    [[nodiscard]] std::optional<std::size_t> number(const NodeId& node, std::uint32_t base) const
    {
        const bool is_it = node.namespace_index() == 2 && node.is_numeric() &&
                           node.numeric() >= base && node.numeric() < base + names.size();
        return is_it ? std::optional<std::size_t>{node.numeric() - base} : std::nullopt;
    }
    [[nodiscard]] DataValue read_one(const ReadValueId& item) const
    {
        if (item.node_id == dictionary) {
            ++dictionary_reads;
            return DataValue{Variant{ByteString{std::as_bytes(std::span{xml})}}};
        }
        if (const auto described = number(item.node_id, description_base)) {
            return DataValue{Variant{String{names[*described]}}};
        }
        const auto type = number(item.node_id, type_base);
        if (!type) {
            return DataValue{status::Bad_NodeIdUnknown};
        }
        switch (AttributeId{item.attribute_id}) {
        case AttributeId::BrowseName:
            return DataValue{Variant{QualifiedName{2, String{names[*type]}}}};
        case AttributeId::IsAbstract:
            return DataValue{Variant{false}};
        default:
            return DataValue{status::Bad_AttributeIdInvalid};
        }
    }
    [[nodiscard]] BrowseResult browse_one(const BrowseDescription& item) const
    {
        const bool is_forward = item.browse_direction == BrowseDirection::Forward;
        BrowseResult result;
        const auto add = [&](const NodeId& target, const char* name) {
            ReferenceDescription& reference = result.references.emplace_back();
            reference.node_id = target;
            reference.browse_name = {0, name};
        };
        const auto add_of = [&](std::uint32_t from, std::uint32_t to, const char* name) {
            if (const auto found = number(item.node_id, from)) {
                add(NodeId{2, static_cast<std::uint32_t>(to + *found)}, name);
            }
        };
        if (item.reference_type_id.is(id::HasComponent)) {
            if (is_forward && item.node_id.is(id::OPCBinarySchema_TypeSystem)) {
                is_down = goes_down;
                add(NodeId{0, 7'617U}, "Opc.Ua");
                add(dictionary, "Press");
            } else if (!is_forward && number(item.node_id, description_base) && says_owner) {
                add(dictionary, "Press");
            }
        } else if (item.reference_type_id.is(id::HasEncoding)) {
            is_forward ? add_of(type_base, encoding_base, "Default Binary")
                       : add_of(encoding_base, type_base, "type");
        } else if (item.reference_type_id.is(id::HasDescription) && is_forward) {
            add_of(encoding_base, description_base, "description");
        } else if (item.reference_type_id.is(id::HasSubtype) && number(item.node_id, type_base)) {
            add(NodeId{0, id::Structure}, "Structure");
        }
        return result;
    }

    bool learn_values(std::vector<Variant> values)
    {
        bool is_done = false;
        cache.learn_values(std::move(values), [&] { is_done = true; });
        return requester.run() && is_done;
    }
    [[nodiscard]] std::string text_of(const Variant& value)
    {
        REQUIRE(learn_values({value}));
        const auto types = cache.types();
        TextOptions options;
        options.types = types.get();
        return to_text(value, options);
    }

    ScriptedRequester requester;
    std::vector<const char*> names{"PressStatus", "Report", "Reading", "Position"};
    NodeId dictionary{2, "dictionary"};
    std::string xml{test::press_dictionary()};
    mutable bool is_down{false};
    /// It is down as soon as somebody has looked for its dictionaries.
    bool goes_down{false};
    /// The dictionary is the owner of its descriptions.
    bool says_owner{true};
    mutable int dictionary_reads{0};
    TypeCache cache{requester, {}, &parse_type_dictionary};
};

/// An object of the type with that number.
template <typename... Parts>
Variant object_of(std::uint32_t number, const Parts&... parts)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    (encode(writer, parts), ...);
    const auto body = sink.take(writer.written());
    return Variant{ExtensionObject::from_binary(NodeId{2, encoding_base + number},
                                                ByteString{std::span{body}})};
}

Variant press_status()
{
    return object_of(0, String{"P1"}, std::int32_t{7}, std::uint8_t{3}, 10.0, 20.5, std::int32_t{2},
                     1.0, 2.0, 3.0, 4.0, std::int32_t{1}, std::uint16_t{9},
                     Variant{std::int32_t{-5}});
}

} // namespace

TEST_CASE_METHOD(OldServer, "A structure is read by its type dictionary",
                 "[unit:Address Space Client Complex Data Dictionary]")
{
    CHECK(text_of(press_status()) ==
          "PressStatus {Name: \"P1\", Mode: Jammed (7), Lamps: 3, Force: Range {Low: 10, High: "
          "20.5}, Path: [Position {X: 1, Y: 2}, Position {X: 3, Y: 4}], Counts: [9], Extra: -5}");
    CHECK(cache.dictionary_errors().empty());
    CHECK(cache.types()->errors().empty());
    CHECK(text_of(object_of(3, 1.5, 2.5)) == "Position {X: 1.5, Y: 2.5}");
    CHECK(dictionary_reads == 1);
    const int sent = requester.sent();
    REQUIRE(learn_values({press_status()}));
    CHECK(requester.sent() == sent);
}

TEST_CASE_METHOD(OldServer, "Optional fields and unions of a type dictionary are read")
{
    CHECK(text_of(object_of(1, std::uint32_t{2}, std::uint32_t{77}, std::int32_t{1},
                            String{"hot"})) == "Report {Number: 77, Notes: [\"hot\"]}");
    CHECK(text_of(object_of(2, std::uint32_t{1}, 2.5)) == "Reading {Value: 2.5}");
    CHECK(text_of(object_of(2, std::uint32_t{2}, std::int32_t{2}, std::uint8_t{1},
                            std::uint8_t{2})) == "Reading {Raw: [1, 2]}");
}

TEST_CASE_METHOD(OldServer, "A description that names no dictionary is found by its name")
{
    says_owner = false;
    CHECK(text_of(press_status()).find("PressStatus {Name: \"P1\"") == 0);
}

TEST_CASE_METHOD(OldServer, "Without a parser nobody asks for dictionaries")
{
    TypeCache plain{requester};
    bool is_done = false;
    plain.learn_values({press_status()}, [&] { is_done = true; });
    REQUIRE(requester.run());
    CHECK(is_done);
    CHECK(dictionary_reads == 0);
    CHECK(plain.types()->find_encoding(NodeId{2, encoding_base}) == nullptr);
}

TEST_CASE_METHOD(OldServer, "What a dictionary cannot describe stays encoded, with the reason")
{
    const auto reason = [&](std::string types) {
        xml = test::dictionary_of(types);
        REQUIRE(learn_values({press_status()}));
        CHECK(cache.types()->find_encoding(NodeId{2, encoding_base}) == nullptr);
        const auto& errors = cache.dictionary_errors();
        REQUIRE_FALSE(errors.empty());
        return to_string(errors.back());
    };
    SECTION("a layout that OPC UA does not have")
    {
        CHECK(reason("<opc:StructuredType Name='PressStatus'>"
                     "<opc:Field Name='X' TypeName='opc:Byte' Length='4'/></opc:StructuredType>") ==
              "ns=2;i=3000 (PressStatus): field X: its length is fixed");
    }
    SECTION("a type that nobody has")
    {
        CHECK(reason("<opc:StructuredType Name='PressStatus'>"
                     "<opc:Field Name='X' TypeName='tns:Other'/></opc:StructuredType>") ==
              "ns=2;i=3000 (PressStatus): field X: no dictionary has its type Other of "
              "urn:acme:press:types");
    }
    SECTION("another name")
    {
        CHECK(reason("<opc:StructuredType Name='Other'/>") ==
              "ns=2;i=3000 (PressStatus): no type dictionary describes it");
    }
    SECTION("no dictionary at all")
    {
        xml = "<html/>";
        REQUIRE(learn_values({press_status()}));
        REQUIRE(cache.dictionary_errors().size() == 2);
        CHECK(cache.dictionary_errors()[0].reason == "found <html>, expected <TypeDictionary>");
    }
}

TEST_CASE_METHOD(OldServer, "Structures that contain each other are refused with their users")
{
    xml = test::dictionary_of("<opc:StructuredType Name='PressStatus'>"
                              "<opc:Field Name='X' TypeName='tns:Other'/></opc:StructuredType>"
                              "<opc:StructuredType Name='Other'>"
                              "<opc:Field Name='X' TypeName='tns:PressStatus'/>"
                              "</opc:StructuredType>");
    REQUIRE(learn_values({press_status()}));
    CHECK(cache.types()->find_encoding(NodeId{2, encoding_base}) == nullptr);
    CHECK_FALSE(cache.types()->errors().empty());
}

TEST_CASE_METHOD(OldServer, "A dictionary that did not come is asked for again")
{
    goes_down = true;
    REQUIRE(learn_values({press_status()}));
    CHECK(dictionary_reads == 0);
    CHECK(cache.types()->find_encoding(NodeId{2, encoding_base}) == nullptr);
    is_down = goes_down = false;
    CHECK(text_of(press_status()).find("PressStatus {Name: \"P1\"") == 0);
}

TEST_CASE_METHOD(OldServer, "Another server in the middle of a lesson does no harm")
{
    const int steps = GENERATE(1, 2, 3, 4, 5, 6, 7, 8);
    bool is_done = false;
    cache.learn_values({press_status()}, [&] { is_done = true; });
    for (int i = 0; i < steps; ++i) {
        requester.step();
    }
    ++requester.info.revision;
    REQUIRE(requester.run());
    CHECK(is_done);
    CHECK(text_of(press_status()).find("PressStatus {Name: \"P1\"") == 0);
}

TEST_CASE_METHOD(OldServer, "A cancelled lesson in dictionaries is repeated")
{
    const int steps = GENERATE(1, 2, 3, 4, 5, 6, 7, 8);
    bool is_done = false;
    Operation operation = cache.learn_values({press_status()}, [&] { is_done = true; });
    for (int i = 0; i < steps; ++i) {
        requester.step();
    }
    const bool was_done = is_done;
    operation.cancel();
    REQUIRE(requester.run());
    CHECK(is_done == was_done);
    CHECK(text_of(press_status()).find("PressStatus {Name: \"P1\"") == 0);
}

TEST_CASE_METHOD(OldServer, "No more types are taken from dictionaries than from nodes")
{
    TypeCacheLimits limits;
    limits.max_types = 3;
    TypeCache small{requester, limits, &parse_type_dictionary};
    const std::size_t standard = small.types()->size();
    bool is_done = false;
    small.learn_values({press_status(), object_of(1, 0), object_of(2, 0), object_of(3, 0)},
                       [&] { is_done = true; });
    REQUIRE(requester.run());
    CHECK(is_done);
    CHECK(small.types()->size() <= standard + 3);
}

} // namespace busbar::client::dictionary_learning_test
