#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

namespace busbar::client::detail {

/// A value of JSON (RFC 8259) as somebody wrote it.
struct Json {
    enum class Kind : std::uint8_t { Null, True, False, Number, String, List, Object };

    Kind kind{Kind::Null};
    /// Of a Number, as it was written, and of a String.
    std::string text;
    /// Of a List, and of an Object in its order.
    std::vector<Json> items;
    /// Of an Object: the names of the items.
    std::vector<std::string> names;

    /// The member of an Object; null if it has none of that name.
    [[nodiscard]] const Json* find(std::string_view name) const;
    /// What it is, for messages: "a list", "\"abc\"", "12".
    [[nodiscard]] std::string describe() const;
};

struct JsonLimits {
    std::size_t max_size{4U << 20U};
    std::size_t max_depth{64};
};

/// Reads all of `text`. The error says what was found where: "expected ',' or ']' at position 7".
/// Memory is a bounded multiple of the text's size.
[[nodiscard]] tl::expected<Json, std::string> parse_json(std::string_view text,
                                                         const JsonLimits& limits = {});

} // namespace busbar::client::detail
