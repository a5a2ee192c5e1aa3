#include "filter_operators.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <busbar/types/ids.hpp>

#include "filter_conversion.hpp"

namespace busbar::server::detail {

namespace {

using Truth = std::optional<bool>;

Variant result(Truth truth)
{
    return truth ? Variant{*truth} : Variant{};
}

/// An operand that cannot become a Boolean is NULL.
Truth truth_of(const Variant& operand)
{
    Variant storage;
    const Variant converted = convert_implicitly(as_scalar(operand, storage), BuiltInType::Boolean);
    const bool* const value = converted.get_if<bool>();
    return value == nullptr ? Truth{} : Truth{*value};
}

bool has_null(FilterOperands operands)
{
    return std::any_of(operands.begin(), operands.end(),
                       [](const Variant* operand) { return operand->is_null(); });
}

Variant equals(FilterContext&, FilterOperands operands)
{
    return result(are_equal(*operands[0], *operands[1]));
}

Variant is_null(FilterContext&, FilterOperands operands)
{
    return is_null_value(*operands[0]);
}

template <typename Predicate>
Variant compare(FilterOperands operands, Predicate fits)
{
    return has_null(operands) ? Variant{} : Variant{fits(order(*operands[0], *operands[1]))};
}

Variant greater_than(FilterContext&, FilterOperands operands)
{
    return compare(operands, [](std::partial_ordering order) { return std::is_gt(order); });
}

Variant less_than(FilterContext&, FilterOperands operands)
{
    return compare(operands, [](std::partial_ordering order) { return std::is_lt(order); });
}

Variant greater_than_or_equal(FilterContext&, FilterOperands operands)
{
    return compare(operands, [](std::partial_ordering order) { return std::is_gteq(order); });
}

Variant less_than_or_equal(FilterContext&, FilterOperands operands)
{
    return compare(operands, [](std::partial_ordering order) { return std::is_lteq(order); });
}

Variant like(FilterContext& context, FilterOperands operands)
{
    if (has_null(operands)) {
        return {};
    }
    Variant storage[2];
    const Variant text =
        convert_implicitly(as_scalar(*operands[0], storage[0]), BuiltInType::String);
    const Variant pattern =
        convert_implicitly(as_scalar(*operands[1], storage[1]), BuiltInType::String);
    const String* const texts[] = {text.get_if<String>(), pattern.get_if<String>()};
    if (texts[0] == nullptr || texts[1] == nullptr) {
        return false;
    }
    return result(is_like(texts[0]->view(), texts[1]->view(), context.steps_left));
}

Variant logical_not(FilterContext&, FilterOperands operands)
{
    const Truth truth = truth_of(*operands[0]);
    return truth ? Variant{!*truth} : Variant{};
}

Variant between(FilterContext&, FilterOperands operands)
{
    return has_null(operands) ? Variant{}
                              : Variant{is_between(*operands[0], *operands[1], *operands[2])};
}

/// Works like a chain of Or: NULL if nothing is equal but something might be.
Variant in_list(FilterContext&, FilterOperands operands)
{
    bool is_unknown = false;
    for (const Variant* const listed : operands.subspan(1)) {
        const Truth is_equal = are_equal(*operands[0], *listed);
        if (is_equal == true) {
            return true;
        }
        is_unknown = is_unknown || !is_equal;
    }
    return is_unknown ? Variant{} : Variant{false};
}

/// Part 4, 7.7.3, Logical AND truth table.
Variant logical_and(FilterContext&, FilterOperands operands)
{
    const Truth a = truth_of(*operands[0]);
    const Truth b = truth_of(*operands[1]);
    if (a == false || b == false) {
        return false;
    }
    return a && b ? Variant{true} : Variant{};
}

/// Part 4, 7.7.3, Logical OR truth table.
Variant logical_or(FilterContext&, FilterOperands operands)
{
    const Truth a = truth_of(*operands[0]);
    const Truth b = truth_of(*operands[1]);
    if (a == true || b == true) {
        return true;
    }
    return a && b ? Variant{false} : Variant{};
}

/// Returns the node of this server that the operand names; no_node if there is none.
model::NodeIndex node_of(const model::AddressSpace& space, const Variant& operand)
{
    if (const auto* const id = operand.get_if<NodeId>()) {
        return space.find(*id);
    }
    const auto* const id = operand.get_if<ExpandedNodeId>();
    return id != nullptr && id->is_local() ? space.find(id->node_id) : model::no_node;
}

/// Any error in the conversion or in the parameters yields NULL.
Variant cast(FilterContext& context, FilterOperands operands)
{
    const model::NodeIndex type = node_of(context.space, *operands[1]);
    if (type == model::no_node || context.space.node_class(type) != NodeClass::DataType) {
        return {};
    }
    Variant storage;
    const BuiltInType built_in = context.space.built_in_type_of(type);
    return convert_explicitly(as_scalar(*operands[0], storage), built_in);
}

/// True if the event is of the type or of a subtype; false if the operand is not a type.
Variant of_type(FilterContext& context, FilterOperands operands)
{
    return context.space.is_subtype_of(context.event_type, node_of(context.space, *operands[0]));
}

/// An integer with its size; other values have size 0.
struct Integer {
    std::uint64_t bits{0};
    unsigned size{0};
    bool is_signed{false};
};

template <typename T>
bool read_integer(const Variant& value, Integer& integer)
{
    const T* const number = value.get_if<T>();
    if (number != nullptr) {
        integer = {static_cast<std::uint64_t>(*number), sizeof(T), std::is_signed_v<T>};
    }
    return number != nullptr;
}

Integer integer_of(const Variant& operand)
{
    Variant storage;
    const Variant& value = as_scalar(operand, storage);
    Integer integer;
    static_cast<void>(
        read_integer<std::int8_t>(value, integer) || read_integer<std::uint8_t>(value, integer) ||
        read_integer<std::int16_t>(value, integer) || read_integer<std::uint16_t>(value, integer) ||
        read_integer<std::int32_t>(value, integer) || read_integer<std::uint32_t>(value, integer) ||
        read_integer<std::int64_t>(value, integer) || read_integer<std::uint64_t>(value, integer));
    return integer;
}

template <typename Signed>
Variant sized(std::uint64_t bits, bool is_signed)
{
    using Unsigned = std::make_unsigned_t<Signed>;
    return is_signed ? Variant{static_cast<Signed>(bits)} : Variant{static_cast<Unsigned>(bits)};
}

/// The result has the size of the larger operand; signed only if both of this size are.
template <typename ServiceOperation>
Variant bitwise(FilterOperands operands, ServiceOperation operation)
{
    const Integer a = integer_of(*operands[0]);
    const Integer b = integer_of(*operands[1]);
    if (a.size == 0 || b.size == 0) {
        return {};
    }
    const bool is_signed = (a.is_signed || a.size < b.size) && (b.is_signed || b.size < a.size);
    const std::uint64_t bits = operation(a.bits, b.bits);
    switch (std::max(a.size, b.size)) {
    case 1:
        return sized<std::int8_t>(bits, is_signed);
    case 2:
        return sized<std::int16_t>(bits, is_signed);
    case 4:
        return sized<std::int32_t>(bits, is_signed);
    default:
        return sized<std::int64_t>(bits, is_signed);
    }
}

Variant bitwise_and(FilterContext&, FilterOperands operands)
{
    return bitwise(operands, [](std::uint64_t a, std::uint64_t b) { return a & b; });
}

Variant bitwise_or(FilterContext&, FilterOperands operands)
{
    return bitwise(operands, [](std::uint64_t a, std::uint64_t b) { return a | b; });
}

/// In the order of their numbers. InView and RelatedTo concern target Nodes and their relations,
/// which events, unlike the results of a Query, do not have.
constexpr std::array operator_rules{
    FilterOperatorRule{FilterOperator::Equals, 2, 2, equals},
    FilterOperatorRule{FilterOperator::IsNull, 1, 1, is_null},
    FilterOperatorRule{FilterOperator::GreaterThan, 2, 2, greater_than},
    FilterOperatorRule{FilterOperator::LessThan, 2, 2, less_than},
    FilterOperatorRule{FilterOperator::GreaterThanOrEqual, 2, 2, greater_than_or_equal},
    FilterOperatorRule{FilterOperator::LessThanOrEqual, 2, 2, less_than_or_equal},
    FilterOperatorRule{FilterOperator::Like, 2, 2, like},
    FilterOperatorRule{FilterOperator::Not, 1, 1, logical_not},
    FilterOperatorRule{FilterOperator::Between, 3, 3, between},
    FilterOperatorRule{FilterOperator::InList, 2, UINT8_MAX, in_list},
    FilterOperatorRule{FilterOperator::And, 2, 2, logical_and},
    FilterOperatorRule{FilterOperator::Or, 2, 2, logical_or},
    FilterOperatorRule{FilterOperator::Cast, 2, 2, cast},
    FilterOperatorRule{FilterOperator::InView, 1, 1, nullptr},
    FilterOperatorRule{FilterOperator::OfType, 1, 1, of_type},
    FilterOperatorRule{FilterOperator::RelatedTo, 6, 6, nullptr},
    FilterOperatorRule{FilterOperator::BitwiseAnd, 2, 2, bitwise_and},
    FilterOperatorRule{FilterOperator::BitwiseOr, 2, 2, bitwise_or},
};

} // namespace

bool is_event_type(const model::AddressSpace& space, const Variant& operand)
{
    const model::NodeIndex type = node_of(space, operand);
    return type != model::no_node && space.node_class(type) == NodeClass::ObjectType &&
           space.is_subtype_of(type, id::BaseEventType);
}

const FilterOperatorRule* find_operator(FilterOperator id)
{
    const auto number = static_cast<std::uint32_t>(id);
    return number < operator_rules.size() ? &operator_rules[number] : nullptr;
}

} // namespace busbar::server::detail
