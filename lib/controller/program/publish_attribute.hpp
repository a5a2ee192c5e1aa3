#pragma once

#include <optional>
#include <string_view>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// What a pragma says of publishing.
struct PublishPragma {
    /// It is one about publishing; if not, it means nothing here.
    bool is_publish{false};
    /// Nothing if it says something that is not known.
    std::optional<NetworkPublish> publish{};
};

/// The pragma's text without braces, as declaration_reader.hpp has it.
[[nodiscard]] PublishPragma read_publish_pragma(std::string_view text);

/// "publish only", with blanks, hyphens, underscores or nothing between words, in whatever case.
[[nodiscard]] BUSBAR_API std::optional<NetworkPublish> publish_of(std::string_view words);

} // namespace busbar::controller::detail
