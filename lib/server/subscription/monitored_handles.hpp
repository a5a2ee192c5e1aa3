#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/model/node.hpp>

namespace busbar::server::detail {

class DataSources;

/// Which variables of which data sources are monitored and how often, and what of that the sources
/// know (see DataSource::monitoring_changed).
class MonitoredHandles {
public:
    /// About what one item takes here.
    static constexpr std::size_t bytes_per_item = 256;

    /// What one item monitors; nothing, without a source.
    struct Use {
        std::uint32_t source{model::no_source};
        std::uint64_t handle{0};
        Duration interval{0};

        friend bool operator==(const Use&, const Use&) = default;
    };

    /// The item whose use this is monitors `next` from now on.
    void change(Use& use, const Use& next);
    /// Tells every source what has changed for it since the last time.
    void tell(DataSources& sources);

private:
    struct Key {
        std::uint32_t source;
        std::uint64_t handle;

        friend bool operator==(const Key&, const Key&) = default;
        friend bool operator<(const Key& a, const Key& b)
        {
            return a.source != b.source ? a.source < b.source : a.handle < b.handle;
        }
    };
    struct Hash {
        [[nodiscard]] std::size_t operator()(const Key& key) const
        {
            return static_cast<std::size_t>(key.handle * 31 + key.source);
        }
    };
    struct Entry {
        /// How many items have each interval.
        std::map<Duration, std::uint32_t> items;
        std::optional<Duration> told;
        bool is_changed{false};
    };

    void add(const Use& use);
    void remove(const Use& use);
    void note_change(const Key& key, Entry& entry);

    std::unordered_map<Key, Entry, Hash> entries_;
    std::vector<Key> changed_;
};

} // namespace busbar::server::detail
