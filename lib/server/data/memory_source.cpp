#include <busbar/server/memory_source.hpp>

#include <busbar/model/new_node.hpp>

#include "core/fetch.hpp"

namespace busbar::server {

std::uint64_t MemorySource::add(Variant value)
{
    values_.emplace_back(std::move(value), StatusCode{}, clock_->now());
    return values_.size() - 1;
}

model::BoundValue MemorySource::variable(Variant value)
{
    const std::uint64_t handle = add(std::move(value));
    return variable(handle, get(handle).value);
}

void MemorySource::set(std::uint64_t handle, Variant value, StatusCode status, DateTime time)
{
    values_[static_cast<std::size_t>(handle)] = {std::move(value), status,
                                                 time.is_null() ? clock_->now() : time};
}

DataSourceOptions MemorySource::options() const
{
    DataSourceOptions options;
    // The server cuts ranges out of the shared value.
    options.writes_ranges = true;
    return options;
}

void MemorySource::read(ReadBatch batch)
{
    const auto items = batch.items();
    const auto slots = batch.results();
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (const std::size_t next = i + busbar::detail::fetched_ahead;
            next < items.size() && items[next].handle < values_.size()) {
            busbar::detail::fetch(&get(items[next].handle));
        }
        if (items[i].handle >= values_.size()) {
            slots[i].status = status::Bad_NodeIdUnknown;
            continue;
        }
        const DataValue& from = get(items[i].handle);
        slots[i].status = from.status;
        slots[i].source_timestamp = from.source_timestamp;
        // `values_` cannot change before the server has used the slots of a batch that completes
        // inline, so not even an array needs a copy.
        slots[i].shared = &from.value;
    }
    batch.complete();
}

void MemorySource::write(WriteBatch batch)
{
    const auto items = batch.items();
    const auto results = batch.results();
    const DateTime now = clock_->now();
    for (std::size_t i = 0; i < items.size(); ++i) {
        results[i] = write_one(items[i], now);
    }
    batch.complete();
}

StatusCode MemorySource::write_one(const WriteItem& item, DateTime now)
{
    if (item.handle >= values_.size()) {
        return status::Bad_NodeIdUnknown;
    }
    DataValue& to = values_[static_cast<std::size_t>(item.handle)];
    if (item.range == nullptr) {
        to.value = item.data->value;
    } else if (const auto written = write_range(to.value, *item.range, item.data->value);
               !written) {
        return written.error();
    }
    to.status = item.data->status;
    to.source_timestamp = item.data->source_timestamp.is_null() ? now : item.data->source_timestamp;
    return status::Good;
}

} // namespace busbar::server
