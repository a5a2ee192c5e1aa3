#pragma once

#include <memory>
#include <string>
#include <vector>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "log_fixture.hpp"

namespace busbar::test {

using namespace busbar::controller;

class StandingClock final : public WallClock {
public:
    DateTime now() const override { return time; }

    DateTime time{example_start};
};

/// "35D40000 21,x": code and what is attached.
inline std::string short_event(const MachineEvent& event)
{
    std::string text = code_text(*event.type);
    for (const std::string& each : event.attached) {
        text += (each == event.attached.front() ? " " : ",") + each;
    }
    return text;
}

using Texts = std::vector<std::string>;

inline Texts short_events(const std::vector<MachineEvent>& events)
{
    Texts texts;
    for (const MachineEvent& each : events) {
        texts.push_back(short_event(each));
    }
    return texts;
}

class EventEar final : public MachineEventListener {
public:
    void happened(const MachineEvent& event) override { heard.push_back(short_event(event)); }

    Texts heard;
};

struct EventWorld {
    explicit EventWorld(MachineEventLogOptions its_options = {}) : options{std::move(its_options)}
    {
        restart();
    }

    void restart()
    {
        log.reset();
        log = MachineEventLog::create(storage, clock, next, &ear, options).value();
    }
    /// What comes of it.
    Texts happen(const Happening& happening)
    {
        ear.heard.clear();
        log->record(happening.record());
        return ear.heard;
    }
    Texts happen(RecordKind kind) { return happen(Happening{kind}); }
    Texts happen(RecordKind kind, const crypto::Certificate& certificate)
    {
        Happening happening{kind};
        happening.of(certificate.der());
        return happen(happening);
    }
    [[nodiscard]] Texts current() const { return short_events(log->current_errors()); }
    /// As many as told, numbered.
    void refuse(int from, int count)
    {
        for (int i = from; i < from + count; ++i) {
            happen(Happening{RecordKind::LoginRefused}
                       .by("user" + std::to_string(i))
                       .with(status::Bad_UserAccessDenied));
        }
    }

    storage::MemoryStorage storage;
    StandingClock clock;
    NullLog next;
    EventEar ear;
    MachineEventLogOptions options;
    std::unique_ptr<MachineEventLog> log;
};

} // namespace busbar::test
