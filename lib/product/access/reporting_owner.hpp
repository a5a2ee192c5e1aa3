#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_transfer.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// A TransferOwner that keeps what the last CloseAndCommit came to: a JSON document that the
/// session of that call fetches with the option "report". What was refused has the reason,
/// {"problem": "press.st:4:5: ..."}. On the server's thread.
class ReportingOwner : public administration::TransferOwner {
public:
    [[nodiscard]] std::string why_refused() const override { return refusal_; }

protected:
    /// `log` must outlive it and gets, with this source, the files that are refused.
    ReportingOwner(const char* source, LogSink& log) : source_{source}, log_{log} {}

    [[nodiscard]] StatusCode allow();
    [[nodiscard]] StatusCode refuse(StatusCode status, std::string why);

    /// The bytes of the text, which is refused if it has more than `max_size`.
    [[nodiscard]] Result<std::vector<std::byte>> give(std::string_view text, std::size_t max_size);
    /// The report, if it is this session's; Bad_NotFound otherwise.
    [[nodiscard]] Result<std::vector<std::byte>>
    give_report(const administration::TransferRequest& request, std::size_t max_size);
    /// Keeps the report of a file that was taken, or the problem. What was refused of a change is
    /// logged with its `verb`; empty: it was none.
    [[nodiscard]] StatusCode report(const administration::TransferRequest& request,
                                    const Configured<std::string>& done, std::string_view verb);

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
