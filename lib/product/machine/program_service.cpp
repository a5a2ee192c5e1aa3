#include "program_service.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/status_codes.hpp>

#include "controller/life/checksum.hpp"
#include "core/json_writer.hpp"
#include "product/access/part_rights.hpp"
#include "product/store/received_program.hpp"
#include "program_change.hpp"
#include "program_file.hpp"

namespace busbar::product {

using administration::TransferRequest;

namespace {

constexpr const char* program_source = "program";
constexpr const char* unknown_options =
    "found an unknown option of a program; the name of a file has no slash";

std::string_view mode_name(controller::MachineMode mode)
{
    return mode == controller::MachineMode::Run ? "RUN" : "PROGRAM";
}

void write_member(detail::JsonWriter& json, std::string_view name, std::string_view text)
{
    json.name(name);
    json.string(text);
}

/// See prepare_program().
Configured<PreparedProgram> prepare_file(const ProgramBase& base, const std::string& file)
{
    return SourceFiles{}
        .program_text(file, controller::DeclarationLimits{}.max_text_size)
        .and_then([&](SourceFiles::Text text) {
            return prepare_program(base, *text, file).transform([&](PreparedProgram prepared) {
                prepared.files.text = std::move(text);
                return prepared;
            });
        });
}

std::string difference_report(const std::vector<ProgramDifference>& differences)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("differences");
    json.begin_list();
    for (const ProgramDifference& each : differences) {
        json.begin_object();
        write_member(json, "what", each.what);
        write_member(json, "file", each.file);
        write_member(json, "controller", each.controller);
        json.end_object();
    }
    json.end_list();
    json.end_object();
    return json.take();
}

/// Lists what is left out of the program, as far as a person reads it.
void write_left_out(detail::JsonWriter& json, const controller::Program& program,
                    const std::string& file)
{
    constexpr std::size_t most = 100;
    const std::vector<std::string> all = left_out_texts(program, file);
    json.name("leftOutCount");
    json.word(std::to_string(all.size()));
    json.name("leftOut");
    json.begin_list();
    for (std::size_t i = 0; i < std::min(most, all.size()); ++i) {
        json.string(all[i]);
    }
    json.end_list();
}

std::string verdict_report(const ProgramVerdict& verdict, const controller::Program& program,
                           const std::string& file)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("same");
    json.word(verdict.is_same ? "true" : "false");
    write_member(json, "edit", verdict.against_edit);
    write_member(json, "download", verdict.against_download);
    write_left_out(json, program, file);
    json.end_object();
    return json.take();
}

/// The report of a change, which needs memory before the program is changed.
std::string report_of(ProgramChange::Step step)
{
    return step == ProgramChange::Step::Edit ? R"({"edited":true})" : R"({"downloaded":true})";
}

} // namespace

struct ProgramService::Wish {
    enum class Task : std::uint8_t { Check, Compare, Edit, Download, Restore, Mode };

    /// Returns true if a program follows.
    [[nodiscard]] bool has_file() const { return task != Task::Restore && task != Task::Mode; }

    Task task;
    std::string_view verb;
    /// Name of a program, or of a mode.
    std::string_view name;
    bool leaves_out{false};
};

std::optional<ProgramService::Wish> ProgramService::wish_of(const Variant& options)
{
    using Task = Wish::Task;
    static constexpr std::array<std::pair<std::string_view, Task>, 6> verbs{
        {{"check", Task::Check},
         {"compare", Task::Compare},
         {"edit", Task::Edit},
         {"download", Task::Download},
         {"restore", Task::Restore},
         {"mode", Task::Mode}}};
    const auto* const text = options.get_if<String>();
    const std::string_view all = text != nullptr ? text->view() : std::string_view{};
    const std::size_t end = std::min(all.find(' '), all.size());
    const std::string_view name = all.substr(std::min(end + 1, all.size()));
    std::string_view first = all.substr(0, end);
    constexpr std::string_view leaving_out = "-leaving-out";
    const bool leaves_out = first.ends_with(leaving_out);
    first.remove_suffix(leaves_out ? leaving_out.size() : 0);
    for (const auto& [verb, task] : verbs) {
        const bool may_leave_out = task != Task::Compare && task != Task::Mode;
        if (first != verb || (leaves_out && !may_leave_out)) {
            continue;
        }
        const bool is_right = task == Task::Restore ? name.empty() && end == all.size()
                              : task == Task::Mode  ? name == "RUN" || name == "PROGRAM"
                                                    : is_program_name(name);
        return is_right ? std::optional{Wish{task, verb, name, leaves_out}} : std::nullopt;
    }
    return std::nullopt;
}

ProgramService::ProgramService(Needs needs)
    : ReportingOwner{program_source, needs.log}, needs_{std::move(needs)}
{
}

administration::TemporaryFileTransfer ProgramService::transfer()
{
    const PartRight& right = right_of(AdministeredPart::Program);
    return {.name = std::string{right.name},
            .owner = this,
            .limits = {.max_file_size = ReceivedProgram::max_text,
                       .max_held = 2 * ReceivedProgram::max_text,
                       .max_written = 1},
            .readers = nodes_of(right.see),
            .writers = nodes_of(right.change)};
}

std::string ProgramService::status_text() const
{
    const ProgramInForce now = needs_.program();
    detail::JsonWriter json;
    json.begin_object();
    write_member(json, "name", paths_in_line(now.name));
    write_member(json, "source", now.is_received ? "received" : "file");
    write_member(json, "file", paths_in_line(now.file));
    write_member(json, "user", now.user);
    write_member(json, "received", now.is_received ? to_string(now.time) : "");
    write_member(json, "checksum", controller::detail::checksum_text(*now.text));
    write_member(json, "mode", mode_name(needs_.mode()));
    json.name("bytes");
    json.word(std::to_string(now.text->size()));
    json.name("variables");
    json.word(std::to_string(now.program->program().variables.size()));
    json.name("published");
    json.word(std::to_string(now.published));
    json.name("fileIsOther");
    json.word(needs_.is_file_other() ? "true" : "false");
    write_member(json, "refusal", now.refusal);
    json.end_object();
    return json.take();
}

