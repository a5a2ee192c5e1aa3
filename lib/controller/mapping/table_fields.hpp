#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::controller::detail {

/// Adds a field, in quotation marks where it must be (RFC 4180, 2.6).
void add_field(std::string& to, std::string_view field);

/// Reads comma-separated values (RFC 4180) line by line; line breaks may be CRLF, LF or CR.
class TableFields {
public:
    enum class Line { Read, End, Broken, TooLarge };

    /// Commas, or what parts the fields of the first line.
    TableFields(std::string_view text, std::size_t max_field);

    /// The next line with its fields, of which there may be 64.
    [[nodiscard]] Line next(std::vector<std::string>& fields);
    /// The number of the line that next() read, where it begins.
    [[nodiscard]] std::size_t line() const { return line_; }

private:
    [[nodiscard]] Line read_field(std::string& field);
    [[nodiscard]] Line read_quoted(std::string& field);
    [[nodiscard]] bool is_at_end() const { return at_ == text_.size(); }
    [[nodiscard]] bool is_at_break() const
    {
        return is_at_end() || text_[at_] == '\n' || text_[at_] == '\r';
    }
    void pass_break();

    std::string_view text_;
    std::size_t max_field_;
    char separator_{','};
    std::size_t at_{0};
    std::size_t line_{0};
    std::size_t next_line_{1};
};

} // namespace busbar::controller::detail
