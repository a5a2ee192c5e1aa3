#include "model.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace busbar::tool::watch {

namespace {

constexpr std::array<std::string_view, 5> sort_names{"given", "name", "value", "age", "status"};

bool contains(std::string_view text, std::string_view part)
{
    const auto is_same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) ==
               std::tolower(static_cast<unsigned char>(b));
    };
    return part.empty() ||
           std::search(text.begin(), text.end(), part.begin(), part.end(), is_same) != text.end();
}

/// The time that the server had the value before it sent it. Old values look new if a server gives
/// no second timestamp.
Duration age_at_server(const DataValue& value)
{
    const std::int64_t source = value.source_timestamp.ticks;
    const std::int64_t server = value.server_timestamp.ticks;
    if (source <= 0 || server <= source) {
        return Duration::zero();
    }
    constexpr std::int64_t longest = DateTime::ticks_per_second * 86'400 * 36'500; // 100 years
    constexpr std::int64_t nanoseconds_per_tick = 1'000'000'000 / DateTime::ticks_per_second;
    return Duration{std::min(server - source, longest) * nanoseconds_per_tick};
}

/// Numbers before texts, by their size.
bool is_less_value(const Row& a, const Row& b)
{
    if (a.number && b.number) {
        return *a.number < *b.number;
    }
    return a.number || b.number ? a.number.has_value() : a.text < b.text;
}

int rank_of(StatusCode status)
{
    return status.is_bad() ? 0 : status.is_uncertain() ? 1 : 2;
}

template <typename... T>
std::optional<double> first_of(const Variant& value)
{
    std::optional<double> number;
    const auto take = [&number](const auto* found) {
        if (found != nullptr) {
            number = static_cast<double>(*found);
        }
        return found != nullptr;
    };
    static_cast<void>((take(value.get_if<T>()) || ...));
    return number;
}

std::uint8_t level_of(double number, double least, double greatest)
{
    if (!std::isfinite(number)) {
        return 0;
    }
    // Halves: the difference of two finite numbers may be infinite.
    const double range = greatest / 2 - least / 2;
    const double share = range > 0 ? (number / 2 - least / 2) / range : 0;
    const double steps = History::highest_level - 1;
    return static_cast<std::uint8_t>(1 + std::lround(share * steps));
}

} // namespace

std::string_view name(SortBy sort)
{
    return sort_names[static_cast<std::size_t>(sort)];
}

void Model::add_row(std::string name)
{
    rows_.push_back({.name = std::move(name)});
}

void Model::set_value(std::size_t row, const DataValue& value, std::string text, const Now& now)
{
    Row& changed = rows_[row];
    changed.text = std::move(text);
    changed.value = value;
    changed.status = value.status;
    changed.born = now.steady - age_at_server(value);
    changed.number = number_of(value.value);
    if (changed.number) {
        changed.history.add(*changed.number);
    }
    if (changed.number && std::isnan(*changed.number)) {
        changed.number.reset();
    }
}

void Model::set_item(std::size_t row, StatusCode status)
{
    Row& changed = rows_[row];
    changed.item = status;
    if (status.is_bad()) {
        changed.text.clear();
    } else if (changed.text.empty()) {
        changed.text = "(waiting)";
    }
}

void Model::add_event(EventRow event)
{
    events_.push_front(std::move(event));
    if (events_.size() > max_events) {
        events_.pop_back();
    }
}

void Model::tell(std::string message, Style style)
{
    message_ = std::move(message);
    message_style_ = style;
}

bool Model::apply(Action action, const Now& now)
{
    message_.clear();
    if (shows_help_) {
        shows_help_ = false; // any key ends it
        return true;
    }
    switch (action) {
    case Action::Help:
        shows_help_ = true;
        return true;
    case Action::Details:
        shows_details_ = !shows_details_;
        return true;
    case Action::Pause:
        toggle_pause(now);
        return true;
    case Action::Sort:
        sort_ = static_cast<SortBy>((static_cast<std::size_t>(sort_) + 1) % sort_names.size());
        return true;
    case Action::Reverse:
        is_reversed_ = !is_reversed_;
        return true;
    case Action::Events:
        shows_events_ = !shows_events_;
        return true;
    case Action::Filter:
        open_prompt({Prompt::Kind::Filter, "filter: ", LineEditor{filter_}});
        return true;
    case Action::Cancel:
        if (shows_details_) {
            shows_details_ = false;
        } else {
            set_filter("");
        }
        return true;
    default:
        return move(action);
    }
}

