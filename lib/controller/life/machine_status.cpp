#include <busbar/controller/machine_status.hpp>

namespace busbar::controller {

namespace {

constexpr std::string_view not_shown = "---";

} // namespace

std::string_view text(OperatingStatus status)
{
    constexpr std::array<std::string_view, 6> texts{not_shown, "Initializing", "Preparing",
                                                    "Running", "Halt error",   "Shutdown"};
    static_assert(texts.size() == static_cast<std::size_t>(OperatingStatus::Shutdown) + 1);
    return texts[static_cast<std::size_t>(status)];
}

std::array<StatusLine, 5> status_lines(const MachineStatus& status)
{
    const bool is_running = status.operating == OperatingStatus::Running;
    const bool is_counted = status.operating != OperatingStatus::Initializing;
    return {StatusLine{"OPC UA Server", status.is_used ? "Use" : "Do not use"},
            StatusLine{"Server operating status", std::string{text(status.operating)}},
            StatusLine{"End point", is_running ? status.end_point : std::string{not_shown}},
            StatusLine{"Number of connected clients", is_counted
                                                          ? std::to_string(status.connected.clients)
                                                          : std::string{not_shown}},
            StatusLine{"Number of connected users", std::to_string(status.connected.users)}};
}

} // namespace busbar::controller
