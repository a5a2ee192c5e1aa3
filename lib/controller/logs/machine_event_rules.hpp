#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <busbar/controller/machine_event_log.hpp>

#include "once_per_certificate.hpp"

namespace busbar::controller::detail {

/// Decides which events a record causes, and which errors are present afterwards (W588, 9-2-2).
/// Starts without errors, like a controller. Not thread-safe; does not block.
class MachineEventRules {
public:
    explicit MachineEventRules(std::vector<EventLevelChoice> levels) : levels_{std::move(levels)} {}

    [[nodiscard]] static bool wants(RecordKind kind);

    /// Returns the events without numbers; none for an error that is already reported.
    [[nodiscard]] std::vector<MachineEvent> take(const Record& record, DateTime now);

    [[nodiscard]] const std::vector<MachineEvent>& standing() const { return standing_; }
    /// Changes whenever the errors that are present change.
    [[nodiscard]] std::uint64_t changes() const { return changes_; }

private:
    void end(const Record& record);
    void end_all(EventEnd what);
    void end_one(std::uint32_t code);
    void note_not_published(const Record& record);
    [[nodiscard]] bool stands_already(const MachineEvent& event) const;
    [[nodiscard]] EventLevel level_of(const MachineEventType& type) const;

    std::vector<EventLevelChoice> levels_;
    OncePerCertificate once_;
    std::uint32_t not_published_{0}; // reasons as bits, since the preparation began
    std::vector<MachineEvent> standing_;
    std::uint64_t changes_{0};
};

} // namespace busbar::controller::detail
