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
        "State",   "Trouble",  "Identity", "ConnectedSince", "Connections",    "Requests",
        "Answers", "Refusals", "Failures", "RoundTrip",      "WorstRoundTrip", "ReadTime"};
    return names[static_cast<std::size_t>(fact)];
}

struct DeviceSource::Impl {
    /// A batch of the server, and the items in it whose addresses are those of the plan's batch, in
    /// the same order.
    struct Waiting {
        std::variant<server::ReadBatch, server::WriteBatch> batch;
        std::vector<std::size_t> items;
        TimePoint begun;
    };
    /// The last value of a point; its time is null until there is one.
    struct Last {
        DataValue value;
        TimePoint read{};
        bool is_known{false};
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
    void answer_away(std::size_t point, StatusCode status, server::ReadSlot& slot) const;
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
        return item.handle >= points.size() || (last[point].is_known && last[point].read >= oldest);
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

void DeviceSource::Impl::answer_away(std::size_t point, StatusCode status,
                                     server::ReadSlot& slot) const
{
    const Last& before = last[point];
    if (before.is_known && options.when_away == WhenAway::LastValue &&
        status == StatusCode{status::Bad_NoCommunication}) {
        slot = DataValue{before.value};
        slot.status = status::Uncertain_NoCommunicationLastUsableValue;
        return;
    }
    slot = DataValue{status};
    slot.source_timestamp = before.value.source_timestamp;
}

void DeviceSource::Impl::finish(server::ReadBatch& batch, const Waiting& waiting,
                                const PlanResult& result)
{
    const DateTime time = clock->now();
    const TimePoint moment = now();
    if (batch.is_sample()) {
        read_time = moment - waiting.begun;
    }
    const auto slots = batch.results();
    for (std::size_t i = 0; i < waiting.items.size(); ++i) {
        server::ReadSlot& slot = slots[waiting.items[i]];
        const auto point = static_cast<std::size_t>(batch.items()[waiting.items[i]].handle);
        const PlanValue& read = result.values[i];
        auto value = read.status.is_bad() ? Result<Variant>{fail(read.status)}
                                          : read_point(points[point], result.words_of(read));
        if (!value) {
            answer_away(point, value.error(), slot);
            continue;
        }
        Last& now_last = last[point];
        now_last.value = DataValue{*std::move(value)};
        now_last.value.source_timestamp = time;
        now_last.read = moment;
        now_last.is_known = true;
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
        // What was read before is not the value any more.
        last[static_cast<std::size_t>(batch.items()[waiting.items[i]].handle)].is_known = false;
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
        return Variant{String{device.identity()}};
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
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (is_young || items[i].handle >= impl.points.size()) {
            impl.answer(items[i], slots[i]);
            continue;
        }
        waiting.items.push_back(i);
        addresses.push_back(impl.points[static_cast<std::size_t>(items[i].handle)].address);
    }
    if (addresses.empty()) {
        kept.complete();
        return;
    }
    const auto begun = impl.device->read(addresses, waiting.begun);
    if (!begun) {
        for (const std::size_t i : waiting.items) {
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
