#pragma once

#include <string>

#include "value.hpp"

namespace CLI {
class App;
}

namespace busbar::tool {

/// The form of values for scripts that do not read JSON.
struct RowFormat {
    bool is_value{false};
    bool is_csv{false};
    /// "%n %v %t"; empty for none.
    std::string pattern{};

    /// False: for people, or in JSON.
    [[nodiscard]] bool is_set() const { return is_value || is_csv || !pattern.empty(); }
};
/// --value, --csv and --format, of which one may be given.
void add_format_options(CLI::App& command, RowFormat& format);

/// One value, as it was read or as it changed.
struct ValueRecord {
    std::string node;
    const DataValue* value;
    NodeId data_type{};
    std::string unit{};
};

/// Writes values in a RowFormat, each on a line of its own.
class RowWriter {
public:
    RowWriter(Output& out, RowFormat format) : out_{&out}, format_{std::move(format)} {}

    /// CSV begins with a line of titles.
    void write(const ValueRecord& record, const Types& types);

private:
    Output* out_;
    RowFormat format_;
    bool has_begun_{false};
};

/// The text in a field of CSV (RFC 4180).
[[nodiscard]] std::string csv_field(const std::string& text);
/// A check for CLI11: returns what is wrong with the pattern; empty if nothing is.
[[nodiscard]] std::string check_pattern(const std::string& pattern);
/// The record by the pattern, without the end of the line.
[[nodiscard]] std::string formatted(const std::string& pattern, const ValueRecord& record,
                                    const Types& types);

} // namespace busbar::tool
