#pragma once

#include <busbar/core/api.hpp>
#include <busbar/harness/scheduler.hpp>

namespace busbar::harness {

/// 2026-01-01T00:00:00Z, when virtual time begins unless a test says otherwise.
inline constexpr DateTime first_day = DateTime::from_unix_seconds(1'767'225'600);

/// The time of day of a machine whose clock is set while it runs. The scheduler must outlive it.
/// Used by the scheduler's thread only.
class BUSBAR_API JumpingClock final : public WallClock {
public:
    explicit JumpingClock(const Scheduler& scheduler, DateTime begin = first_day)
        : scheduler_{&scheduler}, begin_{begin}
    {
    }

    [[nodiscard]] DateTime now() const override
    {
        const Duration time = scheduler_->now().time_since_epoch() + offset_;
        return {begin_.ticks + time.count() / 100};
    }
    /// Monotonic time is not affected.
    void jump(Duration by) { offset_ += by; }

private:
    const Scheduler* scheduler_;
    DateTime begin_;
    Duration offset_{0};
};

} // namespace busbar::harness