Result<std::vector<std::byte>> ProgramService::generate(const TransferRequest& request,
                                                        std::size_t max_size)
{
    if (request.options.is_null()) {
        return give(*needs_.program().text, max_size);
    }
    const auto* const wanted = request.options.get_if<String>();
    const std::string_view what = wanted != nullptr ? wanted->view() : std::string_view{};
    return what == "report"   ? give_report(request, max_size)
           : what == "status" ? give(status_text(), max_size)
                              : fail(refuse(status::Bad_InvalidArgument, unknown_options));
}

StatusCode ProgramService::may_take(const TransferRequest& request)
{
    return wish_of(request.options) ? allow()
                                    : refuse(status::Bad_InvalidArgument, unknown_options);
}

std::function<void()> ProgramService::preparation(const TransferRequest& request,
                                                  std::span<const std::byte> bytes)
{
    const auto wish = wish_of(request.options);
    if (!wish || wish->task == Wish::Task::Mode) {
        return {};
    }
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    prepared_ = misconfigured(std::string{wish->verb}, "was not prepared");
    if (wish->task == Wish::Task::Compare) {
        return [this, text, name = std::string{wish->name}, now = needs_.program().program] {
            prepared_ = read_program(text, name, {controller::Unserved::LeaveOut, {}})
                            .transform([&](const SourceFiles::Program& read) {
                                differences_ =
                                    difference_report(differences(read->program(), now->program()));
                                return PreparedProgram{};
                            });
        };
    }
    auto base = needs_.base();
    base.may_leave_out_more = base.may_leave_out_more || wish->leaves_out;
    if (wish->task == Wish::Task::Restore) {
        return [this, base = std::move(base), file = needs_.program().file] {
            prepared_ = prepare_file(base, file);
        };
    }
    return [this, text, base = std::move(base), name = std::string{wish->name}] {
        prepared_ = prepare_program(base, text, name);
    };
}

StatusCode ProgramService::take(const TransferRequest& request, std::span<const std::byte> bytes)
{
    const auto wish = wish_of(request.options);
    if (!wish) {
        return refuse(status::Bad_InvalidArgument, unknown_options);
    }
    const auto done = carry_out(*wish, request.user.name,
                                {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const bool has_changed = wish->task != Wish::Task::Check && wish->task != Wish::Task::Compare;
    if (done && has_changed) {
        tell_changed(request, RecordKind::SettingsChanged);
    }
    return report(request, done, has_changed ? wish->verb : std::string_view{});
}

Configured<std::string> ProgramService::carry_out(const Wish& wish, const std::string& user,
                                                  std::string_view text)
{
    if (wish.has_file()) {
        return wish.task != Wish::Task::Compare ? change(wish, user, text)
               : prepared_                      ? std::exchange(differences_, {})
                           : Configured<std::string>{Unexpected{std::move(prepared_).error()}};
    }
    if (!text.empty()) {
        return misconfigured(std::string{wish.verb}, "found a file, expected an empty one",
                             status::Bad_InvalidArgument);
    }
    return wish.task == Wish::Task::Restore ? restore(wish) : change_mode(wish);
}

Configured<std::string> ProgramService::change(const Wish& wish, const std::string& user,
                                               std::string_view text)
{
    if (!prepared_) {
        return Unexpected{std::move(prepared_).error()};
    }
    using Task = Wish::Task;
    using Step = ProgramChange::Step;
    const Step step = wish.task == Task::Check  ? Step::Check
                      : wish.task == Task::Edit ? Step::Edit
                                                : Step::Download;
    const SourceFiles::Program program = prepared_->files.program;
    const ProgramChange change{
        step, wish.leaves_out,
        document_of({std::string{wish.name}, user, needs_.clock.now(), std::string{text}}),
        *std::move(prepared_)};
    std::string done = report_of(step);
    return needs_.change(change).transform([&](const ProgramVerdict& verdict) {
        return step == Step::Check
                   ? verdict_report(verdict, program->program(), std::string{wish.name})
                   : std::move(done);
    });
}

/// Restores the program by an online edit if that is possible.
Configured<std::string> ProgramService::restore(const Wish& wish)
{
    using Step = ProgramChange::Step;
    if (!needs_.program().is_received) {
        return misconfigured("restore", "the program is the file's already",
                             status::Bad_NothingToDo);
    }
    if (!prepared_) {
        return Unexpected{std::move(prepared_).error()};
    }
    ProgramChange change{.leaves_out = wish.leaves_out, .prepared = *std::move(prepared_)};
    std::string edited = report_of(Step::Edit);
    std::string downloaded = report_of(Step::Download);
    return needs_.change(change).and_then([&](const ProgramVerdict& verdict) {
        const bool is_edit = verdict.is_same || verdict.against_edit.empty();
        change.step = is_edit ? Step::Edit : Step::Download;
        return needs_.change(change).transform(
            [&](const ProgramVerdict&) { return std::move(is_edit ? edited : downloaded); });
    });
}

Configured<std::string> ProgramService::change_mode(const Wish& wish) const
{
    const auto mode =
        wish.name == "RUN" ? controller::MachineMode::Run : controller::MachineMode::Program;
    std::string done = R"({"mode":")" + std::string{wish.name} + R"("})";
    return needs_.set_mode(mode).transform([&] { return std::move(done); });
}

} // namespace busbar::product
