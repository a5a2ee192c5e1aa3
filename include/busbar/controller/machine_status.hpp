#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::controller {

/// Seed 000, 4-2-4.
enum class OperatingStatus : std::uint8_t {
    NotStarted, // not used when power came, or no power came yet
    Initializing,
    Preparing, // also while a download, a restore or a clearing is at work (seed 000, 9-3)
    Running,
    HaltError,
    Shutdown, // done, or on the way
};

/// Who is let in: in Halt error and after a shutdown, those who can mend it.
enum class ServedClients : std::uint8_t { None, Administrators, All };

/// "Halt error"; "---" for NotStarted.
[[nodiscard]] BUSBAR_API std::string_view text(OperatingStatus status);

struct ConnectionCounts {
    std::size_t clients{0};
    std::size_t users{0};
};

/// Seed 000, 4-2-1.
struct MachineStatus {
    bool is_used{false};
    OperatingStatus operating{OperatingStatus::NotStarted};
    /// Counts in Running only.
    std::string end_point{};
    ConnectionCounts connected{};
};

/// One line of a status: "Number of connected clients", "3".
struct StatusLine {
    std::string_view name;
    std::string value;
};

/// The five items in the order of the table, "---" where it has that.
[[nodiscard]] BUSBAR_API std::array<StatusLine, 5> status_lines(const MachineStatus& status);

} // namespace busbar::controller
