#include <busbar/backend/device_source.hpp>

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include <busbar/core/status_codes.hpp>

namespace busbar::backend {

namespace {

double milliseconds_of(Duration time)
{
    return std::chrono::duration<double, std::milli>(time).count();
}

} // namespace

const char* name_of(DeviceFact fact)
{
    static constexpr const char* names[device_facts] = {
        "State",    "Trouble",  "Identity",       "Vendor",         "Product",  "Revision",
        "Family",   "Mode",     "ConnectedSince", "Connections",    "Requests", "Answers",
        "Refusals", "Failures", "RoundTrip",      "WorstRoundTrip", "ReadTime", "LastRefusal"};
    return names[static_cast<std::size_t>(fact)];
}

struct DeviceSource::Impl {
    /// A batch of the server, and the items in it whose addresses are those of the plan's batch, in
    /// the same order.
    struct Waiting {
        std::variant<server::ReadBatch, server::WriteBatch> batch;
        std::vector<std::size_t> items;
        TimePoint begun;
        /// The plan's batch ends with the PLC's mode.
        bool has_mode{false};
    };
    /// The last value of a point, with the time of its last change as far as it is known; null
    /// until there is one.
    struct Last {
        DataValue value;
        TimePoint read{};
        bool is_known{false};
        /// It was read, and nothing has been written or has failed since.
        bool is_fresh{false};
        /// The bad status that it has, Good if it has none, and since when.
        StatusCode failure{};
        DateTime failed{};

        /// Takes what was read at `time`. The time of a value that stays is that of its last
        /// change, and that of a bad status when it was found (Part 4, 7.11.3).
        void take(Variant read_value, StatusCode status, DateTime time)
        {
            if (!is_known || failure.is_bad() || value.status != status ||
                value.value != read_value) {
                value.source_timestamp = time;
            }
            value.value = std::move(read_value);
            value.status = status;
            is_known = is_fresh = true;
            failure = {};
        }
        void fail(StatusCode status, DateTime time)
        {
            is_fresh = false;
            if (failure != status) {
                failure = status;
                failed = time;
            }
        }
    };

    Impl(DeviceSource& o, Device& d, std::vector<DevicePoint> p, const WallClock& c,
         TimePoint (*n)(), DeviceSourceOptions s)
        : owner{&o}, device{&d}, points{std::move(p)}, clock{&c}, now{n}, options{s},
          last(points.size())
    {
    }

    [[nodiscard]] bool is_young(const server::ReadBatch& batch) const;
    void answer_at_once(server::ReadBatch& batch) const;
    void answer(const server::ReadItem& item, server::ReadSlot& slot) const;
    void answer_away(std::size_t point, StatusCode status, server::ReadSlot& slot);
    void take_mode(const Waiting& waiting, const PlanResult& result);
    [[nodiscard]] bool is_stopped() const
    {
        return mode == DeviceMode::Stop || mode == DeviceMode::Pause;
    }
    void finish(const PlanResult& result);
    void finish(server::ReadBatch& batch, const Waiting& waiting, const PlanResult& result);
    void finish(server::WriteBatch& batch, const Waiting& waiting, const PlanResult& result);
    void look();

