#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_transfer.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/record.hpp>

namespace busbar::product {

/// A TransferOwner that keeps the result of the last CloseAndCommit: a JSON document that the
/// session of that call fetches with the option "report". For a refusal it contains the reason,
/// {"problem": "press.st:4:5: ..."}. Used on the server's thread.
class ReportingOwner : public administration::TransferOwner {
public:
    [[nodiscard]] std::string why_refused() const override { return refusal_; }

protected:
    /// Refused files are written to `log`, which must outlive this object, with this source.
    ReportingOwner(const char* source, LogSink& log) : source_{source}, log_{log} {}

    [[nodiscard]] StatusCode allow();
    [[nodiscard]] StatusCode refuse(StatusCode status, std::string why);

    /// Returns the bytes of the text; refuses more than `max_size`.
    [[nodiscard]] Result<std::vector<std::byte>> give(std::string_view text, std::size_t max_size);
    /// Returns the report to the session that it belongs to; Bad_NotFound for other sessions.
    [[nodiscard]] Result<std::vector<std::byte>>
    give_report(const administration::TransferRequest& request, std::size_t max_size);
    /// Keeps the report of an accepted file, or the problem. A refused change is logged with its
    /// `verb`; an empty one means that nothing was to change.
    [[nodiscard]] StatusCode report(const administration::TransferRequest& request,
                                    const Configured<std::string>& done, std::string_view verb);
    /// Records what the request has changed. Takes no memory but for the field MethodId, which is
    /// null without. A record that the log has no memory for is lost, since the change is made.
    void tell_changed(const administration::TransferRequest& request, RecordKind kind) const;

private:
    struct Report {
        NodeId session;
        std::string text;
    };

    const char* source_;
    LogSink& log_;
    Report report_;
    std::string refusal_;
};

} // namespace busbar::product
