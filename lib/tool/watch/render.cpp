#include "render.hpp"

#include <algorithm>

#include "tool/printing/display_text.hpp"
#include "tool/printing/output.hpp"
#include "tool/printing/value.hpp"
#include "tool/stream/event_stream.hpp"

namespace busbar::tool::watch {

namespace {

constexpr const char* blocks[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
constexpr const char* ascii_blocks[] = {" ", "_", ".", "-", "~", "+", "=", "*", "#"};
static_assert(std::size(blocks) == History::highest_level + 1);
static_assert(std::size(ascii_blocks) == History::highest_level + 1);

/// Draws one picture from the top to the bottom.
class Painter {
public:
    Painter(const Model& model, Size size, const Now& now, bool has_unicode)
        : model_{&model}, now_{now}, has_unicode_{has_unicode}, layout_{layout_of(model, size)},
          order_{model.order()}, screen_{size}
    {
    }
    Screen paint()
    {
        if (layout_.has_title) {
            title();
        }
        if (layout_.has_link) {
            put(0, model_->link().text(now_), {model_->link().style()});
            ++row_;
        }
        if (model_->shows_help()) {
            lines("KEYS", all_key_help());
        } else if (model_->shows_details()) {
            lines("DETAILS", model_->details());
        } else {
            if (layout_.has_header) {
                header();
            }
            table();
            events();
        }
        if (layout_.has_bottom) {
            row_ = screen_.size().rows - 1;
            bottom();
        }
        return std::move(screen_);
    }

private:
    [[nodiscard]] std::size_t columns() const { return screen_.size().columns; }
    /// Writes as much of the text as fits at the current row.
    void put(std::size_t column, std::string_view text, Ink ink = {})
    {
        if (column < columns()) {
            screen_.put(row_, column, cut(text, columns() - column), ink);
        }
    }
    void title();
    /// In place of the table and the events.
    void lines(const std::string& heading, const std::vector<std::string>& text);
    void header();
    void table();
    void row(const Row& row, bool is_selected);
    void events();
    void event(const EventRow& event);
    void bottom();
    void prompt(const Prompt& prompt);
    [[nodiscard]] std::string view_text() const;
    [[nodiscard]] std::string trend_text(const History& history) const;
    /// Column by column, with blanks between.
    void cells(const std::string& name, const std::string& value, const std::string& trend,
               const std::string& age, const std::string& status, const Ink (&inks)[5]);

    const Model* model_;
    Now now_;
    bool has_unicode_;
    Layout layout_;
    std::vector<std::size_t> order_;
    Screen screen_;
    std::size_t row_{0};
};

void Painter::title()
{
    const Ink ink{Style::Bold, true};
    screen_.fill(row_, ink);
    const std::string right = cut(view_text(), columns() - std::min<std::size_t>(columns(), 1));
    const std::size_t at = columns() - std::min(columns(), display_width(right) + 1);
    if (at > 2 + column_gap) {
        screen_.put(row_, 1, cut("busbar watch " + model_->title(), at - 1 - column_gap), ink);
    }
    screen_.put(row_, at, right, ink);
    ++row_;
}

/// Describes the view: "PAUSED  filter: speed  sort: name  1-16 of 19".
std::string Painter::view_text() const
{
    std::string text;
    if (model_->is_paused()) {
        text += "PAUSED  ";
    }
    if (!model_->filter().empty()) {
        text += "filter: " + cut(safe(model_->filter()), 16) + "  ";
    }
    if (model_->sort() != SortBy::Given || model_->is_reversed()) {
        text += "sort: " + std::string{name(model_->sort())} +
                (model_->is_reversed() ? " reversed  " : "  ");
    }
    const std::size_t first = std::min(model_->top() + 1, order_.size());
    const std::size_t last = std::min(model_->top() + layout_.table_rows, order_.size());
    return text + std::to_string(first) + "-" + std::to_string(last) + " of " +
           std::to_string(order_.size());
}

void Painter::cells(const std::string& name, const std::string& value, const std::string& trend,
                    const std::string& age, const std::string& status, const Ink (&inks)[5])
{
    const Columns& widths = layout_.columns;
    std::size_t column = 0;
    const auto cell = [&](std::size_t width, const std::string& text, Ink ink) {
        if (width > 0) {
            screen_.put(row_, column, text, ink);
            column += width + column_gap;
        }
    };
    cell(widths.name, cut_front(name, widths.name), inks[0]);
    cell(widths.value, cut(value, widths.value), inks[1]);
    cell(widths.trend, trend, inks[2]);
    cell(widths.age, std::string(widths.age - std::min(widths.age, age.size()), ' ') + age,
         inks[3]);
    cell(widths.status, cut(status, widths.status), inks[4]);
    ++row_;
}

void Painter::lines(const std::string& heading, const std::vector<std::string>& text)
{
    const std::size_t end = screen_.size().rows - (layout_.has_bottom ? 1 : 0);
    if (layout_.has_header) {
        put(0, heading, {Style::Bold});
        ++row_;
    }
    for (std::size_t i = 0; i < text.size() && row_ < end; ++i, ++row_) {
        const std::size_t left = text.size() - i;
        const bool is_cut = row_ + 1 == end && left > 1;
        put(0, is_cut ? "... " + std::to_string(left) + " more lines" : text[i],
            {is_cut ? Style::Dim : Style::Plain});
    }
}

void Painter::header()
{
    const Ink bold{Style::Bold};
    cells("NODE", "VALUE", "TREND", "AGE", "STATUS", {bold, bold, bold, bold, bold});
}

void Painter::table()
{
    const std::size_t end = row_ + layout_.table_rows;
    const auto selected = model_->selected();
    for (std::size_t i = model_->top(); i < order_.size() && row_ < end; ++i) {
        row(model_->rows()[order_[i]], order_[i] == selected);
    }
    if (order_.empty() && row_ < end) {
        put(0, model_->rows().empty() ? "(no Variables)" : "(the filter leaves nothing)",
            {Style::Dim});
    }
    row_ = end;
}

void Painter::row(const Row& row, bool is_selected)
{
    if (is_selected) {
        screen_.fill(row_, {Style::Plain, true});
    }
    const StatusCode status = row.item.is_bad() ? row.item : row.status;
    const std::string words = status.is_good() ? "" : text_of(status);
    const bool has_status = layout_.columns.status > 0;
    std::string value = status.is_bad() ? (has_status ? "" : words) : row.text;
    if (status.is_uncertain() && !has_status) {
        value += " " + words;
    }
    const std::string age =
        row.born ? age_text(model_->shown_time(now_) - *row.born) : std::string{};
    const Ink plain{Style::Plain, is_selected};
    const Ink colour{style_of(status), is_selected};
    cells(row.name, value, trend_text(row.history), age, words,
          {plain, colour, plain, {is_selected ? Style::Plain : Style::Dim, is_selected}, colour});
}

std::string Painter::trend_text(const History& history) const
{
    std::string text;
    for (const std::uint8_t level : history.levels(layout_.columns.trend)) {
        text += has_unicode_ ? blocks[level] : ascii_blocks[level];
    }
    return text;
}

void Painter::events()
{
    if (layout_.event_rows == 0) {
        return;
    }
    const std::size_t end = row_ + layout_.event_rows;
    const std::string line{has_unicode_ ? "─" : "-"};
    for (std::size_t column = 0; column < columns(); ++column) {
        screen_.put(row_, column, line, {Style::Dim});
    }
    put(2, " EVENTS ", {Style::Bold});
    ++row_;
    if (!model_->event_note().empty()) {
        put(0, model_->event_note(), {Style::Dim});
    } else if (model_->events().empty()) {
        put(0, "(none so far)", {Style::Dim});
    }
    for (auto event = model_->events().begin(); event != model_->events().end() && row_ < end;
         ++event) {
        this->event(*event);
    }
    row_ = end;
}

void Painter::event(const EventRow& event)
{
    const Ink ink{event_style(event.severity)};
    std::string severity = std::to_string(event.severity);
    severity.insert(0, 5 - std::min<std::size_t>(severity.size(), 5), ' ');
    put(0, time_of_day(event.time) + severity + "  ", ink);
    const std::size_t source = columns() < 60 ? 10 : 20;
    put(19, cut(event.source, source), ink);
    put(19 + source + column_gap, event.message, ink);
    ++row_;
}

void Painter::bottom()
{
    if (model_->prompt()) {
        prompt(*model_->prompt());
    } else if (!model_->message().empty()) {
        put(0, model_->message(), {model_->message_style()});
    } else {
        screen_.fill(row_, {Style::Plain, true});
        screen_.put(row_, 0, key_help(columns()), {Style::Plain, true});
    }
}

/// Shows the end of a text that is too long, because the cursor is there.
void Painter::prompt(const Prompt& prompt)
{
    const std::size_t room = columns() - std::min<std::size_t>(columns(), 1);
    const std::string label = cut(prompt.label, room / 2);
    const std::size_t at = display_width(label);
    const std::string text = cut_front(safe(prompt.line.text()), room - at);
    screen_.put(row_, 0, label, {Style::Bold});
    screen_.put(row_, at, text);
    screen_.cursor = Screen::Place{row_, at + display_width(text)};
}

} // namespace

Screen render(const Model& model, Size size, const Now& now, bool has_unicode)
{
    return Painter{model, size, now, has_unicode}.paint();
}

} // namespace busbar::tool::watch
