#include "row_format.hpp"

#include <CLI/CLI.hpp>

#include "display_text.hpp"

namespace busbar::tool {

namespace {

constexpr std::string_view letters = "nvjstTdu%";

std::string time_text(DateTime time)
{
    return time.is_null() ? std::string{} : to_string(time);
}

std::string json_text(const DataValue& value, const Types& types)
{
    JsonLine json;
    append_json(json, value.value, types);
    return json.document();
}

std::string part_of(char letter, const ValueRecord& record, const Types& types)
{
    const DataValue& value = *record.value;
    switch (letter) {
    case 'n':
        return safe(record.node);
    case 'v':
        return raw_text_of(value, types, record.data_type);
    case 'j':
        return json_text(value, types);
    case 's':
        return text_of(value.status);
    case 't':
        return time_text(value.source_timestamp);
    case 'T':
        return time_text(value.server_timestamp);
    case 'd':
        return std::string{name(value.value.type())};
    case 'u':
        return record.unit;
    default:
        return "%";
    }
}

} // namespace

void add_format_options(CLI::App& command, RowFormat& format)
{
    auto* value = command.add_flag("--value", format.is_value,
                                   "nothing but the values, one per line, as `write` takes them");
    auto* csv = command.add_flag("--csv", format.is_csv,
                                 "comma-separated: node, value, unit, status, time");
    auto* pattern =
        command
            .add_option("--format", format.pattern,
                        "lines by a pattern: %n node, %v value, %j value in JSON, %u unit, "
                        "%s status, %t source time, %T server time, %d type")
            ->check(check_pattern)
            ->type_name("PATTERN");
    csv->excludes(value);
    pattern->excludes(value)->excludes(csv);
}

void RowWriter::write(const ValueRecord& record, const Types& types)
{
    if (format_.is_value) {
        out_->line(raw_text_of(*record.value, types, record.data_type));
        return;
    }
    if (!format_.is_csv) {
        out_->line(formatted(format_.pattern, record, types));
        return;
    }
    if (!has_begun_) {
        has_begun_ = true;
        out_->line("node,value,unit,status,sourceTimestamp");
    }
    std::string line;
    for (const char letter : {'n', 'v', 'u', 's', 't'}) {
        line += (line.empty() ? "" : ",") + csv_field(part_of(letter, record, types));
    }
    out_->line(line);
}

std::string csv_field(const std::string& text)
{
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        return text;
    }
    std::string quoted = "\"";
    for (const char character : text) {
        quoted += character == '"' ? "\"\"" : std::string(1, character);
    }
    return quoted + "\"";
}

std::string check_pattern(const std::string& pattern)
{
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        if (pattern[i] != '%') {
            continue;
        }
        ++i;
        if (i == pattern.size() || letters.find(pattern[i]) == std::string_view::npos) {
            return "%" + pattern.substr(std::min(i, pattern.size()), 1) +
                   " is not part of a pattern; there are %n %v %j %u %s %t %T %d and %%";
        }
    }
    return pattern.empty() ? "the pattern is empty, write for example '%n %v'" : "";
}

std::string formatted(const std::string& pattern, const ValueRecord& record, const Types& types)
{
    std::string line;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        const char next = i + 1 < pattern.size() ? pattern[i + 1] : '\0';
        if (pattern[i] == '%' && next != '\0') {
            line += part_of(next, record, types);
            ++i;
        } else if (pattern[i] == '\\' && (next == 't' || next == 'n' || next == '\\')) {
            line += next == 't' ? '\t' : next == 'n' ? '\n' : '\\';
            ++i;
        } else {
            line += pattern[i];
        }
    }
    return line;
}

} // namespace busbar::tool
