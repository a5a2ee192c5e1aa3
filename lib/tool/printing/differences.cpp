#include "differences.hpp"

#include <algorithm>

#include "core/ascii_case.hpp"
#include "display_text.hpp"
#include "json_writer.hpp"
#include "table.hpp"

namespace busbar::tool {

namespace {

std::string member_name(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(), busbar::detail::to_ascii_lower);
    return text;
}

} // namespace

Exit print_differences(Context& context, const std::vector<Difference>& differences,
                       const DifferenceTitles& titles)
{
    JsonLine json;
    json.open_object().key("differences").open_array();
    Table table{
        {{titles.what, 24}, {titles.first, 16, false, true}, {titles.second, 16, false, true}}};
    for (const Difference& each : differences) {
        json.open_object().member(member_name(titles.what), each.what);
        json.member(member_name(titles.first), each.first);
        json.member(member_name(titles.second), each.second).close_object();
        table.add({{safe(each.what)},
                   {each.first.empty() ? titles.nothing : safe(each.first)},
                   {each.second.empty() ? titles.nothing : safe(each.second)}});
    }
    const bool is_same = differences.empty();
    if (context.options.is_json) {
        context.out.line(json.close_array().member("isSame", is_same).close_object().document());
    } else if (is_same) {
        context.out.line("no differences");
    } else {
        table.print(context.out);
    }
    return is_same ? Exit::Good : Exit::Failed;
}

} // namespace busbar::tool
