#include "render.hpp"

#include "tool/printing/display_text.hpp"
#include "tool/printing/value_lines.hpp"

namespace busbar::tool::watch {

namespace {

std::string line_of(const std::string& title, const std::string& text)
{
    constexpr std::size_t width = 14;
    return title + std::string(width - title.size(), ' ') + text;
}

std::string time_text(DateTime time)
{
    return time.is_null() ? "none" : to_string(time);
}

} // namespace

std::vector<std::string> details_of(const Row& row, const std::string& node,
                                    const ValueFacts& facts, const Types& types,
                                    std::size_t columns)
{
    std::vector<std::string> lines{line_of("Node", safe(node))};
    const StatusCode status = row.item.is_bad() ? row.item : row.value.status;
    const bool has_value = row.born.has_value();
    lines.push_back(line_of("DataType", facts.type_name.empty() ? "not known" : facts.type_name));
    if (!facts.unit.empty()) {
        lines.push_back(line_of("Unit", facts.unit));
    }
    lines.push_back(
        line_of("Status", has_value || row.item.is_bad() ? text_of(status) : "no value yet"));
    if (!has_value) {
        return lines;
    }
    lines.push_back(line_of("Source time", time_text(row.value.source_timestamp)));
    lines.push_back(line_of("Server time", time_text(row.value.server_timestamp)));
    const ValueText value = lines_of(row.value, types, ValueLimits{}, columns, facts.data_type);
    lines.push_back(line_of("Value", value.text));
    lines.insert(lines.end(), value.lines.begin(), value.lines.end());
    return lines;
}

} // namespace busbar::tool::watch
