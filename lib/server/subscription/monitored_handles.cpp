#include "monitored_handles.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/server/data_source.hpp>

#include "server/data/data_sources.hpp"

namespace busbar::server::detail {

void MonitoredHandles::change(const Use& from, const Use& to, Duration interval)
{
    if (from == to) {
        return;
    }
    add(to, interval);
    remove(from, interval);
}

void MonitoredHandles::add(const Use& use, Duration interval)
{
    if (use.source == model::no_source) {
        return;
    }
    if (changed_.capacity() <= entries_.size()) { // so that recording a change needs no memory
        changed_.reserve(2 * entries_.size() + 8);
    }
    const auto made = entries_.try_emplace(use);
    busbar::detail::Undo undo{[&] {
        if (made.second) {
            entries_.erase(made.first);
        }
    }};
    Entry& entry = made.first->second;
    ++entry.items[interval];
    note_change(use, entry);
    undo.keep();
}

void MonitoredHandles::remove(const Use& use, Duration interval)
{
    if (use.source == model::no_source) {
        return;
    }
    Entry& entry = entries_.find(use)->second;
    const auto items = entry.items.find(interval);
    if (--items->second == 0) {
        entry.items.erase(items);
    }
    note_change(use, entry);
}

void MonitoredHandles::note_change(const Use& use, Entry& entry)
{
    if (!std::exchange(entry.is_changed, true)) {
        changed_.push_back(use);
    }
}

void MonitoredHandles::tell(DataSources& sources)
{
    if (changed_.empty()) {
        return;
    }
    std::vector<Use> changed = changed_;
    std::vector<Monitoring> batch;
    batch.reserve(changed.size());
    changed_.clear(); // from here on nothing can fail
    std::sort(changed.begin(), changed.end());
    for (std::size_t i = 0; i < changed.size(); ++i) {
        const auto found = entries_.find(changed[i]);
        Entry& entry = found->second;
        entry.is_changed = false;
        const std::optional<Duration> now =
            entry.items.empty() ? std::nullopt : std::optional{entry.items.begin()->first};
        if (std::exchange(entry.told, now) != now) {
            batch.push_back({changed[i].handle, now});
        }
        if (!now) {
            entries_.erase(found);
        }
        const bool is_last = i + 1 == changed.size() || changed[i + 1].source != changed[i].source;
        if (is_last && !batch.empty()) {
            (*sources.find(changed[i].source))
                ->guard("DataSource::monitoring_changed",
                        [&](DataSource& source) { source.monitoring_changed(batch); });
            batch.clear();
        }
    }
}

} // namespace busbar::server::detail
