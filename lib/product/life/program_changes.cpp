#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "product/configuration/toml_reader.hpp"
#include "product/store/received_program.hpp"
#include "running_controller.hpp"
#include "startup.hpp"

namespace busbar::product {

// How a RunningController takes over other programs.

void RunningController::check_download(const ControllerConfig& next, const std::string& edit) const
{
    if (next.machine.is_used != current_->config().machine.is_used) {
        throw ConfigError{"machine.use", "changes with a restart of the controller only"};
    }
    const auto is_in_run = [](const MachineConfig& machine) {
        return machine.mode == controller::MachineMode::Run;
    };
    if (is_in_run(current_->config().machine) && is_in_run(next.machine)) {
        throw ConfigError{
            "", edit + (edit.empty() ? "" : "; ") +
                    "a download waits until the machine is not in RUN: `busbar admin mode "
                    "program`, or mode = \"PROGRAM\" in [machine], is for it"};
    }
}

bool RunningController::download()
{
    Reading reading = read(origin_);
    const MachineConfig& machine = reading.config.machine;
    if (!machine.program || *machine.program_text == *current_->config().machine.program_text) {
        tell_of_other_file();
        return false;
    }
    const std::string file = machine.program_name;
    const auto edited = current_->edit(reading);
    if (edited) {
        log_.write(LogLevel::Info, "controller", "edited online: " + file);
        keep();
        return false;
    }
    check_download(reading.config, text(edited.error()));
    replace(Machine::Cause::Download, std::move(reading),
            {.reason = "a program is downloaded to the controller"});
    log_.write(LogLevel::Info, "controller", "downloaded: " + file);
    return true;
}

void RunningController::tell_of_other_file()
{
    const ProgramInForce now = current_->program();
    if (now.is_received && now.is_file_other) {
        log_.write(LogLevel::Warning, "controller",
                   now.file + " does not count: " + now.name +
                       ", which was sent over OPC UA, does, until `busbar admin program restore`");
    }
}

Reading RunningController::reading_with(const std::optional<std::string>& program) const
{
    const SourceFiles files =
        current_->sources().with_program(program, current_->config().machine.program_file);
    return read(origin_, {.files = files.texts(), .project = current_->taken_over().project});
}

Configured<ProgramVerdict> RunningController::change_program(const ProgramChange& change)
{
    using Step = ProgramChange::Step;
    try {
        Reading next = reading_with(change.document);
        ProgramVerdict verdict;
        verdict.is_same =
            *next.config.machine.program_text == *current_->config().machine.program_text;
        const auto may_edit = current_->check_edit(next);
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
        } else if (!may_edit) {
            return Unexpected{may_edit.error()};
        }
        const auto& texts = current_->sources().texts();
        const auto known = texts.find(current_->sources().received_place());
        auto before = known != texts.end() ? std::optional{*known->second} : std::nullopt;
        expect(current_->keep_program(change.document));
        if (change.step == Step::Download) {
            download_soon(std::move(next), std::move(before));
        } else if (const auto edited = current_->edit(next); !edited) {
            expect(current_->keep_program(before));
            return Unexpected{edited.error()};
        } else {
            log_.write(LogLevel::Info, "controller",
                       "edited online: " + next.config.machine.program_name);
            keep();
        }
        return verdict;
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

/// Not in a callback of the server that it takes the place of.
void RunningController::download_soon(Reading reading, std::optional<std::string> before)
{
    const auto next = std::make_shared<Reading>(std::move(reading));
    loop_.post([this, next, before = std::move(before)] {
        bool is_done = false;
        try_to([&] {
            const std::string name = next->config.machine.program_name;
            replace(Machine::Cause::Download, std::move(*next),
                    {.reason = "a program is downloaded to the controller"});
            is_done = true;
            log_.write(LogLevel::Info, "controller", "downloaded: " + name);
        });
        if (!is_done) {
            try_to([&] { expect(current_->keep_program(before)); });
        }
    });
}

void RunningController::download_labels()
{
    if (!labels_ || origin_.file.empty()) {
        return;
    }
    const Reading next = read(origin_);
    if (labels_->download(next.config)) {
        current_->use(next.settings->sources());
        keep();
        log_.write(LogLevel::Info, "controller", "downloaded: " + next.config.labels.program_file);
    }
}

} // namespace busbar::product
