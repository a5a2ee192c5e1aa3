#include <array>
#include <cmath>

#include <busbar/controller/program_types.hpp>

#include "core/ascii_case.hpp"
#include "declaration_keywords.hpp"
#include "expression.hpp"

namespace busbar::controller::detail {

namespace {

using Notation = InitialValue::Notation;
using Arguments = std::vector<ExpressionValue>;

ExpressionValue number_value(Variant value, std::optional<ElementaryType> type)
{
    ExpressionValue result;
    result.value = std::move(value);
    result.type = type;
    return result;
}

std::optional<double> real_number(const ExpressionValue& value)
{
    if (const auto whole = whole_of(value.value)) {
        return real_of(*whole);
    }
    const auto* real = value.value.get_if<double>();
    return real != nullptr && value.notation == Notation::Number ? std::optional{*real}
                                                                 : std::nullopt;
}

/// Writes a truth or the number of a value of an enumeration as a number.
ExpressionValue as_number(ExpressionValue value)
{
    if (const auto* truth = value.value.get_if<bool>()) {
        value.value = Variant{std::int64_t{*truth ? 1 : 0}};
    }
    return value;
}

ExpressionResult whole_of_real(double real, ElementaryType type)
{
    constexpr double end = 18'446'744'073'709'551'616.0; // 2^64
    // To the nearest, of two the even one (IEC 61131-3, 3rd edition, table 22).
    const double rounded = std::nearbyint(real);
    if (!(std::fabs(rounded) < end)) {
        return wrong("has a value that " + std::string{name(type)} + " cannot be");
    }
    const Whole whole{rounded < 0, static_cast<std::uint64_t>(std::fabs(rounded))};
    if (whole.is_negative && whole.size > std::uint64_t{1} << 63U) {
        return wrong("has a value that " + std::string{name(type)} + " cannot be");
    }
    return number_value(variant_of(whole), type);
}

/// Integers of one size share their bits: INT_TO_WORD(-1) is 16#FFFF.
Whole with_bits_of(const Whole& number, ElementaryType type)
{
    const unsigned width = width_of(type);
    const std::uint64_t sign = std::uint64_t{1} << (width - 1);
    if (is_bit_string(type) && number.is_negative && number.size <= sign) {
        return {false, bits_of(number) & (~std::uint64_t{0} >> (64U - width))};
    }
    return number;
}

ExpressionResult to_whole(const ExpressionValue& value, ElementaryType type)
{
    const auto* real = value.value.get_if<double>();
    ExpressionResult result = value;
    if (real != nullptr) {
        result = whole_of_real(*real, type);
    } else if (const auto number = whole_of(value.value)) {
        result = number_value(variant_of(with_bits_of(*number, type)), type);
    } else {
        return wrong("cannot become " + std::string{name(type)});
    }
    if (result && !number_fits(type, result->value)) {
        return wrong("has a value that " + std::string{name(type)} + " cannot be");
    }
    return result;
}

ExpressionResult to_bool(const ExpressionValue& value)
{
    const auto number = real_number(value);
    return number ? ExpressionResult{number_value(Variant{*number != 0}, ElementaryType::Bool)}
                  : wrong("cannot become BOOL");
}

ExpressionResult to_real(const ExpressionValue& value, ElementaryType type)
{
    const auto* real = value.value.get_if<double>();
    const auto number = real != nullptr ? std::optional{*real} : real_number(value);
    if (!number || !number_fits(type, Variant{*number})) {
        return wrong(number ? "has a value that " + std::string{name(type)} + " cannot be"
                            : "cannot become " + std::string{name(type)});
    }
    return number_value(Variant{*number}, type);
}

ExpressionResult to_duration(const ExpressionValue& value)
{
    const auto* real = value.value.get_if<double>();
    const auto number = real != nullptr ? std::optional{*real} : real_number(value);
    if (!number) {
        return wrong("cannot become TIME");
    }
    ExpressionValue result = number_value(Variant{*number}, ElementaryType::Time);
    result.notation = Notation::Duration;
    return result;
}

/// The operands of a shift: bits, their width, and a count.
struct Shift {
    std::uint64_t bits{0};
    unsigned width{64};
    std::uint64_t count{0};
    ElementaryType type{};
};

std::optional<Shift> shift_of(const Arguments& arguments)
{
    const auto number = whole_of(arguments[0].value);
    const auto count = whole_of(arguments[1].value);
    if (!number || !count || count->is_negative || number->is_negative) {
        return {};
    }
    const ElementaryType type = arguments[0].type.value_or(ElementaryType::Lword);
    const unsigned width = width_of(type);
    return width < 2 ? std::nullopt
                     : std::optional{Shift{bits_of(*number), width, count->size, type}};
}

ExpressionResult shift_left(const Shift& shift, bool is_typed)
{
    const std::uint64_t mask = ~std::uint64_t{0} >> (64U - shift.width);
    const std::uint64_t bits = shift.count < shift.width ? shift.bits << shift.count & mask : 0;
    const bool is_lost = shift.bits != 0 && (bits == 0 || bits >> shift.count != shift.bits);
    if (!is_typed && is_lost) {
        return wrong("overflows 64 bits");
    }
    return number_value(variant_of({false, bits}), shift.type);
}

ExpressionResult apply_shift(std::string_view word, const Arguments& arguments, std::size_t)
{
    using busbar::detail::is_same_ignoring_case;
    const auto shift = shift_of(arguments);
    if (!shift) {
        return wrong("needs a number of bits and a count, neither below zero");
    }
    const std::uint64_t mask = ~std::uint64_t{0} >> (64U - shift->width);
    ExpressionResult result = ExpressionValue{};
    if (is_same_ignoring_case(word, "SHL")) {
        result = shift_left(*shift, arguments[0].type.has_value());
    } else if (is_same_ignoring_case(word, "SHR")) {
        const std::uint64_t bits = shift->count < shift->width ? shift->bits >> shift->count : 0;
        result = number_value(variant_of({false, bits}), shift->type);
    } else {
        if (!arguments[0].type) {
            return wrong("needs a value of a type, as WORD#16#FF");
        }
        const auto count = static_cast<unsigned>(shift->count % shift->width);
        const unsigned left =
            is_same_ignoring_case(word, "ROL") ? count : (shift->width - count) % shift->width;
        const std::uint64_t bits =
            left == 0 ? shift->bits : shift->bits << left | shift->bits >> (shift->width - left);
        result = number_value(variant_of({false, bits & mask}), shift->type);
    }
    if (result) {
        result->type = arguments[0].type;
        if (result->type && !number_fits(*result->type, result->value)) {
            return wrong("has a value that " + std::string{name(*result->type)} + " cannot be");
        }
    }
    return result;
}

ExpressionResult apply_abs(std::string_view, const Arguments& arguments, std::size_t)
{
    const ExpressionValue& value = arguments[0];
    const auto number = real_number(value);
    if (!number) {
        return wrong("needs a number");
    }
    return *number < 0 ? apply_minus(value) : ExpressionResult{value};
}

/// True if `a` comes before `b`.
Expected<bool, std::string> is_before(const ExpressionValue& a, const ExpressionValue& b)
{
    return apply_operator(Operator::Less, a, b).transform([](const ExpressionValue& value) {
        return value.value.value_or(false);
    });
}

ExpressionResult apply_extreme(std::string_view word, const Arguments& arguments, std::size_t)
{
    const bool is_max = busbar::detail::is_same_ignoring_case(word, "MAX");
    const ExpressionValue* best = &arguments[0];
    for (const ExpressionValue& each : arguments) {
        const auto before = is_max ? is_before(*best, each) : is_before(each, *best);
        if (!before) {
            return wrong(before.error());
        }
        best = *before ? &each : best;
    }
    return *best;
}

ExpressionResult apply_limit(std::string_view, const Arguments& arguments, std::size_t most)
{
    return apply_extreme("MIN", {arguments[1], arguments[2]}, most)
        .and_then([&](const ExpressionValue& value) {
            return apply_extreme("MAX", {arguments[0], value}, most);
        });
}

ExpressionResult apply_sel(std::string_view, const Arguments& arguments, std::size_t)
{
    return to_bool(as_number(arguments[0])).transform([&](const ExpressionValue& choice) {
        return choice.value.value_or(false) ? arguments[2] : arguments[1];
    });
}

ExpressionResult apply_expt(std::string_view, const Arguments& arguments, std::size_t)
{
    return apply_operator(Operator::Power, arguments[0], arguments[1]);
}

ExpressionResult apply_sqrt(std::string_view, const Arguments& arguments, std::size_t)
{
    const auto number = real_number(arguments[0]);
    return number && *number >= 0
               ? ExpressionResult{number_value(Variant{std::sqrt(*number)}, ElementaryType::Lreal)}
               : wrong("needs a number from 0 on");
}

ExpressionResult apply_trunc(std::string_view, const Arguments& arguments, std::size_t)
{
    const auto number = real_number(arguments[0]);
    return number ? whole_of_real(std::trunc(*number), ElementaryType::Lint)
                  : ExpressionResult{wrong("needs a number")};
}

ExpressionResult apply_len(std::string_view, const Arguments& arguments, std::size_t)
{
    const auto* text = arguments[0].value.get_if<String>();
    return text != nullptr ? ExpressionResult{number_value(
                                 Variant{static_cast<std::int64_t>(text->size())}, {})}
                           : wrong("needs a text");
}

ExpressionResult apply_concat(std::string_view, const Arguments& arguments, std::size_t most)
{
    std::string all;
    for (const ExpressionValue& each : arguments) {
        const auto* text = each.value.get_if<String>();
        if (text == nullptr) {
            return wrong("needs texts");
        }
        if (text->size() > most - all.size()) {
            return wrong("has a text of more than " + std::to_string(most) + " bytes");
        }
        all += text->view();
    }
    ExpressionValue result = number_value(Variant{String{all}}, {});
    result.notation = Notation::Text;
    return result;
}

struct Function {
    std::string_view word;
    std::size_t fewest;
    std::size_t most;
    ExpressionResult (*apply)(std::string_view word, const Arguments& arguments, std::size_t most);
};

constexpr std::size_t many = 16;
constexpr std::array functions{
    Function{"ABS", 1, 1, apply_abs},        Function{"CONCAT", 2, many, apply_concat},
    Function{"EXPT", 2, 2, apply_expt},      Function{"LEN", 1, 1, apply_len},
    Function{"LIMIT", 3, 3, apply_limit},    Function{"MAX", 2, many, apply_extreme},
    Function{"MIN", 2, many, apply_extreme}, Function{"ROL", 2, 2, apply_shift},
    Function{"ROR", 2, 2, apply_shift},      Function{"SEL", 3, 3, apply_sel},
    Function{"SHL", 2, 2, apply_shift},      Function{"SHR", 2, 2, apply_shift},
    Function{"SQRT", 1, 1, apply_sqrt},      Function{"TRUNC", 1, 1, apply_trunc},
};

const Function* function_of(std::string_view word)
{
    for (const Function& each : functions) {
        if (busbar::detail::is_same_ignoring_case(each.word, word)) {
            return &each;
        }
    }
    return nullptr;
}

/// The type after the "TO_" of INT_TO_REAL, TO_REAL or ANY_TO_REAL.
std::optional<ElementaryType> conversion_of(std::string_view word)
{
    constexpr std::string_view mark = "_TO_";
    if (busbar::detail::is_same_ignoring_case(word.substr(0, 3), "TO_")) {
        return elementary_type(word.substr(3));
    }
    for (std::size_t i = 0; i + mark.size() < word.size(); ++i) {
        const std::string_view from = word.substr(0, i);
        if (busbar::detail::is_same_ignoring_case(word.substr(i, mark.size()), mark) &&
            (elementary_type(from) || busbar::detail::is_same_ignoring_case(from, "ANY"))) {
            return elementary_type(word.substr(i + mark.size()));
        }
    }
    return {};
}

} // namespace

bool is_function(std::string_view word)
{
    constexpr std::size_t longest = 32;
    return word.size() <= longest && (function_of(word) != nullptr || conversion_of(word) ||
                                      busbar::detail::is_same_ignoring_case(word, "SIZEOF"));
}

ExpressionResult convert_value(const ExpressionValue& given, ElementaryType type)
{
    const ExpressionValue value = as_number(given);
    if (type == ElementaryType::Bool) {
        return to_bool(value);
    }
    if (type <= ElementaryType::Lword) {
        return to_whole(value, type);
    }
    if (type == ElementaryType::Real || type == ElementaryType::Lreal) {
        return to_real(value, type);
    }
    if (type == ElementaryType::Time) {
        return to_duration(value);
    }
    return wrong("cannot become " + std::string{name(type)} + " here");
}

ExpressionResult apply_function(std::string_view word, const Arguments& arguments,
                                std::size_t max_text)
{
    if (const auto type = conversion_of(word)) {
        return arguments.size() == 1 ? convert_value(arguments[0], *type)
                                     : ExpressionResult{wrong("needs one argument")};
    }
    const Function& function = *function_of(word);
    if (arguments.size() < function.fewest || arguments.size() > function.most) {
        return wrong("has " + std::to_string(arguments.size()) + " arguments, expected " +
                     std::to_string(function.fewest) +
                     (function.most > function.fewest ? " or more" : ""));
    }
    return function.apply(word, arguments, max_text);
}

} // namespace busbar::controller::detail
