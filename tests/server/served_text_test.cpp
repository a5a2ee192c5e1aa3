#include <catch2/catch.hpp>

#include "attribute_fixture.hpp"
#include "item_fixture.hpp"
#include "method_fixture.hpp"
#include "server/data/read_results.hpp"

namespace served_text_test {

// Texts of an application that are not UTF-8 (Part 6, 5.2.2.4).

using namespace busbar;
using namespace busbar::test;

namespace {

const char* const broken = "ok\xFF\xFE";
/// A surrogate, an overlong form, a sequence that is cut, and one past U+10FFFF.
const char* const kinds[] = {"\xED\xA0\x80", "\xC0\xAF", "long enough for a word \xE2\x82",
                             "\xF4\x90\x80\x80"};

/// A value of each type that has a text, with this one.
std::vector<Variant> values_with(const char* text)
{
    const String string{text};
    const Argument structure{string, NodeId{0, id::Int32}, -1, {}, {}};
    DataValue data{Variant{string}};
    DiagnosticInfo diagnostics;
    diagnostics.additional_info = string;
    return {Variant{string},
            Variant{Array<String>{String{"a"}, string}},
            Variant{XmlElement{string}},
            Variant{NodeId{1, string}},
            Variant{ExpandedNodeId{NodeId{1, 1}, string}},
            Variant{QualifiedName{1, string}},
            Variant{Array<QualifiedName>{QualifiedName{1, string}}},
            Variant{LocalizedText{string}},
            Variant{LocalizedText{string, String{"text"}}},
            Variant{Array<LocalizedText>{LocalizedText{"a"}, LocalizedText{string}}},
            Variant{ExtensionObject::from(structure)},
            Variant{Array<ExtensionObject>{ExtensionObject{}, ExtensionObject::from(structure)}},
            Variant{ExtensionObject::from_xml(NodeId{1, 1}, XmlElement{string})},
            Variant{ExtensionObject::from_binary(NodeId{1, string}, {})},
            Variant{std::move(data)},
            Variant{Array<Variant>{Variant{1}, Variant{string}}},
            Variant{std::move(diagnostics)}};
}

const std::vector<Variant> without_texts{
    Variant{},
    Variant{1},
    Variant{String{}},
    Variant{Array<String>{}},
    Variant{ByteString::borrow(std::as_bytes(std::span{"\xFF\xFE", 2}))},
    Variant{status::Bad_Timeout},
    Variant{DateTime{1}},
    Variant{ExtensionObject{}}};

} // namespace

TEST_CASE("a value is looked through for texts that are not UTF-8")
{
    using busbar::server::detail::has_valid_texts;
    for (const Variant& value : values_with("gr\xC3\xBC\xC3\x9F")) {
        CAPTURE(static_cast<int>(value.type()), value.is_array());
        CHECK(has_valid_texts(value));
    }
    for (const char* const text : kinds) {
        for (const Variant& value : values_with(text)) {
            CAPTURE(static_cast<int>(value.type()), value.is_array());
            CHECK_FALSE(has_valid_texts(value));
        }
    }
    for (const Variant& value : without_texts) {
        CHECK(has_valid_texts(value));
    }
}

TEST_CASE_METHOD(AttributeFixture, "a Read refuses the value whose text is not UTF-8, and no other")
{
    const NodeId bad = add("bad", id::String, Variant{String{broken}});
    const NodeId good = add("good", id::String, Variant{"good"});
    model::NewVariable kept;
    kept.data_type = NodeId{0, id::LocalizedText};
    kept.value = Variant{LocalizedText{String{broken}}};
    const NodeId of_space = add("kept", kept);

    ReadRequest request = read_request(
        {read_value_id(bad), read_value_id(good), read_value_id(of_space), read_value_id(good)});
    const auto values = read(request);
    CHECK(values[0] == DataValue{status::Bad_EncodingError});
    CHECK(values[1].value == Variant{"good"});
    CHECK(values[2].status == status::Bad_EncodingError);
    CHECK(values[2].value.is_null());
    CHECK(values[3].value == Variant{"good"});

    SECTION("and says so in the diagnostics")
    {
        auto job = read_job(request);
        REQUIRE(job.start(owner, TimePoint{}));
        job.finish();
        server::detail::ReturnDiagnostics diagnostics{0x0000'03E0};
        const auto infos = job.diagnose(diagnostics);
        REQUIRE(infos.size() == 4);
        CHECK(infos[0] != DiagnosticInfo{});
        CHECK(infos[1] == DiagnosticInfo{});
        CHECK(infos[2] != DiagnosticInfo{});
    }
}

TEST_CASE_METHOD(ItemFixture, "a notification has a status in place of a text that is not UTF-8")
{
    const NodeId text = add_variable("text", Variant{"first"}, id::String);
    auto item = item_request(text);
    item.requested_parameters.queue_size = 2;
    REQUIRE(monitor(client, id, item).status_code == status::Good);
    CHECK(next_data(client, cycle).size() == 1);

    set(1, Variant{String{broken}});
    auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.status == status::Bad_EncodingError);
    CHECK(data[0].value.value.is_null());
    CHECK(next_data(client, cycle).empty());

    set(1, Variant{"last"});
    data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.value == Variant{"last"});
}

TEST_CASE_METHOD(MethodFixture, "a Method whose output is not UTF-8 fails alone")
{
    const NodeId bad = add("Bad", {}, {argument(id::String)}, [](server::MethodCall call) {
        call.succeed({Variant{String{broken}}});
    });
    const NodeId sum = add_sum();
    TestClient client = log_in();
    const auto response =
        client.call<CallResponse>(request({to_call(bad), to_call(sum, {Variant{1}, Variant{2}})}));
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_EncodingError);
    CHECK(response->results[0].output_arguments.empty());
    CHECK(response->results[1].output_arguments[0] == Variant{3});
}

TEST_CASE("an AddressSpace takes no texts that are not UTF-8")
{
    model::AddressSpace space;
    const auto ns = space.add_namespace("urn:test").value();
    CHECK(space.add_namespace(broken).error() == status::Bad_EncodingError);
    model::NewNode node;
    node.id = NodeId{ns, "node"};
    node.browse_name = QualifiedName{ns, "node"};
    node.parent = space.find(id::ObjectsFolder);
    const auto refusal_with = [&](auto change) {
        model::NewNode changed = node;
        change(changed);
        const auto made = space.add_object(changed);
        return made ? StatusCode{} : made.error();
    };
    CHECK(refusal_with([](auto& it) {
              it.id = NodeId{1, String{broken}};
          }) == status::Bad_NodeIdInvalid);
    CHECK(refusal_with([](auto& it) { it.browse_name.name = String{broken}; }) ==
          status::Bad_BrowseNameInvalid);
    CHECK(refusal_with([](auto& it) { it.display_name = LocalizedText{String{broken}}; }) ==
          status::Bad_EncodingError);
    CHECK(refusal_with([](auto& it) { it.description = LocalizedText{String{broken}}; }) ==
          status::Bad_EncodingError);

    const auto made = space.add_object(node).value();
    space.set_display_name(made, LocalizedText{"name"});
    space.set_display_name(made, LocalizedText{String{broken}});
    CHECK(space.attribute(made, AttributeId::DisplayName).value() ==
          Variant{LocalizedText{"name"}});
    CHECK(space
              .set_text(made, AttributeId::Description,
                        DataValue{Variant{LocalizedText{String{broken}}}})
              .error() == status::Bad_EncodingError);
}

} // namespace served_text_test
