#include <catch2/catch.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/types/registry.hpp>

#include "event_filter_fixture.hpp"

namespace busbar::server::detail::event_filter_test {

using namespace busbar::test;
using enum FilterOperator;

TEST_CASE_METHOD(FilterFixture, "select clauses are checked by the event types")
{
    CHECK(select_status(field("Severity")) == status::Good);
    CHECK(select_status(own_field("A")) == status::Good);
    CHECK(select_status(own_field("Values")) == status::Good);
    // What a subtype adds, events of the type may have; what another type has, they never do.
    CHECK(select_status(field({own("Values")}, own_id("AType"))) == status::Good);
    CHECK(select_status(field({own("A")}, own_id("SubType"))) == status::Good);
    CHECK(select_status(field({own("B")}, own_id("AType"))) == status::Bad_NodeIdUnknown);
    CHECK(select_status(field({QualifiedName{0, "Severity"}}, own_id("AType"))) == status::Good);
    CHECK(select_status(field({own("Part"), own("Code")})) == status::Good);
    CHECK(select_status(field({own("Part"), own("Nothing")})) == status::Bad_NodeIdUnknown);
    CHECK(select_status(field("A")) == status::Bad_NodeIdUnknown); // the other namespace
    CHECK(select_status(field({own("A"), own("A")})) == status::Bad_NodeIdUnknown);
    CHECK(select_status(field({QualifiedName{}})) == status::Bad_BrowseNameInvalid);
    CHECK(select_status(field({own("Part"), QualifiedName{}})) == status::Bad_BrowseNameInvalid);
    CHECK(select_status(field({own("A")}, NodeId{})) == status::Bad_TypeDefinitionInvalid);
    CHECK(select_status(field({own("A")}, NodeId{9, "x"})) == status::Bad_TypeDefinitionInvalid);
    CHECK(select_status(field({own("A")}, NodeId{0, id::BaseObjectType})) ==
          status::Bad_TypeDefinitionInvalid);
}

TEST_CASE_METHOD(FilterFixture, "select clauses name a variable's value or an object's id")
{
    const auto with = [](SimpleAttributeOperand operand, AttributeId attribute,
                         const char* range = nullptr) {
        operand.attribute_id = static_cast<std::uint32_t>(attribute);
        if (range != nullptr) {
            operand.index_range = range;
        }
        return operand;
    };
    CHECK(select_status(with(field("Severity"), AttributeId::DisplayName)) ==
          status::Bad_AttributeIdInvalid);
    CHECK(select_status(with(field("Severity"), AttributeId{0})) == status::Bad_AttributeIdInvalid);
    CHECK(select_status(with(field("Severity"), AttributeId{4'000'000'000})) ==
          status::Bad_AttributeIdInvalid);
    CHECK(select_status(with(field({}), AttributeId::NodeId)) == status::Good);
    CHECK(select_status(with(field({}), AttributeId::Value)) == status::Bad_AttributeIdInvalid);
    CHECK(select_status(with(own_field("Part"), AttributeId::NodeId)) == status::Good);
    CHECK(select_status(own_field("Part")) == status::Bad_AttributeIdInvalid);

    CHECK(select_status(with(own_field("Values"), AttributeId::Value, "0:1")) == status::Good);
    CHECK(select_status(with(own_field("Values"), AttributeId::Value, "1:0")) ==
          status::Bad_IndexRangeInvalid);
    CHECK(select_status(with(own_field("A"), AttributeId::Value, "0")) == status::Bad_TypeMismatch);
    CHECK(select_status(with(field("Severity"), AttributeId::Value, "0")) ==
          status::Bad_TypeMismatch);
    CHECK(select_status(with(field("SourceName"), AttributeId::Value, "0:2")) == status::Good);
    CHECK(select_status(with(field({}), AttributeId::NodeId, "0")) == status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(FilterFixture, "select clauses give fields, nulls and reasons")
{
    EventFilter filter = selecting({"EventType", "SourceNode", "SourceName", "Time", "ReceiveTime",
                                    "Message", "Severity", "NoSuchField"});
    filter.select_clauses.push_back(own_field("Values"));
    filter.select_clauses.push_back(own_field("Values"));
    filter.select_clauses.back().index_range = "1:5";
    filter.select_clauses.push_back(own_field("Values"));
    filter.select_clauses.back().index_range = "7";
    filter.select_clauses.push_back(field({own("A")}, own_id("SubType")));
    filter.select_clauses.push_back(field({own("Part"), own("Code")}));
    filter.select_clauses.push_back(field({}));
    filter.select_clauses.back().attribute_id = 1;
    REQUIRE(compile(filter) == status::Good);
    REQUIRE(result.select_clause_results.size() == filter.select_clauses.size());
    CHECK(result.select_clause_results[6] == status::Good);
    CHECK(result.select_clause_results[7] == status::Bad_NodeIdUnknown);
    CHECK(result.where_clause_result.element_results.is_null());

    Event event = event_of("SubType");
    event.source_node = NodeId{0, id::Server};
    event.source_name = "Press";
    event.message = LocalizedText{"en", "hot"};
    event.severity = 2'000;
    event.set(own("Values"), Array<double>{1, 2, 3}).set(own("A"), status::Bad_UserAccessDenied);
    event.instance = NodeId{ns, 77U};
    auto values = compiled.select(*raise(event), space);
    REQUIRE(values.size() == filter.select_clauses.size());
    CHECK(values[0] == Variant{own_id("SubType")});
    CHECK(values[1] == Variant{NodeId{0, id::Server}});
    CHECK(values[2] == Variant{"Press"});
    CHECK(values[3] == Variant{DateTime::from_unix_seconds(9)});
    CHECK(values[4] == values[3]);
    CHECK(values[5] == Variant{LocalizedText{"en", "hot"}});
    CHECK(values[6] == Variant{std::uint16_t{1'000}});
    CHECK(values[7].is_null());
    CHECK(values[8] == Variant{Array<double>{1, 2, 3}});
    CHECK(values[9] == Variant{Array<double>{2, 3}});
    CHECK(values[10] == Variant{status::Bad_IndexRangeNoData});
    CHECK(values[11] == Variant{status::Bad_UserAccessDenied});
    CHECK(values[12].is_null());
    CHECK(values[13] == Variant{NodeId{ns, 77U}});

    event.event_type = own_id("AType");
    event.severity = 0;
    event.set({own("Part"), own("Code")}, "X7");
    values = compiled.select(*raise(event), space);
    CHECK(values[6] == Variant{std::uint16_t{1}});
    CHECK(values[11].is_null()); // no SubType
    CHECK(values[12] == Variant{"X7"});
}

TEST_CASE_METHOD(FilterFixture, "a field is found as soon as a type has it")
{
    CHECK(select_status(own_field("Later")) == status::Bad_NodeIdUnknown);
    const model::NodeIndex added = add_field("Later", a_type, id::Int32, -1);
    CHECK(select_status(own_field("Later")) == status::Good);
    REQUIRE(space.remove(added));
    CHECK(select_status(own_field("Later")) == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(FilterFixture, "event types are gone through again when one of them changes")
{
    CHECK(select_status(own_field("A")) == status::Good);
    const std::uint64_t rounds = fields.rounds();
    add_folder("elsewhere", objects);
    add_field("Depth", part, id::Int32, -1);
    REQUIRE(space.remove(find("elsewhere")));
    CHECK(select_status(field({own("Part"), own("Depth")})) == status::Good);
    CHECK(fields.rounds() == rounds);
    add_type("NewType", sub_type);
    add_field("New", find("NewType"), id::Int32, -1);
    CHECK(select_status(own_field("New")) == status::Good);
    CHECK(fields.rounds() == rounds + 1);
    add_field("Newer", find("NewType"), id::Int32, -1);
    CHECK(select_status(own_field("Newer")) == status::Good);
    CHECK(fields.rounds() == rounds + 2);
}

TEST_CASE_METHOD(FilterFixture, "filters have limits")
{
    CHECK(compile(EventFilter{}) == status::Bad_EventFilterInvalid);
    CHECK(compile(selecting({"Message"})) == status::Good);
    CHECK(result == EventFilterResult{});

    EventFilter selects;
    for (std::size_t i = 0; i < limits.max_select_clauses; ++i) {
        selects.select_clauses.push_back(field("Message"));
    }
    CHECK(compile(selects) == status::Good);
    CHECK(compiled.memory() > 100 * sizeof(FieldOperand));
    selects.select_clauses.push_back(field("Message"));
    CHECK(compile(selects) == status::Bad_EventFilterInvalid);

    EventFilter elements = selecting({"Message"});
    for (std::size_t i = 0; i < limits.max_elements; ++i) {
        where(elements, IsNull, {literal(Variant{})});
    }
    CHECK(compile(elements) == status::Good);
    where(elements, IsNull, {literal(Variant{})});
    CHECK(compile(elements) == status::Bad_EventFilterInvalid);
    CHECK(result == EventFilterResult{});

    EventFilter deep = selecting({"Message"});
    deep.select_clauses[0].browse_path = Array<QualifiedName>(17);
    for (QualifiedName& name : deep.select_clauses[0].browse_path) {
        name = own("A");
    }
    CHECK(compile(deep) == status::Good);
    CHECK(result.select_clause_results[0] == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(FilterFixture, "a filter owns what it keeps of its request")
{
    EventFilter filter = selecting({"Message"});
    where(filter, Like, {of("SourceName"), literal("Press%")});
    filter.select_clauses.push_back(field({own("Part"), own("Code")}));
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, filter);
    auto bytes = std::make_unique<std::vector<std::byte>>(sink.take(writer.written()));
    {
        const binary::TypeRegistry types{binary::namespace0_types()};
        binary::Reader reader{*bytes, binary::Strings::Borrow, &types};
        EventFilter decoded;
        decode(reader, decoded);
        REQUIRE(reader.ok());
        REQUIRE(compile(decoded) == status::Good);
    }
    std::fill(bytes->begin(), bytes->end(), std::byte{'x'});
    bytes.reset();
    Event event = event_of("BType");
    event.source_name = "Press 4";
    event.set({own("Part"), own("Code")}, "X7");
    const auto raised = raise(std::move(event));
    CHECK(compiled.matches(*raised, space));
    CHECK(compiled.select(*raised, space)[1] == Variant{"X7"});
}

} // namespace busbar::server::detail::event_filter_test
