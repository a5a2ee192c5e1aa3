#include "machine_backup.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/status_codes.hpp>

#include "core/json_writer.hpp"
#include "product/access/part_rights.hpp"

namespace busbar::product {

using administration::TransferRequest;

namespace {

/// The name of the transaction that administration::finish_changes recovers.
constexpr const char* transaction = "transaction";
constexpr const char* source = "memory";
/// Precedes the text of a RestoreCommand.ini.
constexpr std::string_view by_command = "restore by command\n";

/// `variable` is there if a variable of the program has decided.
std::string restore_report(bool has_data, bool lacks_profile, std::optional<bool> variable)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("restored");
    json.word(has_data ? "true" : "false");
    if (lacks_profile) {
        json.name("security_profile");
        json.word("false");
    }
    if (variable) {
        json.name(controller::restore_target_variable);
        json.word(*variable ? "true" : "false");
    }
    json.end_object();
    return json.take();
}

std::string report_of(const std::vector<controller::VerifiedItem>& items)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("items");
    json.begin_list();
    for (const controller::VerifiedItem& item : items) {
        json.begin_object();
        json.name("name");
        json.string(item.name);
        json.name("differences");
        json.begin_list();
        for (const std::string& file : item.differences) {
            json.string(file);
        }
        json.end_list();
        json.end_object();
    }
    json.end_list();
    json.end_object();
    return json.take();
}

} // namespace

struct MachineBackup::Wish {
    enum class Task : std::uint8_t { Restore, Verify, Clear };

    Task task;
    bool with_security;
    /// The program decides on the security profile.
    bool is_by_variable{false};
};

Configured<MachineBackup::Wish> MachineBackup::wish_of(const Variant& options)
{
    using Task = Wish::Task;
    const auto* const text = options.get_if<String>();
    if (text != nullptr && text->view().starts_with(by_command)) {
        return controller::read_restore_command(text->view().substr(by_command.size()))
            .transform([](const controller::RestoreChoice& choice) {
                return Wish{.task = Task::Restore, .with_security = choice.security_profile};
            });
    }
    static constexpr std::array<std::pair<std::string_view, Wish>, 7> wishes{
        {{"restore", {Task::Restore, true}},
         {"restore without security profile", {Task::Restore, false}},
         {"restore by variable", {Task::Restore, false, true}},
         {"verify", {Task::Verify, true}},
         {"verify without security profile", {Task::Verify, false}},
         {"clear", {Task::Clear, false}},
         {"clear with security", {Task::Clear, true}}}};
    const auto* const found = std::find_if(wishes.begin(), wishes.end(), [&](const auto& each) {
        return text != nullptr && text->view() == each.first;
    });
    return found != wishes.end() ? Configured<Wish>{found->second}
                                 : misconfigured("options", "found an unknown option of a backup",
                                                 status::Bad_InvalidArgument);
}

MachineBackup::MachineBackup(Needs needs)
    : ReportingOwner{source, needs.log}, needs_{std::move(needs)}, memory_{needs_.files,
                                                                           transaction,
                                                                           needs_.items, needs_.log}
{
}

administration::TemporaryFileTransfer MachineBackup::transfer()
{
    const PartRight& right = right_of(AdministeredPart::Backup);
    constexpr std::size_t max_size = controller::MemoryLimits{}.max_backup_size;
    return {.name = std::string{right.name},
            .owner = this,
            .limits = {.max_file_size = max_size, .max_held = 2 * max_size},
            .readers = nodes_of(right.see),
            .writers = nodes_of(right.change)};
}

Result<std::vector<std::byte>> MachineBackup::generate(const TransferRequest& request,
                                                       std::size_t max_size)
{
    const auto* const what = request.options.get_if<String>();
    const bool is_without = what != nullptr && what->view() == "backup without security profile";
    if (request.options.is_null() || is_without) {
        auto made = make_backup({.security_profile = !is_without});
        const bool is_too_large = made && made->size() > max_size;
        return is_too_large ? fail(refuse(status::Bad_EncodingLimitsExceeded,
                                          "the backup would be larger than " +
                                              std::to_string(max_size) + " bytes"))
                            : std::move(made);
    }
    if (what == nullptr || what->view() != "report") {
        return fail(refuse(status::Bad_InvalidArgument, "found an unknown option of a backup"));
    }
    return give_report(request, max_size);
}

Result<std::vector<std::byte>> MachineBackup::make_backup(const controller::BackupChoice& choice)
{
    Configured<std::vector<std::byte>> made;
    needs_.gate.hold([&] {
        needs_.hold_files([&] {
            made = memory_.backup({needs_.controller, needs_.clock.now()}, choice);
        });
    });
    if (!made) {
        needs_.log.write(LogLevel::Error, source, "no backup was made: " + text(made.error()));
        return fail(refuse(made.error().status, text(made.error())));
    }
    needs_.log.write(LogLevel::Info, source,
                     "a backup was made: " + std::to_string(made->size()) + " bytes");
    return *std::move(made);
}

