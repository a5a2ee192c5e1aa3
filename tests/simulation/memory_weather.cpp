#include "memory_weather.hpp"

#include <algorithm>
#include <utility>

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

constexpr std::size_t kept_spells = 32;

} // namespace

MemoryWeather::MemoryWeather(Scheduler& scheduler, Trace& trace, Chance chance)
    : scheduler_{&scheduler}, trace_{&trace}, chance_{chance}, change_{scheduler,
                                                                       [this] { change(); }}
{
}

void MemoryWeather::start()
{
    change_.set_after(chance_.between(10min, 40min));
}

void MemoryWeather::stop()
{
    change_.cancel();
    kind_ = Kind::None;
}

void MemoryWeather::change()
{
    if (kind_ == Kind::None) {
        return begin();
    }
    trace_->note(0, "memory is back", std::exchange(count_, 0U));
    kind_ = Kind::None;
    change_.set_after(chance_.between(10min, 40min));
}

void MemoryWeather::begin()
{
    const bool is_gone = chance_.one_in(3);
    kind_ = is_gone ? Kind::Gone : Kind::Scarce;
    one_in_ = chance_.pick<std::size_t>({2, 4, 8, 20});
    is_first_ = true;
    trace_->note(0, is_gone ? "no memory" : "little memory", one_in_);
    change_.set_after(is_gone ? chance_.between(100ms, 10s) : chance_.between(5s, 1min));
}

void MemoryWeather::enter()
{
    if (kind_ == Kind::None) {
        return;
    }
    const std::size_t k = 1 + chance_.below(chance_.pick<std::size_t>({4, 16, 64}));
    const auto most = chance_.pick<std::size_t>({1, 1, 2, 5});
    const bool fails = chance_.one_in(one_in_);
    if (kind_ == Kind::Gone) {
        fail_allocation(1, 1'000'000);
    } else {
        fail_allocation(fails ? k : 0, most);
    }
    counted_.emplace();
}

void MemoryWeather::leave()
{
    if (!counted_) {
        return;
    }
    counted_.reset();
    if (!has_allocation_failed()) {
        return;
    }
    ++count_;
    const TimePoint now = scheduler_->now();
    if (std::exchange(is_first_, false)) {
        failures_.push_back({now, now});
        if (failures_.size() > kept_spells) {
            failures_.pop_front();
        }
    }
    failures_.back().last = now;
}

bool MemoryWeather::has_failed(TimePoint since, TimePoint until) const
{
    return std::any_of(failures_.begin(), failures_.end(), [&](const Failures& spell) {
        return spell.first <= until && spell.last >= since;
    });
}

} // namespace busbar::test
