#include "live_ids.hpp"

#include <algorithm>
#include <utility>

namespace busbar::fuzz {

namespace {

using binary::DynamicArray;
using binary::DynamicValue;

constexpr std::size_t most = 8;

template <typename Id>
void keep(std::deque<Id>& ids, Id id)
{
    ids.push_front(std::move(id));
    ids.resize(std::min(ids.size(), most));
}

Variant bound(const Variant& value, const std::deque<std::uint32_t>& ids)
{
    const auto live = [&](std::uint32_t number) {
        return number < ids.size() ? ids[number] : number;
    };
    if (const auto* const one = value.get_if<std::uint32_t>()) {
        return Variant{live(*one)};
    }
    Array<std::uint32_t> all = *value.array_if<std::uint32_t>();
    std::transform(all.begin(), all.end(), all.begin(), live);
    return Variant{std::move(all)};
}

} // namespace

const LiveIds::Numbers* LiveIds::numbers_of(std::string_view field) const
{
    if (field == "SubscriptionId" || field == "SubscriptionIds") {
        return &subscriptions_;
    }
    const bool is_of_item = field == "MonitoredItemId" || field == "MonitoredItemIds" ||
                            field == "TriggeringItemId" || field == "LinksToAdd" ||
                            field == "LinksToRemove";
    return is_of_item ? &items_ : nullptr;
}

void LiveIds::bind(DynamicValue& request) const
{
    for (std::size_t i = 0; i < request.type().fields.size(); ++i) {
        const std::string_view name = request.type().fields[i].name;
        const Numbers* const numbers = numbers_of(name);
        if (const Variant* const found = numbers != nullptr ? request.value(i) : nullptr) {
            static_cast<void>(request.set(i, bound(*found, *numbers)));
        } else if (name == "ItemsToModify" || name == "SubscriptionAcknowledgements") {
            DynamicArray all = *request.structures(i);
            for (DynamicValue& each : all.values) {
                bind(each);
            }
            static_cast<void>(request.set(i, std::move(all)));
        }
    }
    bind_points(request);
}

void LiveIds::bind_points(DynamicValue& request) const
{
    const Variant* const all = request.value("ContinuationPoints");
    if (all == nullptr || continuation_points_.empty()) {
        return;
    }
    Array<ByteString> points = *all->array_if<ByteString>();
    for (ByteString& point : points) {
        if (point.size() == 1) {
            const auto number = std::to_integer<std::size_t>(point.span()[0]);
            point = continuation_points_[number % continuation_points_.size()];
        }
    }
    static_cast<void>(request.set("ContinuationPoints", Variant{std::move(points)}));
}

void LiveIds::learn(const DynamicValue& response)
{
    if (response.type().name == "CreateSubscriptionResponse") {
        keep(subscriptions_, *response.get_if<std::uint32_t>("SubscriptionId"));
    }
    const DynamicArray* const results = response.structures("Results");
    if (results == nullptr || results->values.empty()) {
        return;
    }
    if (results->values[0].type().name == "BrowseResult") {
        learn_points(*results);
    } else if (response.type().name == "CreateMonitoredItemsResponse") {
        learn_items(*results);
    }
}

void LiveIds::learn_items(const DynamicArray& results)
{
    for (const DynamicValue& result : results.values) {
        if (result.get_if<StatusCode>("StatusCode")->is_good()) {
            keep(items_, *result.get_if<std::uint32_t>("MonitoredItemId"));
        }
    }
}

void LiveIds::learn_points(const DynamicArray& results)
{
    for (const DynamicValue& result : results.values) {
        const auto* const point = result.get_if<ByteString>("ContinuationPoint");
        if (point != nullptr && point->size() != 0) {
            keep(continuation_points_, *point);
        }
    }
}

void LiveIds::clear()
{
    subscriptions_.clear();
    items_.clear();
    continuation_points_.clear();
}

} // namespace busbar::fuzz
