#include <busbar/backend/device.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include <busbar/core/status_codes.hpp>

namespace busbar::backend {

namespace {

constexpr std::size_t most_told = 16;

/// Shortest pause after a refused password, and what the trouble says of it.
constexpr Duration denied_pause = std::chrono::minutes{10};
constexpr const char* denied_text = "; it is tried again after 10 minutes, or at a restart";

/// FNV-1a: the same on each machine.
std::uint64_t hash_of(std::string_view text, std::uint64_t attempt)
{
    std::uint64_t hash = 14'695'981'039'346'656'037U;
    const auto mix = [&](std::uint64_t byte) { hash = (hash ^ byte) * 1'099'511'628'211U; };
    std::ranges::for_each(text, [&](char each) { mix(static_cast<unsigned char>(each)); });
    mix(attempt);
    return hash ^ (hash >> 32U);
}

/// The characters of a name that can be shown; a PLC may send any bytes.
std::string shown(std::string_view text)
{
    constexpr std::size_t enough = 128;
    std::string all;
    std::ranges::copy_if(text.substr(0, enough), std::back_inserter(all),
                         [](char each) { return each >= ' ' && each <= '~'; });
    return all;
}

} // namespace

const char* name_of(DeviceMode mode)
{
    static constexpr std::array<const char*, 4> names{"unknown", "RUN", "STOP", "PAUSE"};
    return names[static_cast<std::size_t>(mode)];
}

struct Device::Impl {
    Impl(DeviceConfig c, std::unique_ptr<DeviceProtocol> p, LogSink& l)
        : config{std::move(c)}, protocol{std::move(p)}, log{&l}, plan{protocol->plan()},
          plan_version{protocol->plan_version()}
    {
    }

    void send(TimePoint now);
    void take_answers(TimePoint now);
    void learn_rules(TimePoint now);
    void refuse(const DeviceAnswer& answer, TimePoint now);
    void step(TimePoint now);
    void end(std::string reason, TimePoint now);
    void tell(LogLevel level, const std::string& text)
    {
        log->write(level, "backend", config.name + ": " + text);
    }
    [[nodiscard]] Duration pause() const;
    [[nodiscard]] std::string identity_text() const;
    void changed()
    {
        if (on_change) {
            on_change();
        }
    }

