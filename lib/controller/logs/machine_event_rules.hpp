#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <busbar/controller/machine_event_log.hpp>

#include "once_per_certificate.hpp"

namespace busbar::controller::detail {

/// Which events a record is, and which errors stand after it (W588, 9-2-2). Starts with no
/// error, as a controller does. One thread at a time; uses nothing but memory.
class MachineEventRules {
public:
    explicit MachineEventRules(std::vector<EventLevelChoice> levels) : levels_{std::move(levels)} {}

    [[nodiscard]] static bool wants(RecordKind kind);

    /// The events, without numbers; none for what was told already and must not be told twice.
    [[nodiscard]] std::vector<MachineEvent> take(const Record& record, DateTime now);

    [[nodiscard]] const std::vector<MachineEvent>& standing() const { return standing_; }
    /// Another number after each change of those that stand.
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
    std::uint32_t not_published_{0}; // bits, since the preparation began
    std::vector<MachineEvent> standing_;
    std::uint64_t changes_{0};
};

} // namespace busbar::controller::detail
