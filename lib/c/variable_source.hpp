#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include <busbar/busbar.h>
#include <busbar/core/clock.hpp>
#include <busbar/server/data_source.hpp>

#include "value.hpp"

namespace busbar::c {

/// The variables that are kept in memory, and those with callbacks of their own. Used on the
/// server's thread.
class VariableSource final : public server::DataSource {
public:
    /// One variable.
    struct Entry {
        NodeId id;
        std::string id_text;
        /// The value of a variable without callbacks.
        DataValue kept;
        busbar_read_callback read{nullptr};
        busbar_write_callback write{nullptr};
        void* context{nullptr};
        /// Counts how often the place was freed.
        std::uint32_t generation{0};
        bool is_used{true};
        /// The next place that is free, by its number from 1 on; 0: none.
        std::size_t next_free{0};
    };

    explicit VariableSource(const WallClock& clock) : clock_{&clock} {}

    /// Returns its handle: the number of its place, from 1 on, and the place's generation above
    /// that, so that the handle of a variable that was removed is not the next one's.
    [[nodiscard]] std::uint64_t add(Entry entry);
    /// Frees what the handle stands for, if it does for anything. Not within a callback.
    void remove(std::uint64_t handle) noexcept;
    /// Returns null for a handle that none has.
    [[nodiscard]] Entry* find(std::uint64_t handle);
    /// Returns null also for one with callbacks.
    [[nodiscard]] Entry* kept(std::uint64_t handle);
    /// Makes it the value from now on; a null time is now.
    void keep(Entry& entry, DataValue value) const;

    void read(server::ReadBatch batch) override;
    void write(server::WriteBatch batch) override;

private:
    void read_one(const Entry& entry, server::ReadSlot& slot) const;
    [[nodiscard]] StatusCode write_one(Entry& entry, const DataValue& value);

    const WallClock* clock_;
    /// Entries stay where they are: a callback may be running, and slots point at values.
    std::deque<Entry> entries_;
    Scratch scratch_;
    std::size_t first_free_{0};
};

} // namespace busbar::c
