#include <cmath>

#include "expression.hpp"

namespace busbar::controller::detail {

namespace {

using Notation = InitialValue::Notation;

/// Numbers as both operands have them: integers, or reals if one is real.
struct Operands {
    std::optional<Whole> a;
    std::optional<Whole> b;
    double real_a{0};
    double real_b{0};

    [[nodiscard]] bool are_whole() const { return a && b; }
};

std::optional<double> number_of(const ExpressionValue& value, const std::optional<Whole>& whole)
{
    if (value.notation != Notation::Number) {
        return {};
    }
    const auto* real = value.value.get_if<double>();
    return whole             ? std::optional{real_of(*whole)}
           : real != nullptr ? std::optional{*real}
                             : std::nullopt;
}

std::optional<Operands> operands_of(const ExpressionValue& a, const ExpressionValue& b)
{
    Operands both{whole_of(a.value), whole_of(b.value)};
    const auto real_a = number_of(a, both.a);
    const auto real_b = number_of(b, both.b);
    if (!real_a || !real_b) {
        return {};
    }
    both.real_a = *real_a;
    both.real_b = *real_b;
    return both;
}

/// The type of a result: that of the operand that has one; of two, the one with more bits.
std::optional<ElementaryType> common_type(const ExpressionValue& a, const ExpressionValue& b)
{
    if (!a.type || !b.type) {
        return a.type ? a.type : b.type;
    }
    return width_of(*a.type) >= width_of(*b.type) ? a.type : b.type;
}

ExpressionValue value_with(Variant value, std::optional<ElementaryType> type = {},
                           Notation notation = Notation::Number)
{
    ExpressionValue result;
    result.value = std::move(value);
    result.type = type;
    result.notation = notation;
    return result;
}

ExpressionResult whole_result(const std::optional<Whole>& result,
                              std::optional<ElementaryType> type = {})
{
    return result ? ExpressionResult{value_with(variant_of(*result), type)}
                  : wrong("overflows 64 bits");
}

ExpressionResult real_result(double result, std::optional<ElementaryType> type = {})
{
    return std::isfinite(result) ? ExpressionResult{value_with(Variant{result}, type)}
                                 : wrong("has a result that an LREAL cannot be");
}

std::optional<ElementaryType> real_type(std::optional<ElementaryType> type)
{
    const bool is_real = type && (*type == ElementaryType::Real || *type == ElementaryType::Lreal);
    return is_real ? type : std::nullopt;
}

ExpressionResult whole_power(const Whole& base, const Whole& exponent,
                             std::optional<ElementaryType> type)
{
    if (!exponent.is_negative) {
        return whole_result(power(base, exponent.size), type);
    }
    return base.size == 0 ? ExpressionResult{wrong("divides by zero")}
                          : real_result(std::pow(real_of(base), real_of(exponent)));
}

ExpressionResult compute_whole(Operator what, const Whole& a, const Whole& b,
                               std::optional<ElementaryType> type)
{
    const bool divides = what == Operator::Divide || what == Operator::Modulo;
    if (divides && b.size == 0) {
        return wrong("divides by zero");
    }
    switch (what) {
    case Operator::Add:
        return whole_result(add(a, b), type);
    case Operator::Subtract:
        return whole_result(subtract(a, b), type);
    case Operator::Multiply:
        return whole_result(multiply(a, b), type);
    case Operator::Divide:
        return whole_result(divide(a, b), type);
    case Operator::Modulo:
        return whole_result(modulo(a, b), type);
    default:
        return whole_power(a, b, type);
    }
}

ExpressionResult compute_real(Operator what, double a, double b, std::optional<ElementaryType> type)
{
    switch (what) {
    case Operator::Add:
        return real_result(a + b, type);
    case Operator::Subtract:
        return real_result(a - b, type);
    case Operator::Multiply:
        return real_result(a * b, type);
    case Operator::Divide:
        return b == 0 ? ExpressionResult{wrong("divides by zero")} : real_result(a / b, type);
    case Operator::Power:
        return real_result(std::pow(a, b), type);
    default:
        return wrong("needs whole numbers");
    }
}

ExpressionResult duration_result(double milliseconds)
{
    return std::isfinite(milliseconds)
               ? ExpressionResult{value_with(Variant{milliseconds}, {}, Notation::Duration)}
               : wrong("has a result that a TIME cannot be");
}

/// A date or a time of day and a duration.
ExpressionResult shift_date(Operator what, const ExpressionValue& date, double milliseconds)
{
    constexpr double ticks_per_millisecond = 10'000;
    constexpr auto latest = static_cast<double>(DateTime::latest);
    const auto ticks = static_cast<double>(date.value.value_or(DateTime{}).ticks);
    const double shift = milliseconds * ticks_per_millisecond;
    const double result = what == Operator::Add ? ticks + shift : ticks - shift;
    if (!(result >= 0 && result < latest)) {
        return wrong("has a result that is not between 1601 and 9999");
    }
    // Exact, unlike the sum of doubles.
    const auto exact = static_cast<std::int64_t>(what == Operator::Add ? shift : -shift);
    return value_with(Variant{DateTime{date.value.value_or(DateTime{}).ticks + exact}}, date.type,
                      date.notation);
}

std::optional<double> duration_of(const ExpressionValue& value)
{
    const auto* milliseconds = value.value.get_if<double>();
    return value.notation == Notation::Duration && milliseconds != nullptr
               ? std::optional{*milliseconds}
               : std::nullopt;
}

ExpressionResult compute_times(Operator what, const ExpressionValue& a, const ExpressionValue& b)
{
    const auto time_a = duration_of(a);
    const auto time_b = duration_of(b);
    const auto number_a = number_of(a, whole_of(a.value));
    const auto number_b = number_of(b, whole_of(b.value));
    const bool is_sum = what == Operator::Add || what == Operator::Subtract;
    if (time_a && time_b && is_sum) {
        return duration_result(what == Operator::Add ? *time_a + *time_b : *time_a - *time_b);
    }
    if (what == Operator::Multiply && ((time_a && number_b) || (number_a && time_b))) {
        return duration_result(time_a ? *time_a * *number_b : *number_a * *time_b);
    }
    if (what == Operator::Divide && time_a && number_b) {
        return *number_b == 0 ? ExpressionResult{wrong("divides by zero")}
                              : duration_result(*time_a / *number_b);
    }
    if (is_sum && time_b && a.value.get_if<DateTime>() != nullptr) {
        return shift_date(what, a, *time_b);
    }
    return wrong("needs two numbers, or a duration and a number");
}

ExpressionResult compute(Operator what, const ExpressionValue& a, const ExpressionValue& b)
{
    const auto both = operands_of(a, b);
    if (!both) {
        return compute_times(what, a, b);
    }
    const auto type = common_type(a, b);
    if (both->are_whole()) {
        return compute_whole(what, *both->a, *both->b, real_type(type) ? std::nullopt : type);
    }
    return compute_real(what, both->real_a, both->real_b, real_type(type));
}

/// -1, 0 or 1; nothing if the values cannot be compared.
std::optional<int> compare(const ExpressionValue& a, const ExpressionValue& b)
{
    const auto order = [](const auto& x, const auto& y) { return x < y ? -1 : y < x ? 1 : 0; };
    if (const auto both = operands_of(a, b)) {
        if (both->are_whole()) {
            return is_less(*both->a, *both->b) ? -1 : is_equal(*both->a, *both->b) ? 0 : 1;
        }
        return order(both->real_a, both->real_b);
    }
    if (a.notation != b.notation) {
        return {};
    }
    const auto same = [&](auto kind) -> std::optional<int> {
        const auto* x = a.value.get_if<decltype(kind)>();
        const auto* y = b.value.get_if<decltype(kind)>();
        return x != nullptr && y != nullptr ? std::optional{order(*x, *y)} : std::nullopt;
    };
    if (const auto* x = a.value.get_if<String>()) {
        const auto* y = b.value.get_if<String>();
        return y == nullptr ? std::nullopt : std::optional{order(x->view(), y->view())};
    }
    if (const auto result = same(DateTime{})) {
        return result;
    }
    return a.value.get_if<bool>() != nullptr ? same(bool{}) : same(double{});
}

ExpressionResult apply_comparison(Operator what, const ExpressionValue& a, const ExpressionValue& b)
{
    const auto order = compare(a, b);
    if (!order) {
        return wrong("compares values of different kinds");
    }
    switch (what) {
    case Operator::Equal:
        return value_with(Variant{*order == 0});
    case Operator::NotEqual:
        return value_with(Variant{*order != 0});
    case Operator::Less:
        return value_with(Variant{*order < 0});
    case Operator::LessOrEqual:
        return value_with(Variant{*order <= 0});
    case Operator::Greater:
        return value_with(Variant{*order > 0});
    default:
        return value_with(Variant{*order >= 0});
    }
}

template <typename T>
T apply_bits(Operator what, T a, T b)
{
    return static_cast<T>(what == Operator::Or ? a | b : what == Operator::And ? a & b : a ^ b);
}

ExpressionResult apply_logic(Operator what, const ExpressionValue& a, const ExpressionValue& b)
{
    const auto* x = a.value.get_if<bool>();
    const auto* y = b.value.get_if<bool>();
    if (x != nullptr && y != nullptr) {
        const unsigned result = apply_bits(what, *x ? 1U : 0U, *y ? 1U : 0U);
        return value_with(Variant{result != 0}, ElementaryType::Bool);
    }
    const auto both = operands_of(a, b);
    if (!both || !both->are_whole()) {
        return wrong("needs two values of BOOL or two whole numbers");
    }
    const std::uint64_t bits = apply_bits(what, bits_of(*both->a), bits_of(*both->b));
    const bool is_signed = both->a->is_negative || both->b->is_negative;
    return value_with(variant_of(from_bits(bits, is_signed)), common_type(a, b));
}

bool is_signed_type(ElementaryType type)
{
    return type >= ElementaryType::Sint && type <= ElementaryType::Lint;
}

} // namespace

ExpressionResult apply_operator(Operator what, const ExpressionValue& a, const ExpressionValue& b)
{
    if (what <= Operator::And) {
        return apply_logic(what, a, b);
    }
    return what <= Operator::GreaterOrEqual ? apply_comparison(what, a, b) : compute(what, a, b);
}

ExpressionResult apply_minus(const ExpressionValue& value)
{
    if (const auto* real = value.value.get_if<double>()) {
        return value_with(Variant{-*real}, value.type, value.notation);
    }
    const auto number = whole_of(value.value);
    if (!number) {
        return wrong("needs a number");
    }
    return whole_result(subtract({}, *number), value.type);
}

ExpressionResult apply_not(const ExpressionValue& value)
{
    if (const auto* truth = value.value.get_if<bool>()) {
        return value_with(Variant{!*truth}, ElementaryType::Bool);
    }
    const auto number = whole_of(value.value);
    const unsigned width = value.type ? width_of(*value.type) : 0;
    if (!number || width == 0) {
        return wrong("needs a value of BOOL or of a type, as WORD#16#FF");
    }
    const std::uint64_t mask = ~std::uint64_t{0} >> (64U - width);
    const bool is_signed = is_signed_type(*value.type);
    const std::uint64_t bits = is_signed ? ~bits_of(*number) : ~bits_of(*number) & mask;
    return value_with(variant_of(from_bits(bits, is_signed)), value.type);
}

} // namespace busbar::controller::detail
