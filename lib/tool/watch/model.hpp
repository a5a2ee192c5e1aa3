#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <busbar/core/types.hpp>

#include "keys.hpp"
#include "link_line.hpp"

namespace busbar::tool::watch {

/// The last numbers that a Variable had.
class History {
public:
    static constexpr std::size_t capacity = 120;
    static constexpr std::uint8_t highest_level = 8;

    /// The oldest gives way. NaN and infinite numbers leave a hole.
    void add(double number);
    [[nodiscard]] bool is_empty() const { return numbers_.empty(); }
    /// The newest numbers, at most `width`, oldest first: 1 for the least of them to highest_level
    /// for the greatest, 0 for a hole. All 1 if they are the same.
    [[nodiscard]] std::vector<std::uint8_t> levels(std::size_t width) const;

private:
    std::deque<double> numbers_;
};

/// Returns the value as a number; nothing for a Boolean, an array or any other type.
[[nodiscard]] std::optional<double> number_of(const Variant& value);

/// A Variable; all texts are `safe`.
struct Row {
    std::string name;
    /// The value for people, on one line, with its unit.
    std::string text{"(waiting)"};
    DataValue value{};
    /// Status of the value, or of the monitored item if that is bad.
    StatusCode status{};
    StatusCode item{};
    /// To sort by; not NaN.
    std::optional<double> number{};
    History history{};
    /// When the value was new, by our clock; null if there is none.
    std::optional<TimePoint> born{};
};

/// An event; all texts are `safe`.
struct EventRow {
    DateTime time;
    std::uint16_t severity{0};
    std::string source;
    std::string message;
};

enum class SortBy : std::uint8_t { Given, Name, Value, Age, Status };
[[nodiscard]] std::string_view name(SortBy sort);

/// The line that is edited at the bottom.
struct Prompt {
    enum class Kind : std::uint8_t { Filter, Write };
    Kind kind;
    std::string label;
    LineEditor line;
};

/// The content of `busbar watch` and the user's choices for showing it. Depends neither on the
/// terminal, nor on the server, nor on the time.
class Model {
public:
    static constexpr std::size_t max_events = 1'000;

    explicit Model(std::string title) : title_{std::move(title)} {}

    // Report what happened.

    void add_row(std::string name);
    /// The age follows from the server's two timestamps and from how long ago `now` is: clocks that
    /// differ do not matter.
    void set_value(std::size_t row, const DataValue& value, std::string text, const Now& now);
    /// The same value can be told better now.
    void set_text(std::size_t row, std::string text) { rows_[row].text = std::move(text); }
    /// Sets the status of a monitored item.
    void set_item(std::size_t row, StatusCode status);
    void add_event(EventRow event);
    [[nodiscard]] LinkLine& link() { return link_; }
    /// Lines on the selected row, `safe`.
    void set_details(std::vector<std::string> lines) { details_ = std::move(lines); }
    /// In place of events; empty for none.
    void set_event_note(std::string text) { event_note_ = std::move(text); }
    /// Shown until the next key.
    void tell(std::string message, Style style = Style::Plain);

    // Carry out the user's wishes.

    /// Actions that concern the view alone; false for the others.
    bool apply(Action action, const Now& now);
    void open_prompt(Prompt prompt);
    [[nodiscard]] std::optional<Prompt>& prompt() { return prompt_; }
    void set_filter(std::string text);
    /// Sets the number of rows that the table has room for, and scrolls to the selected one.
    void fit(std::size_t page_rows);

    // Tell what to draw.

    [[nodiscard]] const std::string& title() const { return title_; }
    [[nodiscard]] const LinkLine& link() const { return link_; }
    [[nodiscard]] const std::optional<Prompt>& prompt() const { return prompt_; }
    [[nodiscard]] const std::string& filter() const { return filter_; }
    [[nodiscard]] const std::string& message() const { return message_; }
    [[nodiscard]] Style message_style() const { return message_style_; }
    [[nodiscard]] const std::string& event_note() const { return event_note_; }
    [[nodiscard]] bool shows_events() const { return shows_events_; }
    /// In place of the table: the keys, or the details of the selected row.
    [[nodiscard]] bool shows_help() const { return shows_help_; }
    [[nodiscard]] bool shows_details() const { return shows_details_; }
    [[nodiscard]] const std::vector<std::string>& details() const { return details_; }
    [[nodiscard]] SortBy sort() const { return sort_; }
    [[nodiscard]] bool is_reversed() const { return is_reversed_; }
    [[nodiscard]] bool is_paused() const { return paused_.has_value(); }
    /// Returns the present rows or, if the view is paused, those of the moment when it was.
    [[nodiscard]] const std::vector<Row>& rows() const;
    [[nodiscard]] const std::deque<EventRow>& events() const; // newest first
    /// The time that ages are counted to.
    [[nodiscard]] TimePoint shown_time(const Now& now) const;
    /// Indices of rows that pass the filter, sorted.
    [[nodiscard]] std::vector<std::size_t> order() const;
    /// Returns the selected row; nothing if the filter hides all rows.
    [[nodiscard]] std::optional<std::size_t> selected() const;
    /// Position of the first visible row in order().
    [[nodiscard]] std::size_t top() const { return top_; }

private:
    struct Paused {
        std::vector<Row> rows;
        std::deque<EventRow> events;
        TimePoint at;
    };

    void toggle_pause(const Now& now);
    bool move(Action action);
    [[nodiscard]] bool is_before(const Row& a, const Row& b) const;

    std::string title_;
    std::vector<Row> rows_;
    std::deque<EventRow> events_;
    std::optional<Paused> paused_;
    LinkLine link_;
    std::optional<Prompt> prompt_;
    std::string filter_;
    std::string message_;
    Style message_style_{Style::Plain};
    std::string event_note_;
    bool shows_events_{true};
    bool shows_help_{false};
    bool shows_details_{false};
    std::vector<std::string> details_;
    SortBy sort_{SortBy::Given};
    bool is_reversed_{false};
    std::size_t selected_{0}; // a row
    std::size_t top_{0};
    std::size_t page_rows_{1};
};

/// Names of rows as a table has room for them, and the folder that is left out of each.
struct ShortNames {
    std::vector<std::string> names;
    std::string folder;
};

/// Leaves the numbers of namespaces out of paths, "2:Press/2:Speed", if no two of them become the
/// same, and then the folders that are the same in all. A name that is not a path stays unchanged.
[[nodiscard]] ShortNames short_names(const std::vector<std::string>& names);

} // namespace busbar::tool::watch
