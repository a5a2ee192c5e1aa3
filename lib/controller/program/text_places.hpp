#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

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
