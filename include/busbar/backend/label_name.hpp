#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/backend/label.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::backend {

/// Maximum number of characters of a label's name with its members, dots, indices and commas
/// (SH-082679, 8.3).
inline constexpr std::size_t max_label_name_length = 800;

/// A label by its name, as it is mapped (SH-082679, 8.3): "Stations[2].Count",
/// "Grid[1,0,4]", "Delay.N". Names are compared without case for the letters A to Z, as other names
/// of a program.
struct LabelName {
    /// A name and the element that follows it, as between two dots.
    struct Part {
        /// The name as written.
        std::string name;
        /// Empty for no element; the outermost first, at most three.
        std::vector<std::uint32_t> indices{};

        /// Compares without case.
        friend BUSBAR_API bool operator==(const Part& a, const Part& b);
    };

    /// A label and its members, one within another; never empty.
    std::vector<Part> parts;

    friend bool operator==(const LabelName&, const LabelName&) = default;
};

/// Reads a name. Each index is in decimal; "[A][B][C]" is the same as "[A,B,C]". Whether "S", "C"
/// or "N" at the end is a member or a part of a timer depends on the label's type, see
/// timer_part().
///
/// Refused with `where` "column 7", counted in characters from 1, and a text that says what was
/// found and what was expected: bits ("Label.1") and digits ("K4Label": K, 1 to 8 and a name; "K4"
/// and "K9x" are names) of labels, which cannot be mapped, more than max_label_name_length
/// characters, bytes that are not UTF-8, and control characters. check_label_characters checks
/// which other characters a product allows.
[[nodiscard]] BUSBAR_API Configured<LabelName> parse_label_name(std::string_view text);

/// Returns the canonical form: "Grid[1,0,4]". Reads as the same name again.
[[nodiscard]] BUSBAR_API std::string to_text(const LabelName& name);
/// Returns the canonical form with the letters A to Z in lower case, so that equal names have equal
/// keys.
[[nodiscard]] BUSBAR_API std::string key_of(const LabelName& name);

/// Returns the meaning of S, C or N, in either case, after the name of a timer or counter; None for
/// all other parts.
[[nodiscard]] BUSBAR_API TimerPart timer_part(const LabelName::Part& part);

/// Returns the first character that the RD81OPC96's Mapping column does not allow (manual of model
/// mode, appendix 6, note 1), as a Problem like those of parse_label_name; nothing if all are
/// allowed. "Environment dependent" characters, which that note does not list, are allowed.
[[nodiscard]] BUSBAR_API std::optional<Problem> check_label_characters(std::string_view text);

} // namespace busbar::backend
