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

/// The program that a machine runs, for who asks.
struct ProgramInForce {
    /// As messages call it.
    std::string name;
    std::shared_ptr<const std::string> text;
    std::shared_ptr<const controller::CheckedProgram> program;
    /// What the configuration names.
    std::string file;
    /// It was received, and counts instead of that file.
    bool is_received{false};
    /// By whom and when, of a received one.
    std::string user{};
    DateTime time{};
    /// What lies in the file is another program, or cannot be read.
    bool is_file_other{false};
    std::size_t published{0};
    /// Why the last download was refused after it was sent; empty: it was not.
    std::string refusal{};
};

/// What is to become of a program.
struct ProgramChange {
    enum class Step : std::uint8_t { Check, Edit, Download };

    Step step{Step::Check};
    /// Of a ReceivedProgram. Nothing: what was received is forgotten, and the file counts.
    std::optional<std::string> document{};
    /// What was made of its text, or of the file; nothing: it has to be read.
    std::optional<PreparedProgram> prepared{};
};

/// What a change comes to.
struct ProgramVerdict {
    /// It is the text that runs.
    bool is_same{false};
    /// Why an online edit does not do; empty: it does.
    std::string against_edit{};
    /// Why a download does not do at the time; empty: it does.
    std::string against_download{};
};

/// A machine's program over OPC UA (W588, 3-3-2 and 4-1-4): the Object "Program" below Objects,
/// a TemporaryFileTransferType. Its generateOptions are null for GenerateFileForRead of the
/// program's text, and else one of these texts:
///
///     GenerateFileForRead   "report": what the session's last CloseAndCommit came to
///                           "status": what runs, and where it is from
///     GenerateFileForWrite  "check NAME"      a program follows, whose file has this name
///                           "compare NAME"    the same
///                           "edit NAME"       the same: becomes the program by an online edit
///                           "download NAME"   the same: by a download, in PROGRAM mode
///                           "restore"         an empty file follows: the program of the
///                                             configuration's file, by an edit or a download
///                           "mode RUN"        an empty file follows
///                           "mode PROGRAM"    an empty file follows
///
/// A report is JSON: {"problem": "press.st:4:5: ..."} for what was refused;
/// {"same", "edit", "download"} for a check, the latter two with the reason against, or empty;
/// {"differences": [{"what", "file", "controller"}]}; {"edited": true}; {"downloaded": true}: the
/// program is kept and the server takes it up at once, which ends its sessions; {"mode": "RUN"}.
/// What is refused only then, as by the PLC's runtime, is the "refusal" of the status, and the
/// program from before goes on.
///
/// Of two who send at once the second is refused. Programs are read, checked and compared on the
/// worker; all else is done on the server's thread.
class ProgramService final : public ReportingOwner {
public:
    /// All must outlive it.
    struct Needs {
        std::function<ProgramInForce()> program;
        std::function<ProgramBase()> base;
        /// Carries a change out, or only looks at it; the problem is why nothing has changed.
        std::function<Configured<ProgramVerdict>(const ProgramChange& change)> change;
        std::function<controller::MachineMode()> mode;
        std::function<Configured<void>(controller::MachineMode mode)> set_mode;
        const WallClock& clock;
        LogSink& log;
    };

    explicit ProgramService(Needs needs);

    /// For AdministrationParts::file_transfers: for those who may transfer a project, which are
    /// administrator and designer (W588, 8-1).
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
    [[nodiscard]] Configured<std::string> restore();
    [[nodiscard]] Configured<std::string> change_mode(const Wish& wish) const;

    Needs needs_;
    // What preparation() leaves for take(), of which there is one at a time.
    Configured<PreparedProgram> prepared_;
    std::string differences_;
};

} // namespace busbar::product
