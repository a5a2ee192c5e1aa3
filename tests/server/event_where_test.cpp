#include <catch2/catch.hpp>

#include "event_filter_fixture.hpp"

namespace busbar::server::detail::event_where_test {

using namespace busbar::test;
using enum FilterOperator;

TEST_CASE_METHOD(FilterFixture, "the example of Part 4, B.1.2",
                 "[unit:Monitor Complex Event Filter]")
{
    // ((AType.A = 5) or InList(BType.B, 3, 5, 7)) and Message like "Main%"
    EventFilter filter = selecting({"Message"});
    where(filter, And, {element(1), element(4)});
    where(filter, Or, {element(2), element(3)});
    where(filter, Equals, {of(field({own("A")}, own_id("AType"))), literal(5)});
    where(filter, InList,
          {of(field({own("B")}, own_id("BType"))), literal(3), literal(5), literal(7)});
    where(filter, Like, {of("Message"), literal("Main%")});
    const auto passes_with = [&](const char* type, const char* name, int value,
                                 const char* message) {
        Event event = event_of(type);
        event.message = LocalizedText{message};
        event.set(own(name), value);
        return passes(filter, event);
    };
    CHECK(passes_with("AType", "A", 5, "Main pump"));
    CHECK(passes_with("SubType", "A", 5, "Main pump"));
    CHECK_FALSE(passes_with("AType", "A", 6, "Main pump"));
    CHECK_FALSE(passes_with("AType", "A", 5, "The Main pump"));
    CHECK(passes_with("BType", "B", 7, "Main"));
    CHECK_FALSE(passes_with("BType", "B", 4, "Main"));
    CHECK_FALSE(passes_with("BType", "A", 5, "Main")); // no AType

    // As it stands there, with AttributeOperands, which EventFilters do not have (7.7.4.5).
    AttributeOperand operand;
    operand.node_id = own_id("AType");
    operand.browse_path.elements = {{NodeId{0, id::Aggregates}, false, true, own("A")}};
    operand.attribute_id = 13;
    EventFilter literally = selecting({"Message"});
    where(literally, Equals, {ExtensionObject::from(operand), literal(5)});
    REQUIRE(compile(literally) == status::Bad_EventFilterInvalid);
    const auto& elements = result.where_clause_result.element_results;
    REQUIRE(elements.size() == 1);
    CHECK(elements[0].operand_status_codes ==
          Array<StatusCode>{status::Bad_FilterOperandInvalid, status::Good});
}

TEST_CASE_METHOD(FilterFixture, "the example of Part 4, B.1.3, without its views")
{
    EventFilter filter = selecting({"Message"});
    where(filter, OfType, {literal(NodeId{0, id::SystemEventType})});
    Event event;
    CHECK_FALSE(passes(filter, event));
    event.event_type = NodeId{0, id::DeviceFailureEventType};
    CHECK(passes(filter, event));

    // As it stands there: (InView(Area1) or InView(Area2)) and OfType(SystemEventType).
    AttributeOperand area;
    area.node_id = own_id("Area1");
    area.attribute_id = 1;
    EventFilter views = selecting({"Message"});
    where(views, And, {element(1), element(4)});
    where(views, Or, {element(2), element(3)});
    where(views, InView, {ExtensionObject::from(area)});
    where(views, InView, {ExtensionObject::from(area)});
    where(views, OfType, {ExtensionObject::from(area)});
    REQUIRE(compile(views) == status::Bad_EventFilterInvalid);
    const auto& elements = result.where_clause_result.element_results;
    REQUIRE(elements.size() == 5);
    CHECK(elements[0].status_code == status::Good);
    CHECK(elements[0].operand_status_codes.is_null());
    CHECK(elements[2].status_code == status::Bad_FilterOperatorUnsupported);
    CHECK(elements[4].status_code == status::Bad_FilterOperandInvalid);
    REQUIRE(elements[4].operand_status_codes.size() == 1);
    CHECK(elements[4].operand_status_codes[0] == status::Bad_FilterOperandInvalid);
}

TEST_CASE_METHOD(FilterFixture, "OfType takes event types only (Part 4, 7.7.3)")
{
    for (const Variant& wrong :
         {Variant{NodeId{0, id::ObjectsFolder}}, Variant{NodeId{0, id::BaseObjectType}},
          Variant{NodeId{7, "nowhere"}}, Variant{5}, Variant{}}) {
        EventFilter filter = selecting({"Message"});
        where(filter, OfType, {literal(wrong)});
        REQUIRE(compile(filter) == status::Bad_EventFilterInvalid);
        const auto& elements = result.where_clause_result.element_results;
        REQUIRE(elements.size() == 1);
        CHECK(elements[0].status_code == status::Bad_FilterOperandInvalid);
        REQUIRE(elements[0].operand_status_codes.size() == 1);
        CHECK(elements[0].operand_status_codes[0] == status::Bad_FilterOperandInvalid);
    }
    EventFilter filter = selecting({"Message"});
    where(filter, OfType, {literal(ExpandedNodeId{NodeId{0, id::AuditEventType}})});
    CHECK(compile(filter) == status::Good);
    // What a field is, only an event tells.
    EventFilter field = selecting({"Message"});
    where(field, OfType, {of("EventType")});
    CHECK(compile(field) == status::Good);
}

TEST_CASE_METHOD(FilterFixture, "where clauses on fields", "[unit:Monitor Complex Event Filter]")
{
    EventFilter severe = selecting({"Message"});
    where(severe, GreaterThan, {of("Severity"), literal(500)});
    Event event;
    event.severity = 501;
    CHECK(passes(severe, event));
    event.severity = 500;
    CHECK_FALSE(passes(severe, event));

    // A status in place of a value is NULL, unless the field is a status.
    EventFilter unknown = selecting({"Message"});
    where(unknown, IsNull, {of(own_field("A"))});
    CHECK(passes(unknown, event_of("AType")));
    CHECK(passes(unknown, event_of("AType").set(own("A"), status::Bad_NoCommunication)));
    CHECK_FALSE(passes(unknown, event_of("AType").set(own("A"), 5)));
    EventFilter failed = selecting({"Message"});
    where(failed, Equals, {of(own_field("State")), literal(status::Bad_Timeout)});
    CHECK(passes(failed, event_of("BType").set(own("State"), status::Bad_Timeout)));

    EventFilter part_of = selecting({"Message"});
    where(part_of, Equals, {of(own_field("Values")), literal(2.0)});
    auto ranged = own_field("Values");
    ranged.index_range = "1";
    part_of.where_clause.elements[0].filter_operands[0] = of(ranged);
    CHECK(passes(part_of, event_of("SubType").set(own("Values"), Array<double>{1, 2})));
    CHECK_FALSE(passes(part_of, event_of("SubType").set(own("Values"), Array<double>{2})));

    // NULL is not TRUE, and neither is its contrary.
    EventFilter not_null = selecting({"Message"});
    where(not_null, Not, {element(1)});
    where(not_null, Equals, {of(own_field("A")), literal(5)});
    CHECK_FALSE(passes(not_null, event_of("BType")));
    CHECK(passes(not_null, event_of("AType").set(own("A"), 6)));

    // Nested values that are no Booleans.
    EventFilter masked = selecting({"Message"});
    where(masked, Equals, {element(1), literal(4)});
    where(masked, BitwiseAnd, {element(2), literal(6)});
    where(masked, Cast, {of(own_field("A")), literal(NodeId{0, id::Int64})});
    CHECK(passes(masked, event_of("AType").set(own("A"), 12)));
    CHECK_FALSE(passes(masked, event_of("AType").set(own("A"), 10)));
    EventFilter plain = selecting({"Message"});
    where(plain, BitwiseOr, {literal(1), literal(2)});
    CHECK_FALSE(passes(plain, event)); // 3 is not TRUE
}

TEST_CASE_METHOD(FilterFixture, "where clauses that are not valid say why")
{
    struct Row {
        FilterOperator id;
        std::vector<ExtensionObject> operands;
        StatusCode status;
        std::vector<StatusCode> operand_codes;
    };
    auto bad_range = own_field("Values");
    bad_range.index_range = "x";
    const ExtensionObject one = literal(1);
    const Row rows[] = {
        {FilterOperator{18}, {one, one}, status::Bad_FilterOperatorInvalid, {}},
        {FilterOperator{-1}, {one}, status::Bad_FilterOperatorInvalid, {}},
        {RelatedTo, {one, one, one, one, one, one}, status::Bad_FilterOperatorUnsupported, {}},
        {InView, {one}, status::Bad_FilterOperatorUnsupported, {}},
        {Equals, {}, status::Bad_FilterOperandCountMismatch, {}},
        {Equals, {one}, status::Bad_FilterOperandCountMismatch, {}},
        {Equals, {one, one, one}, status::Bad_FilterOperandCountMismatch, {}},
        {InList, {one}, status::Bad_FilterOperandCountMismatch, {}},
        {InList, std::vector(65, one), status::Bad_FilterOperandCountMismatch, {}},
        {Between, {one, one}, status::Bad_FilterOperandCountMismatch, {}},
        {Not, {element(0)}, status::Bad_FilterOperandInvalid, {status::Bad_FilterElementInvalid}},
        {Not, {element(2)}, status::Bad_FilterOperandInvalid, {status::Bad_FilterElementInvalid}},
        {Not,
         {element(UINT32_MAX)},
         status::Bad_FilterOperandInvalid,
         {status::Bad_FilterElementInvalid}},
        {Equals,
         {one, ExtensionObject{}},
         status::Bad_FilterOperandInvalid,
         {status::Good, status::Bad_FilterOperandInvalid}},
        {Equals,
         {ExtensionObject::from_binary(NodeId{0, 594U}, ByteString{}), one},
         status::Bad_FilterOperandInvalid,
         {status::Bad_FilterOperandInvalid, status::Good}},
        {Like,
         {of("Message"), literal(String{std::string(5'000, 'a')})},
         status::Bad_FilterOperandInvalid,
         {status::Good, status::Bad_FilterLiteralInvalid}},
        {IsNull, {of("Nothing")}, status::Bad_FilterOperandInvalid, {status::Bad_NodeIdUnknown}},
        {IsNull,
         {of(field({own("A")}, NodeId{0, id::Server}))},
         status::Bad_FilterOperandInvalid,
         {status::Bad_TypeDefinitionInvalid}},
        {IsNull,
         {of(bad_range)},
         status::Bad_FilterOperandInvalid,
         {status::Bad_IndexRangeInvalid}},
    };
    for (const Row& row : rows) {
        // In the second element, which refers back to the first or to itself.
        EventFilter filter = selecting({"Message"});
        where(filter, IsNull, {literal(1)});
        where(filter, row.id, {});
        filter.where_clause.elements[1].filter_operands = Array<ExtensionObject>(row.operands);
        INFO("operator " << static_cast<int>(row.id) << ", " << row.operands.size() << " operands");
        REQUIRE(compile(filter) == status::Bad_EventFilterInvalid);
        REQUIRE(result.select_clause_results.size() == 1);
        REQUIRE(result.where_clause_result.element_results.size() == 2);
        const auto& element_result = result.where_clause_result.element_results[1];
        CHECK(result.where_clause_result.element_results[0].status_code == status::Good);
        CHECK(element_result.status_code == row.status);
        CHECK(std::vector<StatusCode>(element_result.operand_status_codes.begin(),
                                      element_result.operand_status_codes.end()) ==
              row.operand_codes);
    }
}

TEST_CASE_METHOD(FilterFixture, "an element may not refer to itself")
{
    EventFilter filter = selecting({"Message"});
    where(filter, Not, {element(0)});
    CHECK(compile(filter) == status::Bad_EventFilterInvalid);
    where(filter, Not, {element(0)});
    filter.where_clause.elements[0].filter_operands[0] = element(1);
    CHECK(compile(filter) == status::Bad_EventFilterInvalid);
    CHECK(result.where_clause_result.element_results[0].status_code == status::Good);
    CHECK(result.where_clause_result.element_results[1].operand_status_codes[0] ==
          status::Bad_FilterElementInvalid);
}

TEST_CASE_METHOD(FilterFixture, "each element is evaluated once, however many refer to it")
{
    // Were it evaluated as a tree, this one would take 2^63 steps.
    EventFilter filter = selecting({"Message"});
    for (std::uint32_t i = 0; i + 1 < limits.max_elements; ++i) {
        where(filter, And, {element(i + 1), element(i + 1)});
    }
    where(filter, IsNull, {literal(Variant{})});
    CHECK(passes(filter, Event{}));

    // What nothing leads to is ignored, here a Like that uses up all the work there may be.
    EventFilter ignored = selecting({"Message"});
    where(ignored, Like, {literal("aaa"), literal("a%")});
    where(ignored, Like,
          {literal(String{std::string(4'000, 'a')}),
           literal(String{"%" + std::string(999, 'a') + "b"})});
    CHECK(passes(ignored, Event{}));
    // Here it is needed and evaluated first, which leaves nothing for the other.
    where(ignored, IsNull, {literal(1)});
    ignored.where_clause.elements[2] = ignored.where_clause.elements[1];
    ignored.where_clause.elements[1] = ignored.where_clause.elements[0];
    ignored.where_clause.elements[0].filter_operator = Or;
    ignored.where_clause.elements[0].filter_operands =
        Array<ExtensionObject>({element(1), element(2)});
    CHECK_FALSE(passes(ignored, Event{}));
}

} // namespace busbar::server::detail::event_where_test
