#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::controller {

/// See W588, 4-2-4.
enum class OperatingStatus : std::uint8_t {
    NotStarted, // not used at power-on, or no power-on yet
    Initializing,
    Preparing, // also while a download, a restore or a clearing runs (manual of variables mode,
               // 9-3)
    Running,
    HaltError,
    Shutdown, // completed, or in progress
};

/// The clients that may connect: in Halt error and after a shutdown, those that can correct it.
enum class ServedClients : std::uint8_t { None, Administrators, All };

/// Returns "Halt error", for example; "---" for NotStarted.
[[nodiscard]] BUSBAR_API std::string_view text(OperatingStatus status);

/// The numbers of connected clients and of users who have logged in.
struct ConnectionCounts {
    std::size_t clients{0};
    std::size_t users{0};
};

/// See W588, 4-2-1.
struct MachineStatus {
    bool is_used{false};
    OperatingStatus operating{OperatingStatus::NotStarted};
    /// Used in Running only.
    std::string end_point{};
    ConnectionCounts connected{};
};

/// One line of a status: "Number of connected clients", "3".
struct StatusLine {
    std::string_view name;
    std::string value;
};

/// Returns the five items in the order of the table, with "---" where it has that.
[[nodiscard]] BUSBAR_API std::array<StatusLine, 5> status_lines(const MachineStatus& status);

} // namespace busbar::controller
