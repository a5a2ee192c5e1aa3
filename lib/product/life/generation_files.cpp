#include "generation.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "product/machine/machine_items.hpp"
#include "product/machine/program_change.hpp"
#include "product/machine/program_file.hpp"

namespace busbar::product {

// The files that administrators exchange with a Generation, and its program.

std::vector<administration::TemporaryFileTransfer> Generation::backups(const Requests& requests)
{
    Machine* const machine = around_.machine;
    if (machine == nullptr) {
        return {};
    }
    const auto program = std::make_shared<RestoredProgram>();
    memory_files_.emplace(settings_->folder(), machine->event_files());
    backup_.emplace(MachineBackup::Needs{
        .files = *memory_files_,
        .gate = settings_->files(),
        .items = machine_items(*settings_, machine->state(), program),
        .preparation = [this, program](std::span<const std::byte> backup) -> std::function<void()> {
            return [base = program_base(), program, backup] {
                prepare_restored(base, backup, *program);
            };
        },
        .controller = controller_name(config_),
        .clock = *around_.environment.wall_clock,
        .log = administered_.log(),
        .mode = [machine] { return machine->mode(); },
        .restores_profile =
            [this] { return plant_.plc().instructions().restores_security_profile(); },
        .hold_files = [machine](FunctionRef<void()> act) { machine->hold_files(act); },
        .values_replaced = [machine] { machine->values_replaced(); },
        .replaced = requests.memory_replaced});
    return {backup_->transfer()};
}

std::vector<administration::TemporaryFileTransfer> Generation::transfers(const Requests& requests)
{
    auto all = backups(requests);
    const auto more = programs(requests);
    all.insert(all.end(), more.begin(), more.end());
    if (project_ != nullptr) {
        all.push_back(project_->transfer(
            {.is_shut_down = around_.is_shut_down,
             .version = BUSBAR_VERSION,
             .log = administered_.log(),
             .labels = around_.labels,
             .isolates_failures = config_.labels.isolates_failures,
             .restart = [restart = requests.restart, may_update = requests.may_update] {
                 return may_update().transform(
                     [&] { restart({.reason = "the project was updated"}); });
             }}));
    }
    return all;
}

std::vector<administration::TemporaryFileTransfer> Generation::programs(const Requests& requests)
{
    Machine* const machine = around_.machine;
    if (machine == nullptr) {
        return {};
    }
    program_service_.emplace(ProgramService::Needs{
        .program = [this] { return program(); },
        .is_file_other = [this] { return is_program_file_other(); },
        .base = [this] { return program_base(); },
        .change = requests.change_program,
        .mode = [machine] { return machine->mode(); },
        .set_mode = [this](controller::MachineMode mode) { return set_mode(mode); },
        .clock = *around_.environment.wall_clock,
        .log = administered_.log()});
    return {program_service_->transfer()};
}

/// Changes the mode; a value that the file has already is not stored as an online change.
Configured<void> Generation::set_mode(controller::MachineMode mode)
{
    constexpr const char* name = "machine.mode";
    const Variant wanted{mode == controller::MachineMode::Run ? "RUN" : "PROGRAM"};
    const bool is_of_file = settings_->file_value(name) == wanted;
    const administration::SettingChange change{name, is_of_file ? Variant{} : wanted};
    const administration::SettingAuthor author{.time = around_.environment.wall_clock->now()};
    return settings_->list().change({&change, 1}, *settings_, author);
}

Configured<void> Generation::switch_mode(controller::MachineMode mode)
{
    is_switching_mode_ = true;
    const busbar::detail::Undo switched{[this] { is_switching_mode_ = false; }};
    return set_mode(mode);
}

ProgramInForce Generation::program() const
{
    const MachineConfig& machine = config_.machine;
    ProgramInForce now{.name = machine.program_name,
                       .text = machine.program_text,
                       .program = machine.program,
                       .file = machine.program_file,
                       .published = plant_.visible_variables()};
    const SourceFiles& sources = settings_->sources();
    const auto document = sources.texts().find(sources.received_place());
    if (document != sources.texts().end()) {
        auto received = read_received(*document->second, document->first);
        now.is_received = true;
        now.user = received ? std::move(received->user) : std::string{};
        now.time = received ? received->time : DateTime{};
    }
    now.refusal = around_.pending.reason(PendingChanges::By::Download);
    return now;
}

bool Generation::is_program_file_other()
{
    // A program may be a folder of many files, and every status asks: looking again and again may
    // take a twentieth of the server's time.
    constexpr int share = 20;
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    if (!other_file_ || begin >= other_file_->valid_until) {
        const MachineConfig& machine = config_.machine;
        const auto file =
            SourceFiles{}.program_text(machine.program_file, ReceivedProgram::max_text);
        const auto end = Clock::now();
        other_file_ = {.valid_until = end + share * (end - begin),
                       .is_other = !file || **file != *machine.program_text};
    }
    return other_file_->is_other;
}

ProgramBase Generation::program_base() const
{
    return {plant_.program()->editions(), PlcTrial{config_}, config_.machine.may_leave_out_more};
}

Configured<void> Generation::check_edit(const Reading& next,
                                        const std::optional<PreparedProgram>& prepared) const
{
    const MachineConfig& machine = next.config.machine;
    if (next.settings->text() != settings_->text()) {
        return misconfigured(configuration_.file, "has other settings, too");
    }
    const auto& editions = plant_.program()->editions();
    const bool is_known = prepared && prepared->edition == editions.back() &&
                          prepared->files.program == machine.program;
    Configured<void> may =
        is_known ? prepared->may_edit : product::check_edit(editions, *machine.program);
    return std::move(may).transform_error([&](Problem problem) {
        return in_file(std::move(problem), machine.program_name, machine.program->program());
    });
}

Configured<void> Generation::edit(const Reading& next,
                                  const std::optional<PreparedProgram>& prepared)
{
    const MachineConfig& machine = next.config.machine;
    MachineProgram& program = *plant_.program();
    const auto add = [&] {
        return program.edit(machine.program, server_)
            .transform([&](controller::ProgramAddition change) {
                plant_.loaded().edited(change);
                return change;
            })
            .transform_error([&](Problem problem) {
                return in_file(std::move(problem), machine.program_name,
                               machine.program->program());
            });
    };
    return check_edit(next, prepared)
        .and_then([&] { return around_.machine->edit(program, add); })
        .transform([&] {
            config_.machine.program = machine.program;
            config_.machine.program_name = machine.program_name;
            config_.machine.program_text = machine.program_text;
            other_file_.reset();
            use(next.settings->sources());
        });
}

} // namespace busbar::product
