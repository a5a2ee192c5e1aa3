#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// Writes JSON (RFC 8259) and sets the commas. The caller opens and closes lists and objects, and
/// gives each value in an object its name first.
class BUSBAR_API JsonWriter {
public:
    void begin_object() { open('{'); }
    void end_object() { text_ += '}'; }
    void begin_list() { open('['); }
    void end_list() { text_ += ']'; }
    /// Writes the name of the next value.
    void name(std::string_view name);
    /// Writes a text in quotes, safe to print on a terminal: bytes that are not UTF-8 become
    /// U+FFFD, control characters are escaped.
    void string(std::string_view text);
    /// Writes a number, true, false or null unchanged.
    void word(std::string_view word);

    [[nodiscard]] const std::string& document() const { return text_; }
    [[nodiscard]] std::string take() { return std::move(text_); }

private:
    void open(char bracket);
    void separate();

    std::string text_;
};

} // namespace busbar::detail
