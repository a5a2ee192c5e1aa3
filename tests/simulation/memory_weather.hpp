#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "harness_names.hpp"
#include "support/failing_allocation.hpp"
#include "trace.hpp"

namespace busbar::test {

/// Memory that the server, and nobody else, does not get now and then: in spells of some seconds in
/// which there is none at all, or up to a minute in which allocations fail here and there. Only
/// chance says which of a call, so that a call that allocates more in another run changes nothing
/// for the next.
class MemoryWeather final : public EngineWatch {
public:
    MemoryWeather(Scheduler& scheduler, Trace& trace, Chance chance);

    void start();
    /// Ends a spell.
    void stop();

    /// Whether an allocation failed then; of what is long past the whole spell counts.
    [[nodiscard]] bool has_failed(TimePoint since, TimePoint until) const;
    [[nodiscard]] bool has_failed(TimePoint since) const
    {
        return has_failed(since, scheduler_->now());
    }
    /// When one failed last; long past if none has.
    [[nodiscard]] TimePoint last_failure() const
    {
        return failures_.empty() ? TimePoint{} : failures_.back().last;
    }

    // EngineWatch
    void enter() override;
    void leave() override;

private:
    enum class Kind : std::uint8_t { None, Scarce, Gone };
    struct Failures {
        TimePoint first;
        TimePoint last;
    };

    void change();
    void begin();

    Scheduler* scheduler_;
    Trace* trace_;
    Chance chance_;
    Kind kind_{Kind::None};
    /// One in so many calls of a scarce spell fails.
    std::size_t one_in_{1};
    std::optional<Counted> counted_;
    /// Of the last spells, those in which something failed.
    std::deque<Failures> failures_;
    bool is_first_{false};
    std::uint64_t count_{0};
    Alarm change_;
};

} // namespace busbar::test