StatusCode MachineBackup::may_take(const TransferRequest& request)
{
    const auto wish = wish_of(request.options);
    if (!wish) {
        static_cast<void>(report(request, Unexpected{wish.error()}, {}));
        return status::Bad_InvalidArgument;
    }
    if (wish->task != Wish::Task::Verify && needs_.gate.is_closed()) {
        return refuse(status::Bad_InvalidState,
                      "a restart of the controller is due; its memory does not change before that");
    }
    if (wish->task == Wish::Task::Clear && needs_.mode() == controller::MachineMode::Run) {
        return refuse(status::Bad_InvalidState, "the machine is in RUN, where its memory is not "
                                                "cleared; set machine.mode to PROGRAM first");
    }
    return allow();
}

StatusCode MachineBackup::take(const TransferRequest& request, std::span<const std::byte> bytes)
{
    // The state may have changed since the client began.
    if (const StatusCode may = may_take(request); may.is_bad()) {
        return may;
    }
    auto wish = wish_of(request.options);
    const auto done = carry_out(*wish, bytes);
    if (done && wish->task != Wish::Task::Verify) {
        tell_replaced(request, wish->with_security);
    }
    const std::string_view options = request.options.get_if<String>()->view();
    return report(request, done, options.substr(0, options.find('\n')));
}

/// One record for each kind that OPC UA knows.
void MachineBackup::tell_replaced(const TransferRequest& request, bool with_security) const
{
    tell_changed(request, RecordKind::SettingsChanged);
    if (with_security) {
        tell_changed(request, RecordKind::UsersChanged);
        tell_changed(request, RecordKind::RolesChanged);
        tell_changed(request, RecordKind::TrustListUpdated);
    }
}

std::function<void()> MachineBackup::preparation(const TransferRequest& request,
                                                 std::span<const std::byte> bytes)
{
    const auto wish = wish_of(request.options);
    const bool restores = wish && wish->task == Wish::Task::Restore;
    return restores && needs_.preparation ? needs_.preparation(bytes) : std::function<void()>{};
}

Configured<std::string> MachineBackup::carry_out(Wish& wish, std::span<const std::byte> bytes)
{
    Configured<std::string> done;
    needs_.gate.hold([&] {
        switch (wish.task) {
        case Wish::Task::Restore:
            needs_.hold_files([&] {
                done = restore(wish, bytes);
                if (done) {
                    values_replaced();
                }
            });
            break;
        case Wish::Task::Verify:
            done = verify(wish, bytes);
            return;
        case Wish::Task::Clear:
            needs_.hold_files([&] {
                done = bytes.empty() ? clear(wish)
                                     : misconfigured("clear", "found a file, expected an empty one",
                                                     status::Bad_InvalidArgument);
                if (done) {
                    values_replaced();
                }
            });
            break;
        }
        if (done) {
            needs_.gate.close(); // the server's state in memory is no longer valid
        }
    });
    if (done && wish.task != Wish::Task::Verify) {
        busbar::detail::guarded(needs_.log, source, needs_.replaced);
    }
    return done;
}

void MachineBackup::values_replaced() const
{
    busbar::detail::guarded(needs_.log, source, needs_.values_replaced);
}

Configured<std::string> MachineBackup::restore(Wish& wish, std::span<const std::byte> bytes)
{
    std::optional<bool> variable;
    if (wish.is_by_variable) {
        variable = needs_.restores_profile();
        wish.with_security = *variable;
    }
    const auto restored = memory_.restore(bytes, {.security_profile = wish.with_security});
    if (!restored) {
        return Unexpected{restored.error()};
    }
    const bool has_data = *restored != controller::Restored::Nothing;
    const bool lacks_profile = *restored == controller::Restored::WithoutProfile;
    wish.with_security = wish.with_security && !lacks_profile;
    // The files are replaced: a lack of memory from here on costs the line or the report.
    Configured<std::string> report;
    busbar::detail::attempt([&] {
        needs_.log.write(LogLevel::Info, source,
                         std::string{has_data ? "restored from a backup"
                                              : "cleared: the backup is of a controller without "
                                                "OPC UA server"} +
                             (lacks_profile ? ", which has no security profile" : "") +
                             (!variable   ? ""
                              : *variable ? ", with the security profile, as the program says"
                                          : ", without the security profile, as the program says") +
                             "; it takes effect after a restart, which is due");
    });
    busbar::detail::attempt([&] { report = restore_report(has_data, lacks_profile, variable); });
    return report;
}

Configured<std::string> MachineBackup::verify(const Wish& wish,
                                              std::span<const std::byte> bytes) const
{
    return memory_.verify(bytes, {.security_profile = wish.with_security}).transform(report_of);
}

Configured<std::string> MachineBackup::clear(const Wish& wish)
{
    std::string report = R"({"cleared":true})";
    return memory_.clear_all(wish.with_security, needs_.mode()).transform([&] {
        busbar::detail::write_safely(
            needs_.log, LogLevel::Info, source,
            "all memory was cleared; it takes effect after a restart, which is due");
        return std::move(report);
    });
}

} // namespace busbar::product
