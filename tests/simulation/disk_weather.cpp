#include "disk_weather.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

DiskWeather::DiskWeather(Scheduler& scheduler, Trace& trace, storage::MemoryStorage& medium,
                         std::uint64_t number, Chance chance)
    : trace_{&trace}, medium_{&medium}, number_{number}, chance_{chance},
      change_{scheduler, [this] { change(); }}, fail_{scheduler, [this] { fail(); }}
{
}

void DiskWeather::start()
{
    change_.set_after(chance_.between(5min, 40min));
}

void DiskWeather::stop()
{
    change_.cancel();
    end();
}

void DiskWeather::change()
{
    if (kind_ == Kind::Good) {
        begin();
        change_.set_after(chance_.between(1s, 10min));
    } else {
        end();
        change_.set_after(chance_.between(5min, 40min));
    }
}

void DiskWeather::begin()
{
    using enum Kind;
    kind_ = chance_.pick({Full, Protected, Away, Failing, Failing});
    trace_->note(number_, "the medium is bad", static_cast<std::uint64_t>(kind_));
    switch (kind_) {
    case Full:
        fill();
        break;
    case Protected:
        medium_->set_protected(true);
        break;
    case Away:
        medium_->set_away(true);
        break;
    default:
        fail();
    }
}

void DiskWeather::end()
{
    kind_ = Kind::Good;
    fail_.cancel();
    medium_->set_capacity(UINT64_MAX);
    medium_->set_protected(false);
    medium_->set_away(false);
}

/// Somebody else needs almost all of the room.
void DiskWeather::fill()
{
    ++full_spells_;
    const std::uint64_t used = UINT64_MAX - medium_->free_space().value_or(UINT64_MAX);
    medium_->set_capacity(used + chance_.below(chance_.pick<std::size_t>({1, 100, 5'000})));
}

void DiskWeather::fail()
{
    using enum StorageError;
    medium_->fail_once_after(chance_.below(chance_.pick<std::size_t>({4, 100, 2'000})),
                             chance_.pick({Full, Protected, Away, Failed}));
    fail_.set_after(chance_.between(100ms, 20s));
}

} // namespace busbar::test