void Model::toggle_pause(const Now& now)
{
    if (paused_) {
        paused_.reset();
    } else {
        paused_ = {rows_, events_, now.steady};
    }
}

bool Model::move(Action action)
{
    const std::vector<std::size_t> shown = order();
    const auto found = std::ranges::find(shown, selected_);
    const auto at = found == shown.end() ? 0 : static_cast<std::size_t>(found - shown.begin());
    std::size_t to = 0;
    switch (action) {
    case Action::Up:
        to = at - std::min<std::size_t>(at, 1);
        break;
    case Action::Down:
        to = at + 1;
        break;
    case Action::PageUp:
        to = at - std::min(at, page_rows_);
        break;
    case Action::PageDown:
        to = at + page_rows_;
        break;
    case Action::First:
        break;
    case Action::Last:
        to = shown.size();
        break;
    default:
        return false;
    }
    if (!shown.empty()) {
        selected_ = shown[std::min(to, shown.size() - 1)];
    }
    return true;
}

void Model::open_prompt(Prompt prompt)
{
    message_.clear();
    prompt_ = std::move(prompt);
}

void Model::set_filter(std::string text)
{
    filter_ = std::move(text);
}

void Model::fit(std::size_t page_rows)
{
    page_rows_ = std::max<std::size_t>(page_rows, 1);
    const std::vector<std::size_t> shown = order();
    auto found = std::ranges::find(shown, selected_);
    if (found == shown.end() && !shown.empty()) {
        found = shown.begin();
        selected_ = *found;
    }
    const auto at = static_cast<std::size_t>(found - shown.begin());
    const std::size_t last_top = shown.size() - std::min(shown.size(), page_rows_);
    top_ = std::min({top_, at, last_top});
    if (at >= top_ + page_rows_) {
        top_ = std::min(at + 1 - page_rows_, last_top);
    }
}

const std::vector<Row>& Model::rows() const
{
    return paused_ ? paused_->rows : rows_;
}

const std::deque<EventRow>& Model::events() const
{
    return paused_ ? paused_->events : events_;
}

TimePoint Model::shown_time(const Now& now) const
{
    return paused_ ? paused_->at : now.steady;
}

std::vector<std::size_t> Model::order() const
{
    const std::vector<Row>& all = rows();
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (contains(all[i].name, filter_)) {
            shown.push_back(i);
        }
    }
    std::ranges::stable_sort(
        shown, [&](std::size_t a, std::size_t b) { return is_before(all[a], all[b]); });
    if (is_reversed_) {
        std::ranges::reverse(shown);
    }
    return shown;
}

bool Model::is_before(const Row& a, const Row& b) const
{
    switch (sort_) {
    case SortBy::Name:
        return a.name < b.name;
    case SortBy::Value:
        return is_less_value(a, b);
    case SortBy::Age: // newest first
        return a.born && b.born ? *a.born > *b.born : a.born.has_value() && !b.born;
    case SortBy::Status: // worst first
        return std::min(rank_of(a.status), rank_of(a.item)) <
               std::min(rank_of(b.status), rank_of(b.item));
    case SortBy::Given:
        break;
    }
    return false;
}

std::optional<std::size_t> Model::selected() const
{
    const std::vector<std::size_t> shown = order();
    const bool is_shown = std::ranges::find(shown, selected_) != shown.end();
    return is_shown ? std::optional{selected_} : std::nullopt;
}

void History::add(double number)
{
    if (numbers_.size() == capacity) {
        numbers_.pop_front();
    }
    numbers_.push_back(number);
}

std::vector<std::uint8_t> History::levels(std::size_t width) const
{
    const std::size_t count = std::min(width, numbers_.size());
    const std::vector<double> newest(numbers_.end() - static_cast<std::ptrdiff_t>(count),
                                     numbers_.end());
    std::vector<double> finite;
    std::ranges::copy_if(newest, std::back_inserter(finite),
                         [](double number) { return std::isfinite(number); });
    const auto [least, greatest] = std::ranges::minmax_element(finite);
    std::vector<std::uint8_t> levels;
    for (const double number : newest) {
        levels.push_back(finite.empty() ? 0 : level_of(number, *least, *greatest));
    }
    return levels;
}

std::optional<double> number_of(const Variant& value)
{
    return first_of<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                    std::uint32_t, std::int64_t, std::uint64_t, float, double>(value);
}

} // namespace busbar::tool::watch