    DeviceSource* owner;
    Device* device;
    std::vector<DevicePoint> points;
    const WallClock* clock;
    TimePoint (*now)();
    DeviceSourceOptions options;
    std::vector<Last> last;
    std::unordered_map<std::uint64_t, Waiting> waiting;
    DateTime connected_since{};
    Duration read_time{0};
    DeviceMode mode{DeviceMode::Unknown};
};

/// Part 4, 5.11.2.2: a maxAge of 0 asks for a new value.
bool DeviceSource::Impl::is_young(const server::ReadBatch& batch) const
{
    if (batch.is_sample() || batch.max_age() == std::chrono::milliseconds{0} ||
        device->state() != DeviceState::Online) {
        return false;
    }
    const TimePoint oldest = now() - batch.max_age();
    return std::ranges::all_of(batch.items(), [&](const server::ReadItem& item) {
        const auto point = static_cast<std::size_t>(item.handle);
        return item.handle >= points.size() || (last[point].is_fresh && last[point].read >= oldest);
    });
}

void DeviceSource::Impl::answer(const server::ReadItem& item, server::ReadSlot& slot) const
{
    const auto fact = item.handle - first_fact;
    if (item.handle < points.size()) {
        slot = DataValue{last[static_cast<std::size_t>(item.handle)].value};
    } else if (item.handle >= first_fact && fact < device_facts) {
        slot = DataValue{owner->fact(static_cast<DeviceFact>(fact))};
        slot.source_timestamp = clock->now();
    } else {
        slot = DataValue{status::Bad_NodeIdUnknown};
    }
}

void DeviceSource::Impl::answer_away(std::size_t point, StatusCode status, server::ReadSlot& slot)
{
    Last& before = last[point];
    before.fail(status, clock->now());
    if (before.is_known && options.when_away == WhenAway::LastValue &&
        status == StatusCode{status::Bad_NoCommunication}) {
        slot = DataValue{before.value};
        slot.status = status::Uncertain_NoCommunicationLastUsableValue;
        return;
    }
    slot = DataValue{status};
    slot.source_timestamp = before.failed;
}

void DeviceSource::Impl::take_mode(const Waiting& waiting, const PlanResult& result)
{
    if (waiting.has_mode) {
        const PlanValue& read = result.values.back();
        mode = read.status.is_bad() ? DeviceMode::Unknown
                                    : device->protocol().mode_of(result.words_of(read));
    }
}

void DeviceSource::Impl::finish(server::ReadBatch& batch, const Waiting& waiting,
                                const PlanResult& result)
{
    take_mode(waiting, result);
    const DateTime time = clock->now();
    const TimePoint moment = now();
    const StatusCode status = is_stopped() && options.when_stopped == WhenStopped::Uncertain
                                  ? StatusCode{status::Uncertain_LastUsableValue}
                                  : StatusCode{};
    if (batch.is_sample()) {
        read_time = moment - waiting.begun;
    }
    const auto slots = batch.results();
    for (std::size_t i = 0; i < waiting.items.size(); ++i) {
        server::ReadSlot& slot = slots[waiting.items[i]];
        const server::ReadItem& item = batch.items()[waiting.items[i]];
        if (item.handle >= points.size()) {
            answer(item, slot); // the mode itself
            continue;
        }
        const auto point = static_cast<std::size_t>(item.handle);
        const PlanValue& read = result.values[i];
        auto value = read.status.is_bad() ? Result<Variant>{fail(read.status)}
                                          : read_point(points[point], result.words_of(read));
        Last& now_last = last[point];
        if (!value) {
            answer_away(point, value.error(), slot);
            continue;
        }
        if (is_stopped() && options.when_stopped == WhenStopped::Bad) {
            answer_away(point, status::Bad_OutOfService, slot);
            continue;
        }
        now_last.take(*std::move(value), status, time);
        now_last.read = moment;
        slot = DataValue{now_last.value};
    }
    batch.complete();
}

void DeviceSource::Impl::finish(server::WriteBatch& batch, const Waiting& waiting,
                                const PlanResult& result)
{
    const auto statuses = batch.results();
    for (std::size_t i = 0; i < waiting.items.size(); ++i) {
        statuses[waiting.items[i]] = result.values[i].status;
        const server::WriteItem& item = batch.items()[waiting.items[i]];
        Last& before = last[static_cast<std::size_t>(item.handle)];
        // What was read before is not the value any more. What was written is, until it is read:
        // the PLC's program may make another one of it.
        before.is_fresh = false;
        if (result.values[i].status.is_good()) {
            before.value = DataValue{item.data->value};
            before.value.source_timestamp = clock->now();
            before.is_known = true;
        }
    }
    batch.complete();
}

void DeviceSource::Impl::finish(const PlanResult& result)
{
    const auto found = waiting.find(result.batch);
    if (found == waiting.end()) {
        return;
    }
    Waiting done = std::move(found->second);
    waiting.erase(found);
    std::visit([&](auto& batch) { finish(batch, done, result); }, done.batch);
}

void DeviceSource::Impl::look()
{
    const bool is_online = device->state() == DeviceState::Online;
    if (is_online && connected_since == DateTime{}) {
        connected_since = clock->now();
    } else if (!is_online) {
        connected_since = {};
        mode = DeviceMode::Unknown;
    }
    while (const auto result = device->next_result()) {
        finish(*result);
    }
}

DeviceSource::DeviceSource(Device& device, std::vector<DevicePoint> points, const WallClock& clock,
                           TimePoint (*now)(), DeviceSourceOptions options)
    : impl_{std::make_unique<Impl>(*this, device, std::move(points), clock, now, options)}
{
    device.on_change([impl = impl_.get()] { impl->look(); });
}

DeviceSource::~DeviceSource()
{
    impl_->device->on_change({});
}

std::span<const DevicePoint> DeviceSource::points() const
{
    return impl_->points;
}

Variant DeviceSource::fact(DeviceFact fact) const
{
    const Device& device = *impl_->device;
    const DeviceCounters& counters = device.counters();
    switch (fact) {
    case DeviceFact::State:
        return Variant{static_cast<std::uint32_t>(device.state())};
    case DeviceFact::Trouble:
        return Variant{String{device.trouble()}};
    case DeviceFact::Identity:
        return Variant{String{device.identity_text()}};
    case DeviceFact::Vendor:
        return Variant{String{device.identity().vendor}};
    case DeviceFact::Product:
        return Variant{String{device.identity().product}};
    case DeviceFact::Revision:
        return Variant{String{device.identity().revision}};
    case DeviceFact::Family:
        return Variant{String{device.identity().family}};
    case DeviceFact::Mode:
        return Variant{static_cast<std::uint32_t>(impl_->mode)};
    case DeviceFact::ConnectedSince:
        return Variant{impl_->connected_since};
    case DeviceFact::Connections:
        return Variant{counters.connections};
    case DeviceFact::Requests:
        return Variant{device.plan_counters().requests};
    case DeviceFact::Answers:
        return Variant{counters.answers};
    case DeviceFact::Refusals:
        return Variant{counters.refusals};
    case DeviceFact::Failures:
        return Variant{counters.failures};
    case DeviceFact::RoundTrip:
        return Variant{milliseconds_of(counters.round_trip)};
    case DeviceFact::WorstRoundTrip:
        return Variant{milliseconds_of(counters.worst_round_trip)};
    case DeviceFact::ReadTime:
        return Variant{milliseconds_of(impl_->read_time)};
    case DeviceFact::LastRefusal:
        return Variant{String{device.last_refusal()}};
    }
    return {};
}

server::DataSourceOptions DeviceSource::options() const
{
    return {.timeout = impl_->options.timeout};
}

void DeviceSource::read(server::ReadBatch batch)
{
    Impl& impl = *impl_;
    const auto slots = batch.results();
    const auto items = batch.items();
    std::vector<PlanAddress> addresses;
    Impl::Waiting waiting{std::move(batch), {}, impl.now()};
    auto& kept = std::get<server::ReadBatch>(waiting.batch);
    const bool is_young = impl.is_young(kept);
    const auto mode_place = impl.device->protocol().mode_place();
    for (std::size_t i = 0; i < items.size(); ++i) {
        const bool is_mode = items[i].handle == status_handle(DeviceFact::Mode) && mode_place;
        if (!is_mode && (is_young || items[i].handle >= impl.points.size())) {
            impl.answer(items[i], slots[i]);
            continue;
        }
        waiting.items.push_back(i);
        addresses.push_back(
            is_mode ? *mode_place : impl.points[static_cast<std::size_t>(items[i].handle)].address);
    }
    if (addresses.empty()) {
        kept.complete();
        return;
    }
    waiting.has_mode = mode_place.has_value();
    if (mode_place) {
        addresses.push_back(*mode_place);
    }
    const auto begun = impl.device->read(addresses, waiting.begun);
    if (!begun) {
        for (const std::size_t i : waiting.items) {
            if (items[i].handle >= impl.points.size()) {
                impl.answer(items[i], slots[i]);
                continue;
            }
            impl.answer_away(static_cast<std::size_t>(items[i].handle), begun.error(), slots[i]);
        }
        kept.complete();
        return;
    }
    impl.waiting.emplace(*begun, std::move(waiting));
    impl.look();
}

void DeviceSource::write(server::WriteBatch batch)
{
    Impl& impl = *impl_;
    std::vector<PlanWrite> writes;
    std::vector<std::vector<std::uint16_t>> words;
    Impl::Waiting waiting{std::move(batch), {}, impl.now()};
    auto& kept = std::get<server::WriteBatch>(waiting.batch);
    const auto items = kept.items();
    const auto statuses = kept.results();
    words.reserve(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (items[i].handle >= impl.points.size() ||
            !impl.points[static_cast<std::size_t>(items[i].handle)].is_writable) {
            statuses[i] = status::Bad_NotWritable;
            continue;
        }
        const DevicePoint& point = impl.points[static_cast<std::size_t>(items[i].handle)];
        auto& raw = words.emplace_back(
            point.type.type == ModbusType::Bool ? std::size_t{1} : registers_of(point.type));
        const auto mask = write_point(point, items[i].data->value, raw);
        if (!mask) {
            statuses[i] = mask.error();
            continue;
        }
        waiting.items.push_back(i);
        writes.push_back({point.address, raw, *mask});
    }
    const auto begun = writes.empty() ? Result<std::uint64_t>{fail(status::Bad_NothingToDo)}
                                      : impl.device->write(writes, waiting.begun);
    if (!begun) {
        for (const std::size_t i : waiting.items) {
            statuses[i] = begun.error();
        }
        kept.complete();
        return;
    }
    impl.waiting.emplace(*begun, std::move(waiting));
    impl.look();
}

} // namespace busbar::backend
