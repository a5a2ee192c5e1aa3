#include "link_line.hpp"

#include <algorithm>
#include <cstdio>

#include "tool/printing/value.hpp"

namespace busbar::tool::watch {

namespace {

/// "12:34:56"
std::string seconds_of_day(DateTime time)
{
    return time_of_day(time).substr(0, 8);
}

} // namespace

void LinkLine::connected(std::string how, bool is_secure, const Now& now)
{
    how_ = std::move(how);
    is_secure_ = is_secure;
    if (lost_) {
        back_ = "back since " + seconds_of_day(now.wall) + " after " +
                age_text(now.steady - lost_->at.steady) + ", ";
        lost_.reset();
    }
}

void LinkLine::lost(StatusCode why, const Now& now)
{
    if (!lost_) {
        missed_.clear();
    }
    lost_ = {lost_ ? lost_->at : now, why};
}

void LinkLine::missed(DateTime from, DateTime to, StatusCode why)
{
    missed_ = "may have missed " + seconds_of_day(from) + " to " + seconds_of_day(to) + " (" +
              text_of(why) + "), ";
}

std::string LinkLine::text(const Now& now) const
{
    if (lost_) {
        return "lost since " + seconds_of_day(lost_->at.wall) + ", " +
               age_text(now.steady - lost_->at.steady) +
               " ago, trying again: " + text_of(lost_->why);
    }
    return back_ + missed_ + (how_.empty() ? "connecting" : "connected, " + how_);
}

Style LinkLine::style() const
{
    return lost_ ? Style::Bad : is_secure_ && missed_.empty() ? Style::Good : Style::Uncertain;
}

std::string age_text(Duration age)
{
    using std::chrono::duration_cast;
    const double seconds = std::max(0.0, std::chrono::duration<double>{age}.count());
    char text[32];
    if (seconds < 0.95) {
        std::snprintf(text, sizeof text, "%.1f s", seconds);
        return text;
    }
    struct Unit {
        double seconds;
        double until;
        const char* name;
    };
    for (const Unit& unit : {Unit{1, 60, "s"}, Unit{60, 3'600, "min"}, Unit{3'600, 86'400, "h"}}) {
        if (seconds + 0.05 < unit.until) {
            std::snprintf(text, sizeof text, "%d %s",
                          static_cast<int>((seconds + 0.05) / unit.seconds), unit.name);
            return text;
        }
    }
    std::snprintf(text, sizeof text, "%.0f d", std::min(seconds / 86'400, 99'999.0));
    return text;
}

} // namespace busbar::tool::watch
