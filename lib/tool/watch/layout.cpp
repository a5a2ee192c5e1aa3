#include <algorithm>

#include "render.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/output.hpp"

namespace busbar::tool::watch {

namespace {

constexpr std::size_t age_width = 6;
constexpr std::size_t status_width = 30;
constexpr std::size_t least_name = 8;
/// Below these a column gives way.
constexpr std::size_t columns_with_age = 30;
constexpr std::size_t columns_with_trend = 50;
constexpr std::size_t columns_with_status = 100;
constexpr std::size_t longest_trend = 40;

Columns columns_of(const Model& model, std::size_t columns)
{
    Columns widths{};
    std::size_t left = columns;
    const auto take = [&left](std::size_t width) {
        left -= width + column_gap;
        return width;
    };
    if (columns >= columns_with_age) {
        widths.age = take(age_width);
    }
    if (columns >= columns_with_trend) {
        widths.trend = take(std::min(columns / 6, longest_trend));
    }
    if (columns >= columns_with_status) {
        widths.status = take(status_width);
    }
    std::size_t longest = least_name;
    for (const Row& row : model.rows()) {
        longest = std::max(longest, display_width(row.name));
    }
    // The half at most; the value has the rest.
    widths.name = std::min(longest, left / 2 - std::min(left / 2, column_gap / 2));
    widths.value = left - std::min(left, widths.name + column_gap);
    return widths;
}

} // namespace

Layout layout_of(const Model& model, Size size)
{
    Layout layout{.columns = columns_of(model, size.columns),
                  .has_title = size.rows >= 6,
                  .has_link = size.rows >= 4,
                  .has_header = size.rows >= 3,
                  .has_bottom = size.rows >= 2,
                  .table_rows = 0,
                  .event_rows = 0};
    const auto fixed =
        static_cast<std::size_t>(layout.has_title) + static_cast<std::size_t>(layout.has_link) +
        static_cast<std::size_t>(layout.has_header) + static_cast<std::size_t>(layout.has_bottom);
    const std::size_t body = size.rows - std::min(size.rows, fixed);
    constexpr std::size_t rows_with_events = 12;
    constexpr std::size_t least_events = 3;
    if (!model.shows_events() || size.rows < rows_with_events) {
        layout.table_rows = body;
        return layout;
    }
    const std::size_t events = std::max(least_events, size.rows / 5);
    layout.table_rows = std::clamp<std::size_t>(model.rows().size(), 1, body - events);
    layout.event_rows = body - layout.table_rows;
    return layout;
}

} // namespace busbar::tool::watch
