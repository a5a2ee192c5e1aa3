#include <busbar/harness/link.hpp>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <busbar/harness/log_book.hpp>

namespace busbar::harness {

std::string Weather::flaw() const
{
    if (min_latency > max_latency) {
        return "min_latency " + text_of(min_latency) + " is above max_latency " +
               text_of(max_latency);
    }
    if (min_latency < Duration{0}) {
        return "min_latency " + text_of(min_latency) + " is below 0 s";
    }
    if (max_stall < Duration{0}) {
        return "max_stall " + text_of(max_stall) + " is below 0 s";
    }
    if (mean_life < Duration{0}) {
        return "mean_life " + text_of(mean_life) + " is below 0 s";
    }
    return max_notice < Duration{0} ? "max_notice " + text_of(max_notice) + " is below 0 s"
                                    : std::string{};
}

Link::Link(Scheduler& scheduler, const Weather& weather, Chance chance)
    : scheduler_{&scheduler}, weather_{&weather}, chance_{chance}
{
}

void Link::attach(Side side, LinkEnd& engine)
{
    end(side).engine = &engine;
    end(side).was_attached = true;
    if (end(other(side)).engine == nullptr) {
        return;
    }
    if (observer_ != nullptr) {
        observer_->opened(*this);
    }
    limit_life();
}

void Link::limit_life()
{
    if (weather_->mean_life == Duration{0} || std::exchange(has_limited_life_, true)) {
        return;
    }
    // Some end early, while they are opened; the others at any age.
    const Duration life = chance_.one_in(8) ? chance_.between(Duration{0}, std::chrono::seconds{1})
                                            : chance_.between(Duration{0}, 2 * weather_->mean_life);
    scheduler_->after(life, [self = shared_from_this()] {
        if (self->weather_->has_resets) {
            self->reset();
        }
    });
}

void Link::flush(Side side)
{
    if (!end(other(side)).was_attached) {
        return;
    }
    while (end(side).engine != nullptr && !end(side).engine->output().empty()) {
        const auto out = end(side).engine->output();
        const std::vector<std::byte> bytes{out.begin(), out.end()};
        end(side).engine->consume(bytes.size());
        if (is_cut_ || end(other(side)).engine == nullptr) {
            continue;
        }
        if (filter_ != nullptr) {
            filter_->pass(*this, side, bytes);
        } else {
            send(side, bytes);
        }
    }
}

void Link::send(Side from, std::span<const std::byte> bytes, Duration delay)
{
    if (is_cut_) {
        return;
    }
    if (const std::string flaw = weather_->flaw(); !flaw.empty()) {
        throw std::invalid_argument{"the weather contradicts itself: " + flaw};
    }
    limit_life();
    TimePoint time = scheduler_->now() + delay;
    if (weather_->has_random_cuts) {
        send_cut(from, bytes, time);
        return;
    }
    if (weather_->stall_one_in != 0 && chance_.one_in(weather_->stall_one_in)) {
        time += chance_.between(Duration{0}, weather_->max_stall);
    }
    send_whole(from, bytes, time + chance_.between(weather_->min_latency, weather_->max_latency));
}

void Link::send_cut(Side from, std::span<const std::byte> bytes, TimePoint time)
{
    // The number of random numbers must not depend on the bytes: keys and signatures have other
    // sizes in another run.
    std::array cuts{bytes.size() * chance_.below(1'000) / 1'000,
                    bytes.size() * chance_.below(1'000) / 1'000, bytes.size()};
    std::sort(cuts.begin(), cuts.end());
    const Duration stall = chance_.between(Duration{0}, weather_->max_stall);
    if (weather_->stall_one_in != 0 && chance_.one_in(weather_->stall_one_in)) {
        time += stall;
    }
    std::size_t begin = 0;
    for (const std::size_t cut : cuts) {
        time += chance_.between(weather_->min_latency, weather_->max_latency) / 2;
        send_whole(from, bytes.subspan(begin, cut - begin), time);
        begin = cut;
    }
}

void Link::send_whole(Side from, std::span<const std::byte> bytes, TimePoint time)
{
    const std::size_t size = std::max<std::size_t>(1, std::min(max_piece_, weather_->max_piece));
    do {
        const auto piece = bytes.first(std::min(size, bytes.size()));
        put(from, piece, time);
        bytes = bytes.subspan(piece.size());
    } while (!bytes.empty());
}

void Link::put(Side from, std::span<const std::byte> piece, TimePoint arrival)
{
    End& sender = end(from);
    if (weather_->bytes_per_second != 0) {
        using Seconds = std::chrono::duration<double>;
        const Seconds transfer{static_cast<double>(piece.size()) /
                               static_cast<double>(weather_->bytes_per_second)};
        const TimePoint begin = std::max(sender.last_departure, scheduler_->now());
        sender.last_departure = begin + std::chrono::duration_cast<Duration>(transfer);
        arrival += sender.last_departure - scheduler_->now();
    }
    sender.last_arrival = std::max(sender.last_arrival, arrival);
    sender.pieces.emplace_back(piece.begin(), piece.end());
    scheduler_->at(sender.last_arrival, [self = shared_from_this(), from] { self->arrive(from); });
}

void Link::arrive(Side from)
{
    if (is_cut_) {
        return;
    }
    if (end(from).is_held) {
        ++end(from).due;
        return;
    }
    deliver(from);
}

void Link::deliver(Side from)
{
    const Piece piece = std::move(end(from).pieces.front());
    end(from).pieces.pop_front();
    LinkEnd* const to = end(other(from)).engine;
    if (to == nullptr || piece.empty()) {
        return;
    }
    if (observer_ != nullptr) {
        observer_->arrived(*this, from, piece);
    }
    to->feed(piece);
}

void Link::hold(Side from)
{
    end(from).is_held = true;
}

void Link::release(Side from)
{
    End& sender = end(from);
    sender.is_held = false;
    const auto self = shared_from_this(); // an end may drop the link meanwhile
    while (sender.due > 0 && !is_cut_ && !sender.is_held) {
        --sender.due;
        deliver(from);
    }
    if (!sender.is_held && std::exchange(sender.is_end_held, false)) {
        tell_of_end(from);
    }
}

void Link::cut()
{
    is_cut_ = true;
    tell(Side::Client, Duration{0});
    tell(Side::Server, Duration{0});
}

void Link::cut_for(Side side)
{
    is_cut_ = true;
    tell(side, Duration{0});
}

void Link::reset()
{
    is_cut_ = true;
    for (const Side side : {Side::Client, Side::Server}) {
        const Duration late = chance_.between(Duration{0}, weather_->max_notice);
        tell(side, chance_.one_in(2) ? late : Duration{0});
    }
}

void Link::tell(Side side, Duration delay)
{
    scheduler_->after(delay, [self = shared_from_this(), side] { self->tell_now(side); });
}

void Link::tell_now(Side side)
{
    const bool was_open = ends_[0].was_attached && ends_[1].was_attached;
    if (!std::exchange(end(other(side)).is_gone, true) && was_open && observer_ != nullptr) {
        observer_->ended(*this, other(side));
    }
    if (LinkEnd* const engine = std::exchange(end(side).engine, nullptr)) {
        engine->link_lost();
    }
}

void Link::leave(Side side)
{
    end(side).engine = nullptr;
    is_cut_ = true;
    tell(other(side), chance_.between(Duration{0}, weather_->max_notice));
}

void Link::close(Side side)
{
    flush(side);
    end(side).engine = nullptr;
    if (end(side).is_held) {
        end(side).is_end_held = true;
    } else {
        tell_of_end(side);
    }
}

void Link::tell_of_end(Side side)
{
    const TimePoint last = std::max(end(side).last_arrival, scheduler_->now());
    tell(other(side), last - scheduler_->now());
}

} // namespace busbar::harness
