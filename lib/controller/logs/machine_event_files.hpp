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
/// Nothing for a line of another form; without its end. The name may be missing.
[[nodiscard]] std::optional<MachineEvent> parse_machine_event(std::string_view line);

/// The last events in two files: one that grows, and the one before it, which goes when the new one
/// is full. One thread at a time; blocks on the storage.
class MachineEventFiles {
public:
    /// At least `max_entries` events are kept, at most twice as many.
    MachineEventFiles(Storage& storage, std::string folder, std::size_t max_entries);

    /// The last events, at most `max_entries`. Lines that are none are passed over.
    [[nodiscard]] Stored<std::deque<MachineEvent>> load();
    /// How many of the first ones were saved: at least one of what is not empty, or an error. After
    /// an error the same ones are to be saved again, but for those that nobody wants any more.
    [[nodiscard]] Stored<std::size_t> save(std::span<const MachineEvent> events);

private:
    [[nodiscard]] Stored<void> read_into(std::deque<MachineEvent>& events, const std::string& name);
    [[nodiscard]] Stored<void> make_room();

    Storage* storage_;
    std::string folder_;
    std::string before_; // the name of the file before
    std::size_t max_entries_;
    LineFile file_;
};

} // namespace busbar::controller::detail
