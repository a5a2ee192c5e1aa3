#include <busbar/net/bus_source.hpp>

#include <deque>
#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/net/system.hpp>

#include "bus_thread.hpp"
#include "clock.hpp"

namespace busbar::net {

namespace {

using detail::BusThread;

/// A connection of a Bus, which has no bytes: requests go to the thread, answers come from it.
class BusLine final : public backend::DeviceLine {
public:
    /// Both must outlive the object.
    BusLine(BusThread& thread, std::deque<backend::DeviceAnswer>& answers)
        : thread_{thread}, answers_{answers}
    {
        answers_.clear();
    }

    [[nodiscard]] bool is_ready() const override { return true; }
    [[nodiscard]] bool has_answered() const override { return has_answered_; }
    Result<void> send(const backend::PlanRequest& request, TimePoint /*now*/) override
    {
        // The plan takes the request as sent unless this fails.
        const StatusCode given = busbar::detail::caught([&] { thread_.give(request); });
        return given.is_bad() ? Result<void>{fail(given)} : Result<void>{};
    }
    [[nodiscard]] std::optional<backend::DeviceAnswer> next_answer() override
    {
        if (answers_.empty()) {
            return std::nullopt;
        }
        backend::DeviceAnswer answer = std::move(answers_.front());
        answers_.pop_front();
        has_answered_ = has_answered_ || answer.kind != backend::DeviceAnswer::Kind::Failed;
        return answer;
    }
    Result<void> feed(std::span<const std::byte> /*in*/, TimePoint /*now*/) override { return {}; }
    [[nodiscard]] std::span<const std::byte> output() const override { return {}; }
    void consume(std::size_t /*size*/) override {}
    [[nodiscard]] TimePoint next_deadline() const override { return no_deadline; }
    void handle_deadline(TimePoint /*now*/) override {}
    [[nodiscard]] bool is_closed() const override { return false; }
    [[nodiscard]] std::string reason() const override { return {}; }

private:
    BusThread& thread_;
    std::deque<backend::DeviceAnswer>& answers_;
    bool has_answered_{false};
};

class BusProtocol final : public backend::DeviceProtocol {
public:
    BusProtocol(backend::PlanConfig plan, BusThread& thread,
                std::deque<backend::DeviceAnswer>& answers)
        : plan_{std::move(plan)}, thread_{thread}, answers_{answers}
    {
        plan_.max_under_way = 1; // the calls wait for each other
    }

    [[nodiscard]] backend::PlanConfig plan() const override { return plan_; }
    [[nodiscard]] std::unique_ptr<backend::DeviceLine> connect(TimePoint /*now*/) override
    {
        return std::make_unique<BusLine>(thread_, answers_);
    }

private:
    backend::PlanConfig plan_;
    BusThread& thread_;
    std::deque<backend::DeviceAnswer>& answers_;
};

backend::DeviceConfig config_of(const BusSourceOptions& options)
{
    backend::DeviceConfig config;
    config.name = options.name;
    config.first_pause = options.first_pause;
    config.longest_pause = options.longest_pause;
    return config;
}

} // namespace

struct BusSource::Impl {
    Impl(std::unique_ptr<Bus> bus, std::vector<backend::DevicePoint> points,
         const BusSourceOptions& options)
        : log{options.log != nullptr ? *options.log : no_log}, plan{bus->plan()},
          thread{std::move(bus), log}, device{config_of(options),
                                              std::make_unique<BusProtocol>(plan, thread, answers),
                                              log},
          source{device, std::move(points), clock, detail::now, options.source}
    {
    }

    /// Has the connection opened, now or after a pause, unless that is under way.
    void connect()
    {
        if (is_opening || device.state() != backend::DeviceState::Waiting) {
            return;
        }
        if (const TimePoint now = detail::now(); device.wants_connection(now)) {
            thread.give(BusThread::Open{});
            is_opening = true;
            device.connecting(now);
        } else {
            thread.give(BusThread::Pause{device.next_deadline()});
            is_opening = true;
        }
    }
    void take(BusThread::Paused /*paused*/) { is_opening = false; }
    void take(const BusThread::Opened& opened)
    {
        is_opening = false;
        if (opened.result) {
            device.connected(detail::now());
        } else {
            device.lost("it cannot be opened: " + std::string{name(opened.result.error())},
                        detail::now());
        }
    }
    void take(BusThread::Answered& answered)
    {
        if (answered.is_lost) {
            device.lost("the connection is lost", detail::now());
            return;
        }
        answers.push_back(std::move(answered.answer));
        device.flush(detail::now());
    }

    NullLog no_log;
    SystemWallClock clock;
    LogSink& log;
    backend::PlanConfig plan;
    std::deque<backend::DeviceAnswer> answers;
    BusThread thread; // outlives the device, whose lines use it
    backend::Device device;
    backend::DeviceSource source;
    /// The thread has an Open or a Pause.
    bool is_opening{false};
};

BusSource::BusSource(std::unique_ptr<Bus> bus, std::vector<backend::DevicePoint> points,
                     const BusSourceOptions& options)
    : impl_{std::make_unique<Impl>(std::move(bus), std::move(points), options)}
{
}

BusSource::~BusSource() = default;

server::DataSourceOptions BusSource::options() const
{
    return impl_->source.options();
}

void BusSource::read(server::ReadBatch batch)
{
    impl_->connect(); // unless that failed before
    impl_->source.read(std::move(batch));
}

void BusSource::write(server::WriteBatch batch)
{
    impl_->source.write(std::move(batch));
}

void BusSource::attach(server::Waker* waker)
{
    impl_->thread.set_waker(waker);
    if (waker != nullptr) {
        impl_->connect();
    }
}

void BusSource::handle_completions()
{
    while (auto outcome = impl_->thread.take()) {
        const StatusCode thrown = busbar::detail::guarded(impl_->log, "an answer of a bus", [&] {
            std::visit([this](auto& each) { impl_->take(each); }, *outcome);
        });
        if (thrown.is_bad()) { // what the plan waits for may be gone
            busbar::detail::attempt(
                [this] { impl_->device.lost("there is no memory", detail::now()); });
        }
    }
    impl_->connect();
}

} // namespace busbar::net
