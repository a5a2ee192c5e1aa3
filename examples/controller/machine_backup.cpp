#include "machine_backup.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

#include "core/json_writer.hpp"

namespace busbar::example {

using administration::TransferRequest;

namespace {

/// The one that administration::finish_changes looks after.
constexpr const char* transaction = "transaction";
constexpr const char* source = "memory";

std::string problem_report(const Problem& problem)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("problem");
    json.string(text(problem));
    json.end_object();
    return json.take();
}

std::string flag_report(std::string_view name, bool flag)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name(name);
    json.word(flag ? "true" : "false");
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

std::vector<std::byte> bytes_of_text(std::string_view text)
{
    const auto bytes = std::as_bytes(std::span{text.data(), text.size()});
    return {bytes.begin(), bytes.end()};
}

} // namespace

struct MachineBackup::Wish {
    enum class Task : std::uint8_t { Restore, Verify, Clear };

    Task task;
    bool with_security;
};

std::optional<MachineBackup::Wish> MachineBackup::wish_of(const Variant& options)
{
    using Task = Wish::Task;
    static constexpr std::array<std::pair<std::string_view, Wish>, 6> wishes{
        {{"restore", {Task::Restore, true}},
         {"restore without security profile", {Task::Restore, false}},
         {"verify", {Task::Verify, true}},
         {"verify without security profile", {Task::Verify, false}},
         {"clear", {Task::Clear, false}},
         {"clear with security", {Task::Clear, true}}}};
    const auto* const text = options.get_if<String>();
    const auto found = std::find_if(wishes.begin(), wishes.end(), [&](const auto& each) {
        return text != nullptr && text->view() == each.first;
    });
    return found != wishes.end() ? std::optional{found->second} : std::nullopt;
}

MachineBackup::MachineBackup(Needs needs)
    : needs_{std::move(needs)}, memory_{needs_.files, transaction, needs_.items, needs_.log}
{
}

administration::TemporaryFileTransfer MachineBackup::transfer()
{
    const NodeId administrator{0, id::WellKnownRole_SecurityAdmin};
    return {
        .name = "Backup", .owner = this, .readers = {administrator}, .writers = {administrator}};
}

Result<std::vector<std::byte>> MachineBackup::generate(const TransferRequest& request,
                                                       std::size_t max_size)
{
    if (request.options.is_null()) {
        auto made = make_backup();
        const bool is_too_large = made && made->size() > max_size;
        return is_too_large ? fail(status::Bad_EncodingLimitsExceeded) : std::move(made);
    }
    const auto* const what = request.options.get_if<String>();
    if (what == nullptr || what->view() != "report") {
        return fail(status::Bad_InvalidArgument);
    }
    if (report_.text.empty() || report_.session != request.session) {
        return fail(status::Bad_NotFound);
    }
    return bytes_of_text(report_.text);
}

Result<std::vector<std::byte>> MachineBackup::make_backup()
{
    Configured<std::vector<std::byte>> made;
    needs_.gate.hold([&] {
        needs_.hold_events([&] { made = memory_.backup({needs_.controller, needs_.clock.now()}); });
    });
    if (!made) {
        needs_.log.write(LogLevel::Error, source, "no backup was made: " + text(made.error()));
        return fail(made.error().status);
    }
    needs_.log.write(LogLevel::Info, source,
                     "a backup was made: " + std::to_string(made->size()) + " bytes");
    return *std::move(made);
}

StatusCode MachineBackup::may_take(const TransferRequest& request)
{
    const auto wish = wish_of(request.options);
    if (!wish) {
        return status::Bad_InvalidArgument;
    }
    const bool is_run = needs_.mode() == controller::MachineMode::Run;
    const bool is_refused = (wish->task == Wish::Task::Clear && is_run) ||
                            (wish->task != Wish::Task::Verify && needs_.gate.is_closed());
    return is_refused ? status::Bad_InvalidState : status::Good;
}

StatusCode MachineBackup::take(const TransferRequest& request, std::span<const std::byte> bytes)
{
    // Things may have changed since the client began.
    if (const StatusCode may = may_take(request); may.is_bad()) {
        return may;
    }
    const auto done = carry_out(*wish_of(request.options), bytes);
    report_ = {request.session, done ? *done : problem_report(done.error())};
    if (!done) {
        needs_.log.write(LogLevel::Error, source,
                         request.options.get_if<String>()->str() +
                             ": nothing was changed: " + text(done.error()));
    }
    return done ? StatusCode{status::Good} : done.error().status;
}

Configured<std::string> MachineBackup::carry_out(const Wish& wish, std::span<const std::byte> bytes)
{
    Configured<std::string> done;
    needs_.gate.hold([&] {
        switch (wish.task) {
        case Wish::Task::Restore:
            done = restore(wish, bytes);
            break;
        case Wish::Task::Verify:
            done = verify(wish, bytes);
            return;
        case Wish::Task::Clear:
            done = bytes.empty() ? clear(wish)
                                 : misconfigured("clear", "found a file, expected an empty one",
                                                 status::Bad_InvalidArgument);
            break;
        }
        if (done) {
            needs_.gate.close(); // what the server has in memory counts no more
        }
    });
    if (done && wish.task != Wish::Task::Verify) {
        needs_.replaced();
    }
    return done;
}

Configured<std::string> MachineBackup::restore(const Wish& wish, std::span<const std::byte> bytes)
{
    const auto restored = memory_.restore(bytes, {.security_profile = wish.with_security});
    if (!restored) {
        return tl::unexpected{restored.error()};
    }
    const bool has_data = *restored == controller::Restored::Data;
    needs_.log.write(LogLevel::Info, source,
                     std::string{has_data ? "restored from a backup"
                                          : "cleared: the backup is of a controller without OPC UA "
                                            "server"} +
                         "; it counts after a restart, which is due");
    return flag_report("restored", has_data);
}

Configured<std::string> MachineBackup::verify(const Wish& wish,
                                              std::span<const std::byte> bytes) const
{
    return memory_.verify(bytes, {.security_profile = wish.with_security}).map(report_of);
}

Configured<std::string> MachineBackup::clear(const Wish& wish)
{
    return memory_.clear_all(wish.with_security, needs_.mode()).map([&] {
        needs_.log.write(LogLevel::Info, source,
                         "all memory was cleared; it counts after a restart, which is due");
        return flag_report("cleared", true);
    });
}

} // namespace busbar::example
