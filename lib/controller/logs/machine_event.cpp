#include <busbar/controller/machine_event.hpp>

#include <algorithm>
#include <array>

namespace busbar::controller {

namespace {

struct LevelRow {
    std::string_view name;
    std::uint16_t severity;
};

/// Rows in the order of EventLevel.
constexpr std::array level_rows{
    LevelRow{"Major fault", 1'000}, LevelRow{"Partial fault", 900}, LevelRow{"Minor fault", 700},
    LevelRow{"Observation", 400},   LevelRow{"Information", 100},
};

} // namespace

std::string_view name(EventLevel level)
{
    return level_rows[static_cast<std::size_t>(level)].name;
}

std::uint16_t severity_of(EventLevel level)
{
    return level_rows[static_cast<std::size_t>(level)].severity;
}

const MachineEventType* machine_event_type(std::uint32_t code)
{
    const std::span<const MachineEventType> types = machine_event_types();
    const auto found = std::find_if(types.begin(), types.end(),
                                    [&](const auto& each) { return each.code == code; });
    return found == types.end() ? nullptr : &*found;
}

std::string_view source_details(const MachineEventType& type)
{
    constexpr std::uint32_t first_fault = 1;
    constexpr std::uint32_t last_fault = 3;
    return type.code >= first_fault && type.code <= last_fault ? "CPU Unit"
                                                               : machine_event_source_details;
}

std::string code_text(const MachineEventType& type)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (int shift = 28; shift >= 0; shift -= 4) {
        text += digits[(type.code >> static_cast<unsigned>(shift)) & 15U];
    }
    return text;
}

std::string text(const MachineEvent& event)
{
    std::string result = code_text(*event.type) + " " + std::string{event.type->name};
    for (std::size_t i = 0; i < event.attached.size(); ++i) {
        result += (i == 0 ? ": " : ", ") + event.attached[i];
    }
    return result;
}

std::string what_to_do(const MachineEvent& event)
{
    const std::string_view correction = event.type->correction;
    return text(event) + (correction.empty() ? "" : ". ") + std::string{correction};
}

} // namespace busbar::controller
