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

/// The variables of data sources that are monitored and their intervals, and the part of that which
/// the sources know (see DataSource::monitoring_changed).
class MonitoredHandles {
public:
    /// Approximate memory of one item here.
    static constexpr std::size_t bytes_per_item = 256;

    /// The variable that one item monitors; none without a source.
    struct Use {
        std::uint32_t source{model::no_source};
        std::uint64_t handle{0};

        friend bool operator==(const Use&, const Use&) = default;
        friend bool operator<(const Use& a, const Use& b)
        {
            return a.source != b.source ? a.source < b.source : a.handle < b.handle;
        }
    };

    /// An item with this interval, which monitored `from`, monitors `to` from now on.
    void change(const Use& from, const Use& to, Duration interval);
    /// Reports to every source what has changed for it since the last time.
    void tell(DataSources& sources);

private:
    struct Hash {
        [[nodiscard]] std::size_t operator()(const Use& use) const
        {
            return static_cast<std::size_t>(use.handle * 31 + use.source);
        }
    };
    struct Entry {
        /// Number of items with each interval.
        std::map<Duration, std::uint32_t> items;
        std::optional<Duration> told;
        bool is_changed{false};
    };

    void add(const Use& use, Duration interval);
    void remove(const Use& use, Duration interval);
    void note_change(const Use& use, Entry& entry);

    std::unordered_map<Use, Entry, Hash> entries_;
    std::vector<Use> changed_;
};

} // namespace busbar::server::detail
