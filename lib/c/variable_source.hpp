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
    };

    explicit VariableSource(const WallClock& clock) : clock_{&clock} {}

    /// Returns its handle, from 1 on.
    [[nodiscard]] std::uint64_t add(Entry entry);
    /// Removes the last one that was added.
    void remove_last() { entries_.pop_back(); }
    /// Returns null for a handle that none has, or one with callbacks.
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
};

} // namespace busbar::c
