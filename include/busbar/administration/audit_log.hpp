#pragma once

#include <atomic>
#include <memory>
#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/record.hpp>
#include <busbar/server/event.hpp>

namespace busbar::administration {

/// Creates the audit events of Part 5, 6.4 from the records of a server's log: channels, sessions,
/// certificates, Writes, Calls, NodeManagement, Cancel, URL mismatches, roles and trust lists.
/// Lines are passed on to another log.
///
///     AuditLog log{lines};
///     auto server = Server::create(config, {.log = &log, ...}); // config.is_auditing = true
///     log.attach(server->event_queue(), config.application_uri);
///
/// A server delivers them over channels with encryption only, to users whose roles may receive
/// AuditEventType: SecurityAdmin, unless configured otherwise. Records before attach() do not
/// become events. The queue is bounded; events that find no room are counted there, and clients are
/// notified.
///
/// Each Method and each node of a Write has one event, also if its session ends before the answer:
/// of the type that the specification has for the Method, else AuditUpdateMethodEventType. Trust
/// lists and certificates that a Method has changed have another one each (Part 12, 7.8.2.13 and
/// 7.10.27), trust lists also if it is a restore or a clearing; and so have the server's other
/// certificate that ApplyChanges puts in force, and a refusal that a Method answers with Good and
/// tells in an output.
///
/// A Write has no OldValue: data sources are not asked for it. Inputs of Methods with passwords or
/// keys are left out.
///
/// Called from any thread, except for attach().
class BUSBAR_API AuditLog final : public LogSink {
public:
    /// `lines` must outlive this object.
    explicit AuditLog(LogSink& lines) : lines_{&lines} {}

    /// `queue` may be null, as that of a server without events: then nothing happens. `server_id`
    /// is the server's ApplicationUri.
    void attach(std::shared_ptr<server::EventQueue> queue, std::string server_id);

    /// While this is true, records of changed settings become no events: those of a change by a
    /// Write or a Method, which has an event of its own.
    void set_changing_settings(bool is_changing) { is_changing_settings_ = is_changing; }

    void write(LogLevel level, std::string_view source, std::string_view text) override
    {
        lines_->write(level, source, text);
    }
    void record(const Record& record) override;
    [[nodiscard]] bool wants(RecordKind kind) const override;

private:
    LogSink* lines_;
    std::shared_ptr<server::EventQueue> queue_;
    std::string server_id_;
    std::atomic<bool> is_changing_settings_{false};
};

/// Returns the event for a record: Status and ids, actor and origin, and the fields that the event
/// type has.
[[nodiscard]] BUSBAR_API server::Event audit_event(const Record& record,
                                                   std::string_view server_id);

} // namespace busbar::administration
