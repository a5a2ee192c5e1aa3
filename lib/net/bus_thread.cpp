#include "bus_thread.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "clock.hpp"

namespace busbar::net::detail {

BusThread::BusThread(std::unique_ptr<Bus> bus, LogSink& log)
    : bus_{std::move(bus)}, log_{&log}, thread_{[this] { run(); }}
{
}

BusThread::~BusThread()
{
    {
        const std::lock_guard lock{mutex_};
        ends_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void BusThread::set_waker(Waker* waker)
{
    const std::lock_guard lock{mutex_};
    waker_ = waker;
    if (outcome_) {
        wake();
    }
}

/// The mutex is locked.
void BusThread::wake()
{
    if (waker_ != nullptr) {
        busbar::detail::attempt([this] { waker_->wake(); });
    }
}

void BusThread::give(Job job)
{
    {
        const std::lock_guard lock{mutex_};
        jobs_.push_back(std::move(job));
    }
    changed_.notify_one();
}

std::optional<BusThread::Outcome> BusThread::take()
{
    std::optional<Outcome> outcome;
    {
        const std::lock_guard lock{mutex_};
        outcome.swap(outcome_);
    }
    changed_.notify_one();
    return outcome;
}

void BusThread::run()
{
    std::unique_lock lock{mutex_};
    for (;;) {
        changed_.wait(lock, [this] { return ends_ || (!jobs_.empty() && !outcome_); });
        if (ends_) {
            return;
        }
        const Job job = std::move(jobs_.front());
        jobs_.pop_front();
        if (const auto* const pause = std::get_if<Pause>(&job)) {
            if (changed_.wait_until(lock, pause->until, [this] { return ends_; })) {
                return;
            }
            outcome_ = Paused{};
        } else {
            lock.unlock();
            const auto* const request = std::get_if<backend::PlanRequest>(&job);
            Outcome outcome = request != nullptr ? outcome_of(*request) : outcome_of(Open{});
            lock.lock();
            outcome_ = std::move(outcome);
        }
        wake();
    }
}

BusThread::Outcome BusThread::outcome_of(const Open& /*open*/)
{
    Result<void> result;
    const StatusCode thrown =
        busbar::detail::guarded(*log_, "Bus::open", [&] { result = bus_->open(); });
    if (thrown.is_bad()) {
        result = fail(thrown);
    }
    return Opened{result};
}

BusThread::Outcome BusThread::outcome_of(const backend::PlanRequest& request)
{
    using Kind = backend::DeviceAnswer::Kind;
    Answered answered;
    backend::DeviceAnswer& answer = answered.answer;
    answer.request = request.id;
    const TimePoint sent = now();
    StatusCode status;
    const auto exchange = [&] {
        if (request.is_write) {
            const auto written = bus_->write(request);
            status = written ? StatusCode{} : written.error();
        } else if (auto read = bus_->read(request)) {
            answer.words = *std::move(read);
        } else {
            status = read.error();
        }
    };
    const StatusCode thrown =
        busbar::detail::guarded(*log_, request.is_write ? "Bus::write" : "Bus::read", exchange);
    answered.is_lost = status == StatusCode{status::Bad_NoCommunication};
    const bool is_failed =
        thrown.is_bad() || answered.is_lost || status == StatusCode{status::Bad_Timeout};
    answer.status = thrown.is_bad() ? thrown : status;
    answer.kind = is_failed ? Kind::Failed : answer.status.is_bad() ? Kind::Refused : Kind::Done;
    answer.round_trip = now() - sent;
    return answered;
}

} // namespace busbar::net::detail
