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

/// Characters of a label's name with its members, periods, indices and commas (seed 001, 8.3).
inline constexpr std::size_t max_label_name_length = 800;

/// A label by its name, as it is mapped (seed 001, 8.3): "Stations[2].Count", "Grid[1,0,4]",
/// "Delay.N". Names are told apart without case: of the letters A to Z, as those of a program's
/// other names are.
struct LabelName {
    struct Part {
        /// As it was written.
        std::string name;
        /// None: no element; the outermost first, at most three.
        std::vector<std::uint32_t> indices{};

        /// Without case.
        friend BUSBAR_API bool operator==(const Part& a, const Part& b);
    };

    /// A label and its members, one within another; never empty.
    std::vector<Part> parts;

    friend bool operator==(const LabelName&, const LabelName&) = default;
};

/// Reads a name. Each index is in decimal; "[A][B][C]" is the same as "[A,B,C]". Whether "S", "C"
/// or "N" at the end is a member or a part of a timer is up to what the label is, see timer_part().
///
/// Refused with `where` "column 7", counted in characters from 1, and a text of what was found and
/// what was expected: bits ("Label.1") and digits ("K4Label": K, 1 to 8 and a name; "K4" and "K9x"
/// are names) of labels, which cannot be mapped, more than max_label_name_length characters, what
/// is no UTF-8, and control characters. What other characters a product allows:
/// check_label_characters.
[[nodiscard]] BUSBAR_API Configured<LabelName> parse_label_name(std::string_view text);

/// In the one way to write it: "Grid[1,0,4]". Reads as the same name again.
[[nodiscard]] BUSBAR_API std::string to_text(const LabelName& name);
/// The same with the letters A to Z small, so that equal names have equal keys.
[[nodiscard]] BUSBAR_API std::string key_of(const LabelName& name);

/// What S, C or N, in either case, stands for behind the name of a timer or counter; None for all
/// other parts.
[[nodiscard]] BUSBAR_API TimerPart timer_part(const LabelName::Part& part);

/// The first character that the RD81OPC96's Mapping column does not take (seed 001, appendix 6,
/// note 1), as a Problem like those of parse_label_name; none if all are taken. "Environment
/// dependent" characters, which that note does not name, are taken.
[[nodiscard]] BUSBAR_API std::optional<Problem> check_label_characters(std::string_view text);

} // namespace busbar::backend
