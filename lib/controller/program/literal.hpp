#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/expected.hpp>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

struct Literal {
    Variant value{};
    InitialValue::Notation notation{InitialValue::Notation::Number};
};

/// A value, or what is wrong: "found '16#FG', expected a number of base 16".
using LiteralResult = Expected<Literal, std::string>;

/// "found 'text', expected `what`"; of a text of any length, its beginning.
[[nodiscard]] BUSBAR_API std::string found_expected(std::string_view text, std::string_view what);

/// A number without its sign, as the lexer cuts it: Int64, UInt64 if it is larger, or Double.
[[nodiscard]] LiteralResult read_number_literal(std::string_view text, bool is_negative);

/// A text with its quotes, as String.
[[nodiscard]] LiteralResult read_text_literal(std::string_view text);

/// Reads "INT#5", "T#5s" or "STRING#'a'"; nothing if the name before the `#` is not a type that is
/// known here: it may be an enumeration.
[[nodiscard]] BUSBAR_API std::optional<LiteralResult> read_typed_literal(std::string_view text);

} // namespace busbar::controller::detail
