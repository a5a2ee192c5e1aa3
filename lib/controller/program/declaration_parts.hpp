#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/core/api.hpp>

#include "text_places.hpp"

namespace busbar::controller::detail {

/// Declarations that are a file or a part of one.
struct DeclarationPart {
    /// The file up to the end of the part, in UTF-8.
    std::string_view text{};
    /// The offset at which the part begins.
    std::size_t begin{0};
    /// The places of the file.
    const TextPlaces* places{nullptr};
    std::string_view file{};
    /// The name of the list that its variables are in; empty: none.
    std::string_view list{};
};

/// Reads declarations from several parts as one program, in which all see each other's names. With
/// more than one file, what is left out begins with the name of its file. Everything in `parts`
/// must outlive the call only.
[[nodiscard]] BUSBAR_API Configured<Program>
read_declaration_parts(std::span<const DeclarationPart> parts, const DeclarationLimits& limits,
                       Unserved unserved);

} // namespace busbar::controller::detail
