#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string_view>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/string.hpp>

namespace busbar {

/// QualifiedName (Part 3, 8.3).
struct QualifiedName {
    String name;
    std::uint16_t namespace_index{0};

    QualifiedName() = default;
    QualifiedName(std::uint16_t index, String text) : name{std::move(text)}, namespace_index{index}
    {
    }

    [[nodiscard]] bool is_null() const { return name.empty() && namespace_index == 0; }

    friend bool operator==(const QualifiedName&, const QualifiedName&) = default;
    friend auto operator<=>(const QualifiedName&, const QualifiedName&) = default;
};

/// "2:Name"; without the index for namespace 0.
[[nodiscard]] BUSBAR_API std::string to_string(const QualifiedName& name);

/// LocalizedText (Part 3, 8.5). On the wire null and empty are the same (Part 6, 5.2.2.14).
struct LocalizedText {
    String locale;
    String text;

    LocalizedText() = default;
    explicit LocalizedText(String t) : text{std::move(t)} {}
    LocalizedText(String l, String t) : locale{std::move(l)}, text{std::move(t)} {}

    friend bool operator==(const LocalizedText&, const LocalizedText&) = default;
    friend auto operator<=>(const LocalizedText&, const LocalizedText&) = default;
};

/// Returns `text` with control characters and bytes that are not UTF-8 written as `\xHH`, and
/// characters that change the direction of text as `\u202E`; at most `max_bytes` long. For logs and
/// terminals.
[[nodiscard]] BUSBAR_API std::string printable(std::string_view text, std::size_t max_bytes = 256);

/// The specification's symbolic name ("Bad_Timeout") of `code.code()`; empty if it has none.
/// The view is of constant data.
[[nodiscard]] BUSBAR_API std::string_view name(StatusCode code);

} // namespace busbar
