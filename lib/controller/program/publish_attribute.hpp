#pragma once

#include <optional>
#include <string_view>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// The publish attribute in a pragma.
struct PublishPragma {
    /// False for a pragma about something else, which is ignored.
    bool is_publish{false};
    /// Empty if the attribute is not a known one.
    std::optional<NetworkPublish> publish{};
};

/// Parses the text of a pragma without braces, as declaration_lexer.hpp provides it.
[[nodiscard]] PublishPragma read_publish_pragma(std::string_view text);

/// Parses "publish only", with blanks, hyphens, underscores or nothing between words, regardless of
/// case.
[[nodiscard]] BUSBAR_API std::optional<NetworkPublish> publish_of(std::string_view words);

} // namespace busbar::controller::detail
