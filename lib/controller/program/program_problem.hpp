#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller::detail {

/// Quotes a name of any length and content for a message.
[[nodiscard]] std::string quoted_name(const std::string& name);

/// Names an element of a list: "variables[7] (Speed)".
[[nodiscard]] std::string place_in(std::string_view list, std::size_t index,
                                   const std::string& name);

/// Makes a problem with line and column if the place is known, after the name of the file if the
/// program has several.
[[nodiscard]] Problem problem_at(const Program& program, std::string where,
                                 const ProgramPlace& place, std::string text);

/// Puts the name of its file before the place of what is left out, if the program has several.
void add_file(LeftOut& one, const std::vector<std::string>& files);

/// Makes the note about a declaration that is left out because of a problem at this place, without
/// the name of the file. A Part has no name.
[[nodiscard]] BUSBAR_API LeftOut left_out(LeftOut::Kind kind, std::string name,
                                          NetworkPublish publish, const ProgramPlace& place,
                                          const std::string& text);

/// Finds lines and columns of offsets in constant time. Scans the text once and notes places on the
/// way.
class BUSBAR_API TextPlaces {
public:
    /// `text` must outlive this object. Places are in this file of the program; see
    /// ProgramPlace::file.
    explicit TextPlaces(std::string_view text, std::uint32_t file = 0);

    /// Returns the place of the byte at `offset`, or of the end. Columns count code points.
    [[nodiscard]] ProgramPlace at(std::size_t offset) const;

private:
    static constexpr std::size_t step = 1'024;

    std::string_view text_;
    std::uint32_t file_;
    /// Places of the bytes at 0, step, 2 * step and so on.
    std::vector<ProgramPlace> noted_{};
};

/// Finds the first byte of `text` that is not UTF-8.
[[nodiscard]] std::optional<std::size_t> first_not_utf8(std::string_view text);

} // namespace busbar::controller::detail
