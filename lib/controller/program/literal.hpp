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

/// "INT#5", "T#5s", "STRING#'a'"; nothing if what stands before the `#` is no type known here, so
/// perhaps an enumeration.
[[nodiscard]] BUSBAR_API std::optional<LiteralResult> read_typed_literal(std::string_view text);

/// What stands behind the `#` of T#, D#, TOD# and DT#. Times are milliseconds.
[[nodiscard]] std::optional<double> read_duration(std::string_view text);
[[nodiscard]] std::optional<DateTime> read_date(std::string_view text);
[[nodiscard]] std::optional<DateTime> read_time_of_day(std::string_view text);
[[nodiscard]] std::optional<DateTime> read_date_and_time(std::string_view text);

/// The digits, without the underscores that may stand between two of them; nothing if one stands
/// elsewhere.
[[nodiscard]] std::optional<std::string> without_underscores(std::string_view text);

} // namespace busbar::controller::detail
