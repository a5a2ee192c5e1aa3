#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// Appends a field, in quotation marks if necessary (RFC 4180, 2.6).
void add_field(std::string& to, std::string_view field);

/// Reads comma-separated values (RFC 4180) line by line; line breaks may be CRLF, LF or CR.
class BUSBAR_API TableFields {
public:
    enum class Line { Read, End, Broken, TooLarge };

    /// Uses commas, or the separator that the first line has.
    TableFields(std::string_view text, std::size_t max_field);

    /// Reads the next line into fields, at most 64.
    [[nodiscard]] Line next(std::vector<std::string>& fields);
    /// Number of the line where the last record of next() begins.
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

/// The columns in the order in which they are written.
enum class TableColumn : std::size_t { NodeId, Path, Part, Label, Rank, Dim1, Dim2, Dim3 };
inline constexpr std::array<std::string_view, 8> table_columns{
    "NodeId", "Path", "Part", "Label", "Rank", "Dim1", "Dim2", "Dim3",
};

/// Beginnings of the names of a Method's parts.
inline constexpr std::string_view handle_part = "Handle";
inline constexpr std::string_view done_part = "Done";
inline constexpr std::string_view input_part = "Input";
inline constexpr std::string_view output_part = "Output";
/// Parts of a Variable in addition to those of its value. Scaling has a text instead of a label.
inline constexpr std::string_view quality_part = "Quality";
inline constexpr std::string_view scaling_part = "Scaling";
/// The RolePermissions of any node, as roles_text() writes them.
inline constexpr std::string_view roles_part = "Roles";

} // namespace busbar::controller::detail
