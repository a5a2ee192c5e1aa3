#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/core/status_codes.hpp>

#include "product/configuration/plc_trial.hpp"
#include "product/configuration/toml_reader.hpp"
#include "product/machine/program_file.hpp"
#include "product/store/received_program.hpp"
#include "running_controller.hpp"
#include "startup.hpp"

namespace busbar::product {

// How a RunningController takes over other programs.

namespace {

/// Nothing if the file has the text that is known, or nothing that can be used: what is wrong with
/// it is found out once more where it is told.
std::optional<PreparedProgram> prepare_file(const ProgramBase& base, const std::string& file,
                                            const std::string& known)
{
    auto text = SourceFiles{}.program_text(file, ReceivedProgram::max_text);
    if (!text || **text == known) {
        return std::nullopt;
    }
    auto prepared = prepare_program(base, **text, file);
    if (!prepared) {
        return std::nullopt;
    }
    prepared->files.text = *std::move(text);
    return *std::move(prepared);
}

/// The same of a program of labels.
SourceFiles::Prepared prepare_labels(PlcTrial trial, const std::string& file,
                                     const std::shared_ptr<const std::string>& known)
{
    auto text = SourceFiles{}.program_text(file, controller::DeclarationLimits{}.max_text_size);
    if (file.empty() || !text || (known != nullptr && **text == *known)) {
        return {};
    }
    auto program = read_labels(**text, file, trial.label_reading);
    if (!program) {
        return {};
    }
    trial.labels = *program;
    const bool is_possible = trial.run().has_value();
    return {.text = *std::move(text),
            .labels = *std::move(program),
            .tried = is_possible ? std::make_shared<const PlcTrial>(std::move(trial)) : nullptr};
}

} // namespace

void RunningController::check_download(const ControllerConfig& next, const std::string& edit) const
{
    if (next.machine.is_used != current_->config().machine.is_used) {
        throw ConfigError{"machine.use", "takes effect only after a restart of the controller"};
    }
    const auto is_in_run = [](const MachineConfig& machine) {
        return machine.mode == controller::MachineMode::Run;
    };
    if (is_in_run(current_->config().machine) && is_in_run(next.machine)) {
        throw ConfigError{
            "", edit + (edit.empty() ? "" : "; ") +
                    "a download waits until the machine is not in RUN: `busbar admin mode "
                    "program` or mode = \"PROGRAM\" in [machine] sets that"};
    }
    expect(check_listeners(next)); // which may have changed in the file since
}

void RunningController::check_left_out(const ControllerConfig& next) const
{
    if (labels_) {
        expect(labels_->check_left_out(next.labels));
    }
    const auto& before = current_->config().machine.program;
    const auto& program = next.machine.program;
    if (before != nullptr && program != nullptr && before != program &&
        !next.machine.may_leave_out_more) {
        expect(product::check_left_out(before->program(), program->program(),
                                       next.machine.program_name));
    }
}

void RunningController::read_again_soon()
{
    when_free([this] {
        const ControllerConfig& config = current_->config();
        if (labels_ && !configuration_.file.empty()) {
            return work_aside([this, trial = PlcTrial{config}, file = config.labels.program_file,
                               known = labels_->program_text()] {
                when_free([this, labels = prepare_labels(trial, file, known)] {
                    read_again_with_labels(labels);
                });
            });
        }
        const bool is_begun = machine_ && maker_->run([this, base = current_->program_base(),
                                                       file = config.machine.program_file,
                                                       known = config.machine.program_text] {
            when_free([this, program = prepare_file(base, file, *known)] { read_again(program); });
        });
        if (!is_begun) {
            read_again({});
        }
    });
}

bool RunningController::download(const std::optional<PreparedProgram>& program)
{
    const SourceFiles& sources = current_->sources();
    Reading reading =
        read(configuration_,
             {.files = program ? sources.again_with(current_->config().machine.program_file,
                                                    program->files)
                               : sources.again()});
    const MachineConfig& machine = reading.config.machine;
    if (!machine.program || *machine.program_text == *current_->config().machine.program_text) {
        tell_of_other_file();
        return false;
    }
    check_left_out(reading.config);
    const std::string file = paths_in_line(machine.program_name);
    const auto edited = current_->edit(reading, program);
    if (edited) {
        edited_online(file);
        return false;
    }
    check_download(reading.config, text(edited.error()));
    replace(
        {.cause = Machine::Cause::Download,
         .handover = {.reason = "a program is downloaded to the controller"},
         .read = [this] { return read(configuration_, as_known()); },
         .done = [this, file] { log_.write(LogLevel::Info, "controller", "downloaded: " + file); },
         .refused =
             [this](const ConfigError& error) {
                 pending_.ask(PendingChanges::By::Reload, error.what());
             }},
        std::move(reading));
    return true;
}

void RunningController::edited_online(const std::string& name)
{
    log_.write(LogLevel::Info, "controller", "edited online: " + paths_in_line(name));
    pending_.done(PendingChanges::By::Download);
    refused_program_.reset();
    keep();
}

void RunningController::tell_of_other_file()
{
    const ProgramInForce now = current_->program();
    if (now.is_received && current_->is_program_file_other()) {
        log_.write(
            LogLevel::Warning, "controller",
            paths_in_line(now.file) + " is not used: " + paths_in_line(now.name) +
                ", which was sent over OPC UA, is used until `busbar admin program restore`");
    }
}

Reading RunningController::reading_with(const ProgramChange& change) const
{
    return read(configuration_,
                {.files = current_->sources().with_program(
                     change.document, current_->config().machine.program_file,
                     change.prepared ? change.prepared->files : SourceFiles::Prepared{}),
                 .project = current_->project_document()});
}

Configured<ProgramVerdict> RunningController::change_program(const ProgramChange& change)
{
    using Step = ProgramChange::Step;
    if (change.step != Step::Check) {
        if (auto may = check_no_replacement("program"); !may) {
            return Unexpected{std::move(may.error())};
        }
    }
    try {
        Reading next = reading_with(change);
        if (!change.leaves_out) {
            check_left_out(next.config);
        }
        ProgramVerdict verdict;
        verdict.is_same =
            *next.config.machine.program_text == *current_->config().machine.program_text;
        const auto may_edit = current_->check_edit(next, change.prepared);
        verdict.against_edit = may_edit ? "" : text(may_edit.error());
        try {
            check_download(next.config, "");
        } catch (const ConfigError& error) {
            verdict.against_download = error.what();
        }
        if (change.step == Step::Check) {
            return verdict;
        }
        if (change.step == Step::Download) {
            check_download(next.config, "");
            save_retained(); // the next program begins with these values, or is refused now
        } else if (!may_edit) {
            return Unexpected{may_edit.error()};
        }
        const auto& texts = current_->sources().texts();
        const auto known = texts.find(current_->sources().received_place());
        auto before = known != texts.end() ? std::optional{*known->second} : std::nullopt;
        expect(current_->keep_program(change.document));
        std::string reason_before = download_reason();
        refused_program_.reset();
        if (change.step == Step::Download) {
            download_soon(change, std::move(next), std::move(before));
        } else if (const auto edited = current_->edit(next, change.prepared); !edited) {
            refuse_program({.why = text(edited.error()),
                            .before = std::move(before),
                            .reason_before = std::move(reason_before)});
            return Unexpected{edited.error()};
        } else {
            edited_online(next.config.machine.program_name);
        }
        return verdict;
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

/// Posts the download, because a callback of the server must not replace it.
void RunningController::download_soon(ProgramChange change, Reading reading,
                                      std::optional<std::string> before)
{
    pending_.done(PendingChanges::By::Download);
    const auto read_then = std::make_shared<Reading>(std::move(reading));
    replace_soon([this, change = std::move(change), read_then, before = std::move(before)] {
        const std::string name = paths_in_line(read_then->config.machine.program_name);
        // Use the settings that are in force by now, if they were changed in between.
        std::optional<Reading> unchanged;
        if (current_->has_settings_of(*read_then)) {
            unchanged = std::move(*read_then);
        }
        replace(
            {.cause = Machine::Cause::Download,
             .handover = {.reason = "a program is downloaded to the controller"},
             .read = [this, change] { return reading_with(change); },
             .done = [this,
                      name] { log_.write(LogLevel::Info, "controller", "downloaded: " + name); },
             .refused =
                 [this, name, before](const ConfigError& error) {
                     refuse_program({.why = name + " was sent and refused: " + error.what(),
                                     .before = before,
                                     .was_accepted = true});
                 },
             .leaves_out = change.leaves_out},
            std::move(unchanged));
    });
}

void RunningController::refuse_program(RefusedProgram refused)
{
    refused_program_ = std::move(refused);
    if (!put_back()) {
        log_.write(LogLevel::Error, "controller", pending_.reason(PendingChanges::By::Download));
    }
}

std::string RunningController::download_reason() const
{
    if (!refused_program_) {
        return pending_.reason(PendingChanges::By::Download);
    }
    return refused_program_->was_accepted ? refused_program_->why : refused_program_->reason_before;
}

Configured<void> RunningController::put_back()
{
    if (!refused_program_) {
        return {};
    }
    const auto done = current_->keep_program(refused_program_->before);
    std::string why = download_reason();
    if (!done) {
        why = refused_program_->why +
              "; it is stored all the same, and a start tries it again, "
              "until it can be replaced: " +
              text(done.error());
    }
    pending_.ask(PendingChanges::By::Download, std::move(why));
    if (done) {
        refused_program_.reset();
    }
    return done;
}

void RunningController::read_again_with_labels(const SourceFiles::Prepared& labels)
{
    try_to_read([&] {
        Substitutes known = as_known();
        if (labels.text != nullptr) {
            known.files =
                current_->sources().again_with(current_->config().labels.program_file, labels);
        }
        Reading next = read(configuration_, std::move(known));
        if (!labels_->is_other(next.config)) {
            return read_files_again();
        }
        check_left_out(next.config);
        download_labels(
            next.config, [this, sources = next.settings->sources(),
                          file = next.config.labels.program_file](const Problem* why_not) {
                try_to_read([&] {
                    if (why_not != nullptr) {
                        throw ConfigError{*why_not};
                    }
                    current_->use(sources);
                    keep();
                    log_.write(LogLevel::Info, "controller", "downloaded: " + paths_in_line(file));
                    read_files_again();
                });
            });
    });
}

void RunningController::download_labels(ControllerConfig next,
                                        std::function<void(const Problem* why_not)> then)
{
    takes_labels_ = true;
    work_aside(
        [this, file = next.labels.program_file, next = std::move(next), then = std::move(then)] {
            std::optional<Problem> why_not;
            try {
                labels_->download(next);
            } catch (const ConfigError& error) {
                why_not = error.problem();
            }
            loop_.post([this, why_not, then, file] {
                takes_labels_ = false;
                if (!why_not) {
                    labels_->tell_left_out(log_, file);
                }
                resume();
                then(why_not ? &*why_not : nullptr);
            });
        });
}

} // namespace busbar::product
