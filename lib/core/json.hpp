#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// A value of JSON (RFC 8259) as somebody wrote it.
struct BUSBAR_API Json {
    enum class Kind : std::uint8_t { Null, True, False, Number, String, List, Object };

    Kind kind{Kind::Null};
    /// Of a Number, as it was written, and of a String.
    std::string text;
    /// Of a List, and of an Object in its order.
    std::vector<Json> items;
    /// Of an Object: the names of the items, each of them once.
    std::vector<std::string> names;

    /// The member of an Object; null if it has none of that name.
    [[nodiscard]] const Json* find(std::string_view name) const;
    /// What it is, for messages: "a list", "\"abc\"", "12".
    [[nodiscard]] std::string describe() const;
};

/// What is read at most; a text past that is refused like one that is no JSON.
struct JsonLimits {
    std::size_t max_size{4U << 20U}; // bytes of the text
    std::size_t max_depth{64};       // Lists and Objects in each other
    std::size_t max_members{1'000};  // of one Object
    std::size_t max_values{~std::size_t{0}};
    /// False: NUL in a String is refused as well, which a reader of C strings would end at.
    bool allows_nul{true};
};

/// Reads all of `text`. The error says what was found where: "expected ',' or ']' at position 7".
/// Memory is a bounded multiple of the text's size, at most 100 bytes for each value and those of
/// its texts.
///
/// Refused besides what is not JSON: a member that is there twice (RFC 8259, 4 leaves open what it
/// means) and a half of a surrogate pair. A Number may be any that JSON can write: its range is for
/// the type to say.
[[nodiscard]] BUSBAR_API Expected<Json, std::string> parse_json(std::string_view text,
                                                                const JsonLimits& limits = {});

} // namespace busbar::detail
