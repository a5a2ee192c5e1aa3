#include "simulated_link.hpp"

#include <algorithm>
#include <utility>

namespace busbar::test {

namespace {

SimulatedLink::Side other(SimulatedLink::Side side)
{
    return side == SimulatedLink::Client ? SimulatedLink::Server : SimulatedLink::Client;
}

} // namespace

SimulatedLink::SimulatedLink(Scheduler& scheduler, const Weather& weather, Chance chance)
    : scheduler_{&scheduler}, weather_{&weather}, chance_{chance}
{
}

void SimulatedLink::attach(Side side, LinkEnd& end)
{
    ends_[side] = &end;
    if (ends_[other(side)] == nullptr) {
        return;
    }
    // Some die young, while they are opened; the others at any age.
    const Duration life = chance_.one_in(8) ? chance_.between(Duration{0}, std::chrono::seconds{1})
                                            : chance_.between(Duration{0}, 2 * weather_->mean_life);
    scheduler_->after(life, [self = shared_from_this()] {
        if (self->weather_->has_resets) {
            self->reset();
        }
    });
}

void SimulatedLink::flush(Side side)
{
    while (ends_[side] != nullptr && !ends_[side]->output().empty()) {
        const auto out = ends_[side]->output();
        const std::vector<std::byte> bytes{out.begin(), out.end()};
        ends_[side]->consume(bytes.size());
        if (!is_cut_ && ends_[other(side)] != nullptr) {
            send(side, bytes);
        }
    }
}

void SimulatedLink::send(Side from, std::span<const std::byte> bytes)
{
    // How often chance is asked must not depend on the bytes: keys and signatures have other sizes
    // in another run.
    std::array cuts{bytes.size() * chance_.below(1'000) / 1'000,
                    bytes.size() * chance_.below(1'000) / 1'000, bytes.size()};
    std::sort(cuts.begin(), cuts.end());
    const Duration stall = chance_.between(Duration{0}, weather_->max_stall);
    TimePoint arrival = scheduler_->now();
    if (chance_.one_in(weather_->stall_one_in)) {
        arrival += stall;
    }
    std::size_t begin = 0;
    for (const std::size_t end : cuts) {
        arrival += chance_.between(weather_->min_latency, weather_->max_latency) / 2;
        Direction& direction = directions_[from];
        direction.last_arrival = std::max(direction.last_arrival, arrival);
        const auto piece = bytes.subspan(begin, end - begin);
        direction.pieces.emplace_back(piece.begin(), piece.end());
        scheduler_->at(direction.last_arrival,
                       [self = shared_from_this(), from] { self->arrive(from); });
        begin = end;
    }
}

void SimulatedLink::arrive(Side from)
{
    if (is_cut_) {
        return;
    }
    Direction& direction = directions_[from];
    const std::vector<std::byte> piece = std::move(direction.pieces.front());
    direction.pieces.pop_front();
    if (LinkEnd* const to = ends_[other(from)]; to != nullptr && !piece.empty()) {
        to->feed(piece);
    }
}

void SimulatedLink::reset()
{
    is_cut_ = true;
    for (const Side side : {Client, Server}) {
        const Duration late = chance_.between(Duration{0}, weather_->max_notice);
        tell(side, chance_.one_in(2) ? late : Duration{0});
    }
}

void SimulatedLink::tell(Side side, Duration delay)
{
    scheduler_->after(delay, [self = shared_from_this(), side] {
        if (LinkEnd* const end = std::exchange(self->ends_[side], nullptr)) {
            end->link_lost();
        }
    });
}

void SimulatedLink::leave(Side side)
{
    ends_[side] = nullptr;
    is_cut_ = true;
    tell(other(side), chance_.between(Duration{0}, weather_->max_notice));
}

void SimulatedLink::close(Side side)
{
    flush(side);
    ends_[side] = nullptr;
    const TimePoint last = std::max(directions_[side].last_arrival, scheduler_->now());
    tell(other(side), last - scheduler_->now());
}

} // namespace busbar::test
