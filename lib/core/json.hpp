#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// A value of JSON (RFC 8259) as written.
struct BUSBAR_API Json {
    enum class Kind : std::uint8_t { Null, True, False, Number, String, List, Object };

    Kind kind{Kind::Null};
    /// The text of a Number, as written, and of a String.
    std::string text;
    /// The items of a List, and of an Object in its order.
    std::vector<Json> items;
    /// The names of an Object's items, each of them once.
    std::vector<std::string> names;

    /// Returns the member of an Object; null if it has none of this name.
    [[nodiscard]] const Json* find(std::string_view name) const;
    /// Describes the value for messages: "a list", "\"abc\"", "12".
    [[nodiscard]] std::string describe() const;
};

/// Limits of what is read; a text that exceeds them is refused like one that is not JSON.
struct JsonLimits {
    std::size_t max_size{4U << 20U}; // bytes of the text
    std::size_t max_depth{64};       // Lists and Objects within each other
    std::size_t max_members{1'000};  // in one Object
    std::size_t max_values{~std::size_t{0}};
    /// If false, NUL in a String is refused as well, since a reader of C strings would end there.
    bool allows_nul{true};
};

/// Reads all of `text`. The error says what was found where: "expected ',' or ']' at position 7".
/// Memory is a bounded multiple of the text's size, at most 100 bytes for each value plus those of
/// its texts.
///
/// Also refuses a member that appears twice (RFC 8259, 4 leaves open what it means) and half of a
/// surrogate pair. A Number may be any that JSON can write: the caller checks its range.
[[nodiscard]] BUSBAR_API Expected<Json, std::string> parse_json(std::string_view text,
                                                                const JsonLimits& limits = {});

} // namespace busbar::detail
