#pragma once

#include <optional>
#include <string>

#include <busbar/core/clock.hpp>
#include <busbar/core/types.hpp>

#include "tool/printing/output.hpp"

namespace busbar::tool::watch {

/// The present moment by the clock for durations and by the clock for display.
struct Now {
    TimePoint steady;
    DateTime wall;
};

/// Describes the state of the connection on one line, news first.
class LinkLine {
public:
    /// `how` describes its security and the user.
    void connected(std::string how, bool is_secure, const Now& now);
    void lost(StatusCode why, const Now& now);
    /// Notifications between the two moments may be missing; null: it is not known since when.
    void missed(DateTime from, DateTime to, StatusCode why);

    [[nodiscard]] bool is_lost() const { return lost_.has_value(); }
    [[nodiscard]] std::string text(const Now& now) const;
    [[nodiscard]] Style style() const;

private:
    struct Loss {
        Now at;
        StatusCode why;
    };

    std::string how_;
    bool is_secure_{true};
    std::optional<Loss> lost_;
    std::string back_;
    std::string missed_;
};

/// "0.2 s", "3 s", "2 min", "5 h", "12 d".
[[nodiscard]] std::string age_text(Duration age);

} // namespace busbar::tool::watch
