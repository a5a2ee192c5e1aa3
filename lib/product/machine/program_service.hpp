#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_transfer.hpp>
#include <busbar/controller/machine_settings.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>

#include "product/access/reporting_owner.hpp"
#include "program_change.hpp"

namespace busbar::product {

/// The program that a machine runs, for reports.
struct ProgramInForce {
    /// The program's name in messages, which may be that of several files (see paths_in_line).
    std::string name;
    std::shared_ptr<const std::string> text;
    std::shared_ptr<const controller::CheckedProgram> program;
    /// The configured file, as SourceFiles::program_text() takes it.
    std::string file;
    /// True if the program was received and replaces that file.
    bool is_received{false};
    /// Sender and time of a received program.
    std::string user{};
    DateTime time{};
    std::size_t published{0};
    /// The reason for refusing the last download after it was sent; empty if it was not.
    std::string refusal{};
};

/// A change of a machine's program.
struct ProgramChange {
    enum class Step : std::uint8_t { Check, Edit, Download };

    Step step{Step::Check};
    /// Leaves out more than the program that runs, if need be; see check_left_out().
    bool leaves_out{false};
    /// Document of a ReceivedProgram. Without one, the received program is removed and the file is
    /// used.
    std::optional<std::string> document{};
    /// Prepared from that text, or from the file; if empty, the text must be read.
    std::optional<PreparedProgram> prepared{};
};

/// The result of a change.
struct ProgramVerdict {
    /// True if the text is the one that runs.
    bool is_same{false};
    /// Reason against an online edit; empty if it is possible.
    std::string against_edit{};
    /// Reason against a download at present; empty if it is possible.
    std::string against_download{};
};

/// A machine's program over OPC UA (W588, 3-3-2 and 4-1-4): the Object "Program" below Objects,
/// a TemporaryFileTransferType. Its generateOptions are null for GenerateFileForRead of the
/// program's text, and else one of these texts:
///
///     GenerateFileForRead   "report": the result of the session's last CloseAndCommit
///                           "status": the running program and its origin
///     GenerateFileForWrite  "check NAME"      a program follows, whose file has this name
///                           "compare NAME"    the same
///                           "edit NAME"       the same: becomes the program by an online edit
///                           "download NAME"   the same: by a download, in PROGRAM mode
///                           "check-leaving-out NAME", "edit-leaving-out NAME" and
///                           "download-leaving-out NAME" also for a program that leaves out more
///                                             than the one that runs
///                           "restore"         an empty file follows: the program of the
///                                             configuration's file, by an edit or a download
///                           "mode RUN"        an empty file follows
///                           "mode PROGRAM"    an empty file follows
///
/// A report is JSON: {"problem": "press.st:4:5: ..."} for what was refused;
/// {"same", "edit", "download", "leftOutCount", "leftOut"} for a check, "edit" and "download" with
/// the reason against, or empty;
/// {"differences": [{"what", "file", "controller"}]}; {"edited": true}; {"downloaded": true}: the
/// program is kept and the server takes it up at once, which ends its sessions; {"mode": "RUN"}.
/// A program that is refused only then, for example by the PLC's runtime, leaves a "refusal" in the
/// status, and the previous program continues.
///
/// If two clients send at once, the second is refused. Programs are parsed, checked and compared on
/// the worker; everything else runs on the server's thread.
class ProgramService final : public ReportingOwner {
public:
    /// All members must outlive this object.
    struct Needs {
        std::function<ProgramInForce()> program;
        /// Returns true if the configured file contains another program, or cannot be read.
        std::function<bool()> is_file_other;
        std::function<ProgramBase()> base;
        /// Carries a change out, or only checks it; the problem is the reason why nothing has
        /// changed.
        std::function<Configured<ProgramVerdict>(const ProgramChange& change)> change;
        std::function<controller::MachineMode()> mode;
        std::function<Configured<void>(controller::MachineMode mode)> set_mode;
        const WallClock& clock;
        LogSink& log;
    };

    explicit ProgramService(Needs needs);

    /// Returns the transfer for AdministrationParts::file_transfers. It belongs to the roles that
    /// may transfer a project, administrator and designer (W588, 8-1).
    [[nodiscard]] administration::TemporaryFileTransfer transfer();

    [[nodiscard]] Result<std::vector<std::byte>>
    generate(const administration::TransferRequest& request, std::size_t max_size) override;
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest& request) override;
    [[nodiscard]] std::function<void()> preparation(const administration::TransferRequest& request,
                                                    std::span<const std::byte> bytes) override;
    [[nodiscard]] StatusCode take(const administration::TransferRequest& request,
                                  std::span<const std::byte> bytes) override;

private:
    struct Wish;
    [[nodiscard]] static std::optional<Wish> wish_of(const Variant& options);
    [[nodiscard]] std::string status_text() const;
    [[nodiscard]] Configured<std::string> carry_out(const Wish& wish, const std::string& user,
                                                    std::string_view text);
    [[nodiscard]] Configured<std::string> change(const Wish& wish, const std::string& user,
                                                 std::string_view text);
    [[nodiscard]] Configured<std::string> restore(const Wish& wish);
    [[nodiscard]] Configured<std::string> change_mode(const Wish& wish) const;

    Needs needs_;
    // What preparation() leaves for take(), of which there is one at a time.
    Configured<PreparedProgram> prepared_;
    std::string differences_;
};

} // namespace busbar::product
