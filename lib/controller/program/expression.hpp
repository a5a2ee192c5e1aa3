#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/program.hpp>
#include <busbar/core/expected.hpp>

#include "declaration_cursor.hpp"

namespace busbar::controller::detail {

/// The value of an expression, or of a part of it.
struct ExpressionValue {
    enum class State : std::uint8_t {
        Known,
        /// It depends on a name or a size that is not known before the whole text is read.
        Later,
        /// A name that is neither a constant nor a value of an enumeration.
        Missing,
        /// A name that several enumerations have.
        Ambiguous,
    };

    /// The value as InitialValue has it: an Int64, a UInt64 if it is larger, a Double, a Boolean, a
    /// DateTime or a String; for a value of an enumeration its number.
    Variant value{};
    InitialValue::Notation notation{InitialValue::Notation::Number};
    State state{State::Known};
    /// The type of a typed literal, of a conversion or of a constant.
    std::optional<ElementaryType> type{};
    /// For a single name that is not a constant: the name and the one before it, as written.
    std::string enumeration{};
    std::string name{};
    /// The offset in the text at which it begins.
    std::size_t offset{0};

    [[nodiscard]] bool is_later() const { return state == State::Later; }
};

/// A value, or what is wrong with its operands.
using ExpressionResult = Expected<ExpressionValue, std::string>;
[[nodiscard]] inline Unexpected<std::string> wrong(std::string text)
{
    return Unexpected<std::string>{std::move(text)};
}

/// The binary operators of IEC 61131-3, 3rd edition, table 71.
enum class Operator : std::uint8_t {
    Or,
    Xor,
    And,
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
};

/// Reads an expression up to the first token that does not continue it:
///
/// - literals, constants and values of enumerations (`N`, `Gvl.N`, `Color.Red`, `Color#Red`) that
///   the cursor's ConstantTable knows, parentheses;
/// - `-`, `+`, `NOT`, and the operators of IEC 61131-3, 3rd edition, table 71, by its precedence;
/// - SHL, SHR, ROL, ROR, ABS, MIN, MAX, LIMIT, SEL, EXPT, SQRT, TRUNC, LEN, CONCAT, SIZEOF, and
///   conversions such as INT_TO_REAL and TO_REAL.
///
/// Integers are computed exactly, within 64 bits with or without a sign, reals as LREAL; a type
/// limits conversions, and gives NOT and shifts their width. Overflow, division by zero and other
/// operands that have no result are problems at their operator. The steps, the depth and the size
/// of texts are limited by ExpressionLimits, in sum over all expressions of a program.
///
/// Gives false after reporting a problem at the cursor. A single name that is not known is no
/// problem yet; require_value() reports it.
[[nodiscard]] bool read_expression(DeclarationCursor& cursor, ExpressionValue& value);

/// Reports that the value has no state Known or Later.
[[nodiscard]] bool require_value(DeclarationCursor& cursor, const ExpressionValue& value);

/// True if the word is a function that read_expression() knows.
[[nodiscard]] bool is_function(std::string_view word);

// expression_operators.cpp: both operands are known.
[[nodiscard]] ExpressionResult apply_operator(Operator what, const ExpressionValue& a,
                                              const ExpressionValue& b);
[[nodiscard]] ExpressionResult apply_minus(const ExpressionValue& value);
[[nodiscard]] ExpressionResult apply_not(const ExpressionValue& value);

// expression_functions.cpp: all arguments are known.
[[nodiscard]] ExpressionResult apply_function(std::string_view word,
                                              const std::vector<ExpressionValue>& arguments,
                                              std::size_t max_text);
/// Converts to a type as a conversion of IEC 61131-3 does, with a problem where it loses more than
/// digits after the point.
[[nodiscard]] ExpressionResult convert_value(const ExpressionValue& value, ElementaryType type);

/// An integer of 64 bits with or without a sign.
struct Whole {
    bool is_negative{false};
    std::uint64_t size{0};
};

// whole_number.cpp: nothing if the result does not fit; divisors are not zero.
[[nodiscard]] std::optional<Whole> whole_of(const Variant& value);
[[nodiscard]] Variant variant_of(const Whole& number);
[[nodiscard]] std::optional<Whole> add(const Whole& a, const Whole& b);
[[nodiscard]] std::optional<Whole> subtract(const Whole& a, const Whole& b);
[[nodiscard]] std::optional<Whole> multiply(const Whole& a, const Whole& b);
[[nodiscard]] std::optional<Whole> divide(const Whole& a, const Whole& b);
[[nodiscard]] Whole modulo(const Whole& a, const Whole& b);
[[nodiscard]] std::optional<Whole> power(const Whole& base, std::uint64_t exponent);
[[nodiscard]] bool is_less(const Whole& a, const Whole& b);
[[nodiscard]] bool is_equal(const Whole& a, const Whole& b);
[[nodiscard]] double real_of(const Whole& number);
/// The number as bits of two's complement, and back.
[[nodiscard]] std::uint64_t bits_of(const Whole& number);
[[nodiscard]] Whole from_bits(std::uint64_t bits, bool is_signed);

/// Returns the bits that an integer or a bit string has; 1 for BOOL, 0 for other types.
[[nodiscard]] unsigned width_of(ElementaryType type);

} // namespace busbar::controller::detail
