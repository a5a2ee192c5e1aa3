#include <catch2/catch.hpp>

#include <initializer_list>
#include <limits>

#include <busbar/types/ids.hpp>

#include "server/event/filter_conversion.hpp"
#include "server/event/filter_operators.hpp"

namespace busbar::server::detail::event_operators_test {

namespace {

constexpr std::uint16_t u16(int value)
{
    return static_cast<std::uint16_t>(value);
}
constexpr std::uint8_t u8(int value)
{
    return static_cast<std::uint8_t>(value);
}
constexpr std::int8_t i8(int value)
{
    return static_cast<std::int8_t>(value);
}
constexpr std::int16_t i16(int value)
{
    return static_cast<std::int16_t>(value);
}

const Variant null;

/// What an operator makes of literal operands, for an event of DeviceFailureEventType.
Variant evaluate(FilterOperator id, std::initializer_list<Variant> operands)
{
    static const model::AddressSpace space;
    const FilterOperatorRule* const rule = find_operator(id);
    REQUIRE(rule != nullptr);
    REQUIRE(rule->evaluate != nullptr);
    REQUIRE(operands.size() >= rule->min_operands);
    REQUIRE(operands.size() <= rule->max_operands);
    std::vector<const Variant*> pointers;
    for (const Variant& operand : operands) {
        pointers.push_back(&operand);
    }
    FilterContext context{space, space.find(id::DeviceFailureEventType), 10'000};
    return rule->evaluate(context, pointers);
}

struct OperatorRow {
    FilterOperator id;
    std::vector<Variant> operands;
    Variant result;
};

void check(const std::vector<OperatorRow>& rows)
{
    static const model::AddressSpace space;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const OperatorRow& row = rows[i];
        INFO("operator " << static_cast<int>(row.id) << ", row " << i);
        std::vector<const Variant*> pointers;
        for (const Variant& operand : row.operands) {
            pointers.push_back(&operand);
        }
        FilterContext context{space, space.find(id::DeviceFailureEventType), 10'000};
        const Variant result = find_operator(row.id)->evaluate(context, pointers);
        CHECK(result.type() == row.result.type());
        CHECK(result == row.result);
    }
}

} // namespace

using enum FilterOperator;

TEST_CASE("filter operators compare by the common type")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    check({
        {Equals, {5, 5}, true},
        {Equals, {5, 6}, false},
        {Equals, {5, 5.0}, true},
        {Equals, {u8(5), std::int64_t{5}}, true},
        {Equals, {"5", 5}, true},
        {Equals, {"five", 5}, false},
        {Equals, {"TRUE", true}, true},
        {Equals, {"Abc", "abc"}, false},
        {Equals, {String{}, String{""}}, true},
        {Equals, {ByteString{}, ByteString{std::span<const std::byte>{}}}, true},
        {Equals, {Array<int>{}, Array<int>(0)}, true},
        {Equals, {Array<int>{1, 2}, Array<int>{1, 2}}, true},
        {Equals, {Array<int>{1, 2}, Array<double>{1, 2}}, true},
        {Equals, {Array<int>{5}, 5}, true},
        {Equals, {Array<int>{5, 5}, 5}, false},
        {Equals, {nan, nan}, false},
        {Equals, {NodeId{0, 5U}, "i=5"}, true},
        {Equals, {NodeId{0, 5U}, ExpandedNodeId{NodeId{0, 5U}}}, true},
        {Equals, {LocalizedText{"en", "a"}, "a"}, true},
        {Equals, {QualifiedName{2, "a"}, LocalizedText{"a"}}, true},
        {Equals, {Guid{}, 5}, false},
        {Equals, {DateTime{5}, "x"}, false},
        {Equals, {status::Bad_Timeout, status::Bad_Timeout.value()}, true},
        {Equals, {u16(0x800A), status::Bad_Timeout}, true},
        {Equals, {null, 5}, null},
        {Equals, {null, null}, null},
        // UInt64 becomes Int64, where this number does not fit.
        {Equals, {std::numeric_limits<std::uint64_t>::max(), std::int64_t{-1}}, false},
        {GreaterThan, {6, 5.5}, true},
        {GreaterThan, {5, 5}, false},
        {GreaterThan, {"b", "a"}, false},
        {GreaterThan, {"10", 9}, true},
        {GreaterThan, {DateTime{2}, DateTime{1}}, true},
        {GreaterThan, {true, false}, false},
        {GreaterThan, {nan, 1.0}, false},
        {GreaterThan, {null, 1}, null},
        {LessThan, {i16(-1), std::uint32_t{0}}, false},
        {LessThan, {i16(-1), 0}, true},
        {LessThan, {Array<int>{1}, 2}, true},
        {LessThan, {Array<int>{1, 1}, 2}, false},
        {GreaterThanOrEqual, {5, 5}, true},
        {GreaterThanOrEqual, {4, 5}, false},
        {LessThanOrEqual, {5, 5}, true},
        {LessThanOrEqual, {u8(6), 5}, false},
        {LessThanOrEqual, {NodeId{0, 1U}, NodeId{0, 2U}}, false},
    });
}

TEST_CASE("filter operators on ranges, lists and nulls")
{
    check({
        {Between, {5, 1, 10}, true},
        {Between, {5, 5, 5}, true},
        {Between, {5, 5.5, 10}, false},
        {Between, {"5", 1, 10}, true},
        {Between, {"5", "1", "9"}, false},
        {Between, {5, null, 10}, null},
        {InList, {5, 3, 5, 7}, true},
        {InList, {4, 3, 5, 7}, false},
        {InList, {4, 3, null}, null},
        {InList, {4, null, 4}, true},
        {InList, {"b", "a", "b"}, true},
        {IsNull, {null}, true},
        {IsNull, {String{}}, true},
        {IsNull, {""}, false},
        {IsNull, {NodeId{}}, true},
        {IsNull, {ExpandedNodeId{}}, true},
        {IsNull, {QualifiedName{}}, true},
        {IsNull, {LocalizedText{}}, true},
        {IsNull, {ExtensionObject{}}, true},
        {IsNull, {ByteString{}}, true},
        {IsNull, {DateTime{}}, true},
        {IsNull, {Guid{}}, true},
        {IsNull, {Array<int>{}}, true},
        {IsNull, {Array<int>(0)}, false},
        {IsNull, {0}, false},
        {IsNull, {false}, false},
    });
}

TEST_CASE("And, Or and Not have three truth values")
{
    const Variant values[] = {true, false, null};
    // Rows and columns in the order of `values` (Part 4, 7.7.3).
    const Variant both[3][3] = {{true, false, null}, {false, false, false}, {null, false, null}};
    const Variant either[3][3] = {{true, true, true}, {true, false, null}, {true, null, null}};
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
            CHECK(evaluate(And, {values[a], values[b]}) == both[a][b]);
            CHECK(evaluate(Or, {values[a], values[b]}) == either[a][b]);
        }
    }
    CHECK(evaluate(Not, {true}) == Variant{false});
    CHECK(evaluate(Not, {false}) == Variant{true});
    CHECK(evaluate(Not, {null}).is_null());
    // A String becomes a Boolean by itself, a number does not and is NULL.
    CHECK(evaluate(Not, {"true"}) == Variant{false});
    CHECK(evaluate(Not, {1}).is_null());
    CHECK(evaluate(And, {"x", false}) == Variant{false});
    CHECK(evaluate(Or, {Array<bool>{true}, null}) == Variant{true});
}

