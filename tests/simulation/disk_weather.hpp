#pragma once

#include <cstdint>

#include <busbar/storage/memory_storage.hpp>

#include "harness_names.hpp"
#include "trace.hpp"

namespace busbar::test {

/// A medium that now and then, for up to some minutes, has no room, cannot be written, is away, or
/// fails here and there in the middle of something.
class DiskWeather {
public:
    /// `number` is the medium's in the trace.
    DiskWeather(Scheduler& scheduler, Trace& trace, storage::MemoryStorage& medium,
                std::uint64_t number, Chance chance);

    void start();
    /// Ends a spell, too.
    void stop();

    /// Spells in which there was no room.
    [[nodiscard]] std::size_t full_spells() const { return full_spells_; }

private:
    enum class Kind : std::uint8_t { Good, Full, Protected, Away, Failing };

    void change();
    void begin();
    void end();
    void fill();
    void fail();

    Trace* trace_;
    storage::MemoryStorage* medium_;
    std::uint64_t number_;
    Chance chance_;
    Kind kind_{Kind::Good};
    std::size_t full_spells_{0};
    Alarm change_;
    Alarm fail_;
};

} // namespace busbar::test
