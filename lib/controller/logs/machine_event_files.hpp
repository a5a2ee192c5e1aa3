#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/machine_event.hpp>
#include <busbar/core/storage.hpp>

#include "line_file.hpp"

namespace busbar::controller::detail {

/// "12<tab>2017-10-17T14:52:50.747Z<tab>35D30000<tab>Observation<tab>Too Many Public Variables",
/// what is attached, and the line end.
[[nodiscard]] std::string machine_event_line(const MachineEvent& event);
/// Parses a line without its end; nothing for a line of another form. The name may be missing.
[[nodiscard]] std::optional<MachineEvent> parse_machine_event(std::string_view line);

/// Keeps the last events in two files: one that grows and its predecessor, which is removed when
/// the new one is full. Not thread-safe; blocks on the storage.
class MachineEventFiles {
public:
    /// Keeps at least `max_entries` events and at most twice as many.
    MachineEventFiles(Storage& storage, std::string folder, std::size_t max_entries);

    /// Reads the last events, at most `max_entries`; ignores lines that are not events.
    [[nodiscard]] Stored<std::deque<MachineEvent>> load();
    /// Saves the first of `events` and returns their number, which is at least one unless there are
    /// none. After an error the same events must be saved again, except those that are no longer
    /// wanted.
    [[nodiscard]] Stored<std::size_t> save(std::span<const MachineEvent> events);

private:
    [[nodiscard]] Stored<void> read_into(std::deque<MachineEvent>& events, const std::string& name);
    [[nodiscard]] Stored<void> make_room();

    Storage* storage_;
    std::string folder_;
    std::string before_; // name of the predecessor
    std::size_t max_entries_;
    LineFile file_;
};

} // namespace busbar::controller::detail