TEST_CASE("bitwise operators have the size of the larger operand")
{
    check({
        {BitwiseAnd, {0x0F, 0x3C}, 0x0C},
        {BitwiseOr, {0x0F, 0x30}, 0x3F},
        {BitwiseAnd, {u8(0xFF), u16(0x1234)}, u16(0x34)},
        {BitwiseOr, {u8(0x80), i16(1)}, i16(0x81)},
        {BitwiseOr, {i8(1), u8(0x80)}, u8(0x81)},
        {BitwiseAnd, {i8(-1), std::uint32_t{0xABCD1234}}, std::uint32_t{0xABCD1234}},
        {BitwiseAnd, {std::int64_t{-1}, 5}, std::int64_t{5}},
        {BitwiseOr, {std::uint64_t{1} << 63U, u8(1)}, (std::uint64_t{1} << 63U) + 1},
        {BitwiseAnd, {5, 1.0}, null},
        {BitwiseAnd, {5, null}, null},
        {BitwiseAnd, {true, 1}, null},
    });
}

TEST_CASE("Cast converts to the built-in type of a DataType")
{
    const auto type = [](std::uint32_t id) { return NodeId{0, id}; };
    check({
        {Cast, {5.5, type(id::Int32)}, 6},
        {Cast, {-5.5, type(id::Int32)}, -6},
        {Cast, {300, type(id::Byte)}, null},
        {Cast, {-1, type(id::UInt32)}, null},
        {Cast, {1e300, type(id::Float)}, null},
        {Cast, {1e300, type(id::Int64)}, null},
        {Cast, {9223372036854775808.0, type(id::Int64)}, null},
        {Cast, {9223372036854775808.0, type(id::UInt64)}, std::uint64_t{1} << 63U},
        {Cast, {std::numeric_limits<double>::quiet_NaN(), type(id::Int32)}, null},
        {Cast, {7, type(id::Boolean)}, true},
        {Cast, {0.0, type(id::Boolean)}, false},
        {Cast, {true, type(id::String)}, "true"},
        {Cast, {true, type(id::Double)}, 1.0},
        {Cast, {1.5F, type(id::String)}, "1.5"},
        {Cast, {0.1F, type(id::String)}, "0.1"},
        {Cast, {i8(-7), type(id::String)}, "-7"},
        {Cast, {"12", type(id::Duration)}, 12.0},
        {Cast, {" 12", type(id::Int32)}, null},
        {Cast, {"+12", type(id::Int32)}, 12},
        {Cast, {"+-12", type(id::Int32)}, null},
        {Cast, {"12a", type(id::Int32)}, null},
        {Cast, {"", type(id::Int32)}, null},
        {Cast, {"a", type(id::QualifiedName)}, QualifiedName{0, "a"}},
        {Cast, {"a", type(id::LocalizedText)}, LocalizedText{"a"}},
        {Cast, {"ns=1;s=x", type(id::NodeId)}, NodeId{1, "x"}},
        {Cast,
         {"svr=1;nsu=urn:x;i=5", type(id::ExpandedNodeId)},
         ExpandedNodeId{NodeId{0, 5U}, "urn:x", 1}},
        {Cast, {"svr=1", type(id::ExpandedNodeId)}, null},
        {Cast, {"nsu=urn:x;ns=3;i=5", type(id::ExpandedNodeId)}, null},
        {Cast, {ExpandedNodeId{NodeId{1, "x"}}, type(id::NodeId)}, NodeId{1, "x"}},
        {Cast, {ExpandedNodeId{NodeId{0, 5U}, "urn:x"}, type(id::NodeId)}, null},
        {Cast,
         {"72962B91-FA75-4AE6-8D28-B404DC7DAF63", type(id::Guid)},
         *Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63")},
        {Cast,
         {"1970-01-01T00:00:01.5Z", type(id::UtcTime)},
         DateTime{DateTime::unix_epoch + 15'000'000}},
        {Cast, {"1970-01-01T01:00:01+01:00", type(id::DateTime)}, DateTime::from_unix_seconds(1)},
        {Cast, {"1970-02-30T00:00:00Z", type(id::DateTime)}, null},
        {Cast, {"1970-01-01T00:00:00+1:00", type(id::DateTime)}, null},
        {Cast, {DateTime::from_unix_seconds(0), type(id::String)}, "1970-01-01T00:00:00Z"},
        {Cast, {status::Bad_Timeout, type(id::UInt16)}, u16(0x800A)},
        {Cast, {5, type(id::StatusCode)}, StatusCode{5}},
        {Cast, {std::int64_t{-5}, type(id::StatusCode)}, null},
        {Cast, {5, type(id::NodeClass)}, 5},
        {Cast, {Array<double>{1.4, 1.6}, type(id::Int32)}, Array<int>{1, 2}},
        {Cast, {Array<double>{1.4, 1e10}, type(id::Int32)}, null},
        {Cast, {Array<double>{1.6}, type(id::Int32)}, 2},
        {Cast, {5, type(id::Guid)}, null},
        {Cast, {5, type(id::Number)}, null},
        {Cast, {5, type(id::Server)}, null},
        {Cast, {5, "i=6"}, null},
        {Cast, {5, ExpandedNodeId{type(id::Double)}}, 5.0},
        {Cast, {null, type(id::Double)}, null},
    });
    const Guid guid = *Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63");
    const Variant bytes = convert_explicitly(guid, BuiltInType::ByteString);
    CHECK(bytes.get_if<ByteString>()->size() == 16);
    CHECK(convert_explicitly(bytes, BuiltInType::Guid) == Variant{guid});
    const Variant matrix = Variant::matrix(Array<int>{1, 2, 3, 4}, Array<std::uint32_t>{2, 2});
    CHECK(convert_implicitly(matrix, BuiltInType::Double) ==
          Variant::matrix(Array<double>{1, 2, 3, 4}, Array<std::uint32_t>{2, 2}));
}

TEST_CASE("OfType knows subtypes")
{
    const auto is_of = [](Variant type) { return evaluate(OfType, {std::move(type)}); };
    CHECK(is_of(NodeId{0, id::DeviceFailureEventType}) == Variant{true});
    CHECK(is_of(NodeId{0, id::SystemEventType}) == Variant{true});
    CHECK(is_of(ExpandedNodeId{NodeId{0, id::BaseEventType}}) == Variant{true});
    CHECK(is_of(NodeId{0, id::AuditEventType}) == Variant{false});
    CHECK(is_of(NodeId{0, id::Server}) == Variant{false});
    CHECK(is_of(NodeId{7, "nowhere"}) == Variant{false});
    CHECK(is_of("i=2041") == Variant{false});
    CHECK(is_of(null) == Variant{false});
}

TEST_CASE("Like takes what becomes a String by itself")
{
    check({
        {Like, {LocalizedText{"en", "Main"}, "M%"}, true},
        {Like, {QualifiedName{3, "Main"}, "M%"}, true},
        {Like, {NodeId{0, 85U}, "i=8_"}, true},
        {Like, {5, "5"}, false}, // a number becomes a String by Cast only
        {Like, {"5", 5}, false},
        {Like, {null, "%"}, null},
        {Like, {Array<String>{"a"}, "a"}, true},
        {Like, {Array<String>{"a", "a"}, "%"}, false},
    });
}

TEST_CASE("every built-in type has its conversions")
{
    // The table of Part 4, 7.7.3 in part: from, to, rule.
    struct Row {
        BuiltInType from;
        BuiltInType to;
        Conversion rule;
    };
    using enum BuiltInType;
    const Row rows[] = {
        {Boolean, Double, Conversion::Implicit},
        {Boolean, BuiltInType::String, Conversion::Explicit},
        {BuiltInType::String, Boolean, Conversion::Implicit},
        {Double, Float, Conversion::Explicit},
        {Float, Double, Conversion::Implicit},
        {UInt64, Int64, Conversion::Implicit},
        {Int64, UInt64, Conversion::Explicit},
        {Int16, UInt16, Conversion::Explicit},
        {UInt16, BuiltInType::StatusCode, Conversion::Implicit},
        {Int16, BuiltInType::StatusCode, Conversion::None},
        {BuiltInType::StatusCode, Double, Conversion::None},
        {XmlElement, BuiltInType::String, Conversion::None},
        {Boolean, Boolean, Conversion::Same},
        {Null, Boolean, Conversion::None},
        {Null, Null, Conversion::None},
        {ExtensionObject, BuiltInType::String, Conversion::None},
    };
    for (const Row& row : rows) {
        CHECK(conversion(row.from, row.to) == row.rule);
    }
    // Where two types can meet, they meet in one, whichever comes first.
    for (std::uint8_t a = 0; a <= last_built_in_type; ++a) {
        for (std::uint8_t b = 0; b <= last_built_in_type; ++b) {
            const BuiltInType common = common_type(BuiltInType{a}, BuiltInType{b});
            CHECK(common == common_type(BuiltInType{b}, BuiltInType{a}));
            CHECK((common == Null || common == BuiltInType{a} || common == BuiltInType{b}));
        }
    }
    CHECK(common_type(Int64, UInt64) == Int64);
    CHECK(common_type(Int32, UInt64) == UInt64);
    CHECK(common_type(Byte, SByte) == SByte);
    CHECK(common_type(BuiltInType::String, Int32) == Int32);
    CHECK(common_type(DateTime, BuiltInType::String) == Null);
}

TEST_CASE("operators that events do not have")
{
    CHECK(find_operator(InView)->evaluate == nullptr);
    CHECK(find_operator(RelatedTo)->evaluate == nullptr);
    CHECK(find_operator(FilterOperator{18}) == nullptr);
    CHECK(find_operator(FilterOperator{-1}) == nullptr);
    for (int i = 0; i < 18; ++i) {
        CHECK(find_operator(FilterOperator{i})->id == FilterOperator{i});
    }
}

} // namespace busbar::server::detail::event_operators_test
