#include "item_table.hpp"

#include <busbar/types/filter.hpp>

namespace busbar::client::detail {

namespace {

constexpr std::uint32_t index_bits = 22;
constexpr std::uint32_t index_mask = (std::uint32_t{1} << index_bits) - 1;
constexpr std::uint16_t last_generation = (1U << (32 - index_bits)) - 1;

bool asks_for_events(const ItemSettings& settings)
{
    return settings.filter.get_if<EventFilter>() != nullptr;
}

AttributeId watched_attribute(const ItemSettings& settings)
{
    return asks_for_events(settings) ? AttributeId::EventNotifier : settings.attribute;
}

} // namespace

ItemParameters::ItemParameters(const ItemSettings& settings)
    : attribute{watched_attribute(settings)}, timestamps{settings.timestamps},
      discard_oldest{settings.discard_oldest}, queue_size{settings.queue_size},
      sampling_interval{settings.sampling_interval.count()},
      index_range{settings.index_range}, filter{settings.filter}
{
}

bool ItemParameters::are_those_of(const ItemSettings& settings) const
{
    return attribute == watched_attribute(settings) && timestamps == settings.timestamps &&
           discard_oldest == settings.discard_oldest && queue_size == settings.queue_size &&
           sampling_interval == settings.sampling_interval.count() &&
           index_range == settings.index_range && filter == settings.filter;
}

bool ItemParameters::has_events() const
{
    return attribute == AttributeId::EventNotifier;
}

bool ItemParameters::is_readable() const
{
    return !has_events() && (filter.is_null() || filter.get_if<DataChangeFilter>() != nullptr);
}

MonitoringParameters ItemParameters::for_server(ItemHandle item) const
{
    MonitoringParameters result;
    result.client_handle = item;
    result.sampling_interval = sampling_interval;
    result.filter = filter;
    result.queue_size = queue_size;
    result.discard_oldest = discard_oldest;
    return result;
}

ItemHandle ItemTable::add(Item item)
{
    std::uint32_t index = static_cast<std::uint32_t>(items_.size());
    if (!free_.empty()) {
        index = free_.back();
        free_.pop_back();
    } else if (items_.size() == capacity) {
        return 0;
    } else {
        if (free_.capacity() == items_.size()) { // so that remove() needs no memory
            free_.reserve(2 * items_.size() + 16);
        }
        items_.emplace_back();
    }
    item.generation = items_[index].generation;
    items_[index] = std::move(item);
    return std::uint32_t{items_[index].generation} << index_bits | index;
}

Item* ItemTable::find(ItemHandle handle)
{
    const std::uint32_t index = handle & index_mask;
    if (index >= items_.size()) {
        return nullptr;
    }
    Item& item = items_[index];
    return item.subscription != 0 && item.generation == handle >> index_bits ? &item : nullptr;
}

void ItemTable::remove(ItemHandle handle)
{
    Item* item = find(handle);
    if (item == nullptr) {
        return;
    }
    const auto used = item->generation;
    *item = Item{};
    item->generation =
        used == last_generation ? std::uint16_t{1} : static_cast<std::uint16_t>(used + 1);
    free_.push_back(handle & index_mask);
}

} // namespace busbar::client::detail