    DeviceConfig config;
    std::unique_ptr<DeviceProtocol> protocol;
    LogSink* log;
    RequestPlan plan;
    std::uint64_t plan_version{0};
    std::unique_ptr<DeviceLine> line;
    DeviceState state{DeviceState::Waiting};
    std::string trouble{"not connected yet"};
    bool is_denied{false};
    /// Reasons that were told since the PLC last answered.
    std::vector<std::string> told;
    DeviceIdentity identity;
    std::string last_refusal;
    DeviceCounters counters;
    std::function<void()> on_change;
    std::function<void()> on_output;
    /// Waiting: when to connect. Connecting: when to give up.
    TimePoint until{TimePoint::min()};
    /// Failed attempts since the PLC last answered.
    std::uint64_t failures{0};
    /// The connection is there, and nothing can be sent within its time.
    bool is_late{false};
    /// The PLC has answered on this connection.
    bool has_answered{false};
    /// The log has the connection, or one before it without an answer.
    bool is_connection_told{false};
};

Duration Device::Impl::pause() const
{
    Duration whole = config.first_pause;
    for (std::uint64_t i = 1; i < failures && whole < config.longest_pause; ++i) {
        whole *= 2;
    }
    whole = std::min(whole, config.longest_pause);
    return whole -
           whole / 4 * static_cast<Duration::rep>(hash_of(config.name, failures) % 1'000) / 1'000;
}

std::string Device::Impl::identity_text() const
{
    std::string all;
    for (const std::string* const part :
         {&identity.vendor, &identity.product, &identity.revision}) {
        all += (all.empty() || part->empty() ? "" : " ") + *part;
    }
    return all;
}

void Device::Impl::send(TimePoint now)
{
    while (state == DeviceState::Online && !line->is_closed()) {
        const auto request = plan.next_request();
        if (!request) {
            return;
        }
        if (const auto sent = line->send(*request, now); !sent) {
            plan.refuse(request->id, sent.error(), now);
            ++counters.refusals;
        }
    }
}

/// The protocol knows more of its PLC.
void Device::Impl::learn_rules(TimePoint now)
{
    if (const auto version = protocol->plan_version();
        std::exchange(plan_version, version) != version) {
        const PlanConfig learned = protocol->plan();
        plan.change_rules(learned.rules, learned.max_under_way, now);
    }
}

void Device::Impl::refuse(const DeviceAnswer& answer, TimePoint now)
{
    ++counters.refusals;
    if (answer.code != 0) {
        last_refusal = protocol->text_of(answer.code);
    }
    plan.refuse(answer.request, answer.status, now, answer.code);
}

void Device::Impl::take_answers(TimePoint now)
{
    while (const auto answer = line->next_answer()) {
        learn_rules(now);
        if (answer->kind == DeviceAnswer::Kind::Failed) {
            ++counters.failures;
            plan.fail(answer->request, answer->status);
            continue;
        }
        ++counters.answers;
        counters.round_trip = answer->round_trip;
        counters.worst_round_trip = std::max(counters.worst_round_trip, answer->round_trip);
        if (answer->kind == DeviceAnswer::Kind::Refused) {
            refuse(*answer, now);
        } else if (answer->kind == DeviceAnswer::Kind::Unknown) {
            plan.plan_again(answer->request, now);
        } else {
            plan.answer(answer->request, answer->words, now);
        }
    }
}

void Device::Impl::step(TimePoint now)
{
    if (!line) {
        return;
    }
    take_answers(now);
    if (state == DeviceState::Connecting && line->is_ready()) {
        state = DeviceState::Online;
        ++counters.connections;
        trouble.clear();
        const DeviceIdentity said = line->identity();
        identity = {shown(said.vendor), shown(said.product), shown(said.revision), said.family};
        learn_rules(now);
        plan.forget_refusals();
        if (!std::exchange(is_connection_told, true)) {
            const std::string name = identity_text();
            const std::string where =
                config.host.empty() ? "" : " to " + config.host + ":" + std::to_string(config.port);
            tell(LogLevel::Info, "connected" + where + (name.empty() ? "" : ", " + name));
        }
    }
    if (line->has_answered() && !std::exchange(has_answered, true)) {
        failures = 0;
        told.clear();
    }
    send(now);
    changed();
}

void Device::Impl::end(std::string reason, TimePoint now)
{
    const bool was_online = state == DeviceState::Online;
    is_denied = line != nullptr && line->is_denied();
    if (is_denied) {
        reason += denied_text;
    }
    // A connection without an answer is one more attempt that failed.
    const bool had_answered = std::exchange(has_answered, false);
    is_connection_told = is_connection_told && !had_answered;
    line.reset();
    is_late = false;
    state = DeviceState::Waiting;
    ++failures;
    until = now + (is_denied ? std::max(pause(), denied_pause) : pause());
    plan.fail_all(status::Bad_NoCommunication);
    // The same reasons again and again are told once.
    const bool is_known = std::ranges::find(told, reason) != told.end();
    if (!is_known && told.size() < most_told) {
        told.push_back(reason);
    }
    if (had_answered || !is_known) {
        tell(LogLevel::Warning, (was_online ? "the connection ended: " : "no connection: ") +
                                    reason + "; its values have Bad_NoCommunication until then");
    }
    trouble = std::move(reason);
    changed();
}

Device::Device(DeviceConfig config, std::unique_ptr<DeviceProtocol> protocol, LogSink& log)
    : impl_{std::make_unique<Impl>(std::move(config), std::move(protocol), log)}
{
}

Device::~Device() = default;

const DeviceConfig& Device::config() const
{
    return impl_->config;
}

Result<std::uint64_t> Device::read(std::span<const PlanAddress> addresses, TimePoint now)
{
    if (impl_->state != DeviceState::Online) {
        return fail(status::Bad_NoCommunication);
    }
    auto batch = impl_->plan.read(addresses, now);
    impl_->send(now);
    if (impl_->on_output) {
        impl_->on_output();
    }
    return batch;
}

Result<std::uint64_t> Device::write(std::span<const PlanWrite> writes, TimePoint now)
{
    if (impl_->state != DeviceState::Online) {
        return fail(status::Bad_NoCommunication);
    }
    auto batch = impl_->plan.write(writes);
    impl_->send(now);
    if (impl_->on_output) {
        impl_->on_output();
    }
    return batch;
}

void Device::flush(TimePoint now)
{
    impl_->step(now);
    if (impl_->on_output) {
        impl_->on_output();
    }
}

std::optional<PlanResult> Device::next_result()
{
    return impl_->plan.next_result();
}

void Device::on_change(std::function<void()> handler)
{
    impl_->on_change = std::move(handler);
}

DeviceState Device::state() const
{
    return impl_->state;
}

const std::string& Device::trouble() const
{
    return impl_->trouble;
}

bool Device::is_denied() const
{
    return impl_->is_denied && impl_->state == DeviceState::Waiting;
}

const DeviceIdentity& Device::identity() const
{
    return impl_->identity;
}

std::string Device::identity_text() const
{
    return impl_->identity_text();
}

const DeviceProtocol& Device::protocol() const
{
    return *impl_->protocol;
}

const std::string& Device::last_refusal() const
{
    return impl_->last_refusal;
}

const DeviceCounters& Device::counters() const
{
    return impl_->counters;
}

const PlanCounters& Device::plan_counters() const
{
    return impl_->plan.counters();
}

void Device::on_output(std::function<void()> handler)
{
    impl_->on_output = std::move(handler);
}

bool Device::wants_connection(TimePoint now) const
{
    return impl_->state == DeviceState::Waiting && impl_->until <= now;
}

void Device::connecting(TimePoint now)
{
    impl_->state = DeviceState::Connecting;
    ++impl_->counters.attempts;
    impl_->until = now + impl_->config.connect_timeout;
}

void Device::connected(TimePoint now)
{
    impl_->line = impl_->protocol->connect(now);
    impl_->step(now);
}

void Device::lost(const std::string& reason, TimePoint now)
{
    if (impl_->state == DeviceState::Waiting) {
        return;
    }
    if (impl_->line) {
        impl_->take_answers(now);
    }
    std::string own = impl_->line ? impl_->line->reason() : std::string{};
    if (own.empty() && impl_->is_late) {
        own = "it has no answer to the first request";
    }
    impl_->end(own.empty() ? reason : own, now);
}

Result<void> Device::feed(std::span<const std::byte> in, TimePoint now)
{
    if (!impl_->line) {
        return fail(status::Bad_ConnectionClosed);
    }
    auto fed = impl_->line->feed(in, now);
    impl_->step(now);
    return fed;
}

std::span<const std::byte> Device::output() const
{
    return impl_->line ? impl_->line->output() : std::span<const std::byte>{};
}

void Device::consume(std::size_t size)
{
    if (impl_->line) {
        impl_->line->consume(size);
    }
}

TimePoint Device::next_deadline() const
{
    const TimePoint own = impl_->state == DeviceState::Online ? no_deadline : impl_->until;
    return impl_->line ? std::min(own, impl_->line->next_deadline()) : own;
}

void Device::handle_deadline(TimePoint now)
{
    if (!impl_->line) {
        return;
    }
    impl_->line->handle_deadline(now);
    impl_->step(now);
    impl_->is_late = impl_->state == DeviceState::Connecting && impl_->until <= now;
}

bool Device::is_closed() const
{
    return impl_->line && (impl_->is_late || impl_->line->is_closed());
}

} // namespace busbar::backend
