#include "machine_items.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/administration/role_list.hpp>
#include <busbar/administration/setting_list.hpp>
#include <busbar/administration/user_list.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "controller/backup/backup_file.hpp"
#include "machine_files.hpp"
#include "machine_retained.hpp"
#include "product/configuration/setting_keys.hpp"
#include "product/store/received_program.hpp"
#include "program_file.hpp"

namespace busbar::product {

namespace {

using controller::MemoryGroup;
using controller::MemoryItem;

/// Checks that the list can load the file at a start.
template <typename Load>
Configured<void> check_file(std::string_view name, std::span<const std::byte> bytes, Load load)
{
    storage::MemoryStorage memory;
    if (const auto kept = memory.replace(name, bytes, FileAccess::Owner); !kept) {
        return misconfigured(std::string{name}, std::string{text(kept.error())},
                             status_of(kept.error()));
    }
    return load(memory, std::string{name});
}

using administration::SettingValues;
using Bytes = controller::FilePart::Bytes;

/// Parses a file of settings; nothing if it has no bytes.
Configured<SettingValues> values_in(const Settings& settings, std::span<const std::byte> bytes)
{
    if (bytes.empty()) {
        return SettingValues{};
    }
    SettingValues values;
    const auto read =
        check_file(Settings::file_name, bytes, [&](Storage& memory, std::string file) {
            const auto all = settings.list().settings();
            administration::SettingList list{memory, std::move(file), {all.begin(), all.end()}};
            auto loaded = list.load();
            values = list.changes();
            return loaded;
        });
    return read.transform([&] { return std::move(values); });
}

Bytes settings_bytes(const SettingValues& values)
{
    if (values.empty()) {
        return {};
    }
    const std::string document = administration::settings_document(values);
    const auto bytes = std::as_bytes(std::span{document});
    return {bytes.begin(), bytes.end()};
}

/// True for settings in which a file refers to its machine.
bool is_of_machine(std::string_view name)
{
    constexpr std::array<std::string_view, 4> names{"server.address", "server.host_names",
                                                    "server.nodesets", "limits.preset"};
    return std::ranges::find(names, name) != names.end();
}

/// The file's values of all settings; nothing if the file is not valid with any program that was
/// sent.
SettingValues file_values(const Settings& settings)
{
    try {
        return settings.all_values({});
    } catch (const ConfigError&) {
        return {};
    }
}

/// The values in the present file, which may not have been read yet; nothing if it is not valid.
SettingValues unread_values(const Settings& settings)
{
    try {
        return settings.values_on_disk();
    } catch (const ConfigError&) {
        return {};
    }
}

/// All settings with these changes, without those of the file that refer to its machine.
SettingValues all_values(const Settings& settings, SettingValues changes)
{
    SettingValues all;
    if (changes == settings.list().changes()) {
        for (const administration::Setting& each : settings.list().settings()) {
            all.emplace(each.name, settings.value(each));
        }
    } else {
        all = file_values(settings);
    }
    std::erase_if(all, [&](const auto& each) { return is_of_machine(each.first); });
    changes.merge(all); // keep the spelling of the changes
    return changes;
}

/// The program that a restore is about to install, for checking the settings that come with it.
struct Next {
    /// Whether `text` differs from that of the configuration's file.
    enum class Kind : std::uint8_t { Stays, OfFile, Received };

    [[nodiscard]] SourceFiles sources(const Settings& settings) const
    {
        const SourceFiles& now = settings.sources();
        if (kind == Kind::Stays) {
            return now;
        }
        SourceFiles::Prepared known;
        if (is_prepared(text)) {
            known = prepared->prepared;
            known.text = std::make_shared<const std::string>(text);
        }
        return now.with_program(kind == Kind::Received ? std::optional{document} : std::nullopt,
                                settings.config().machine.program_file, std::move(known));
    }
    [[nodiscard]] bool is_prepared(const std::string& program) const
    {
        return prepared != nullptr && prepared->prepared.program != nullptr &&
               prepared->text == program;
    }

    Kind kind{Kind::Stays};
    std::string document{};
    std::string text{};
    std::shared_ptr<const RestoredProgram> prepared;
};
using NextProgram = std::shared_ptr<Next>;

/// The settings of the security profile, or all others.
controller::FilePart settings_part(const Settings& settings, bool is_of_profile,
                                   const NextProgram& program)
{
    const auto is_other = [is_of_profile](const SettingValues::value_type& each) {
        return is_security_setting(each.first) != is_of_profile;
    };
    controller::FilePart part{.file = Settings::file_name};
    part.take = [&settings, is_other,
                 program](std::span<const std::byte> whole) -> Configured<Bytes> {
        program->kind = Next::Kind::Stays; // items of a backup are read before any is installed
        auto values = values_in(settings, whole).transform([&](SettingValues changes) {
            return all_values(settings, std::move(changes));
        });
        if (!values) {
            return Unexpected{std::move(values.error())};
        }
        std::erase_if(*values, is_other);
        return settings_bytes(*values);
    };
    part.put = [&settings, is_other](std::span<const std::byte> whole,
                                     std::span<const std::byte> own) -> Configured<Bytes> {
        auto all = values_in(settings, whole);
        auto values = values_in(settings, own);
        if (!all || !values) {
            return Unexpected{std::move(all ? values.error() : all.error())};
        }
        std::erase_if(*all, [&](const auto& each) { return !is_other(each); });
        const SettingValues of_file = file_values(settings);
        const SettingValues unread = unread_values(settings);
        const auto is_said_by = [](const SettingValues& file, const auto& each) {
            const auto said = file.find(each.first);
            return said != file.end() && said->second == each.second;
        };
        // The restart reads the file again, so a value that it would change must be kept.
        std::erase_if(*values, [&](const auto& each) {
            return is_other(each) || (is_said_by(of_file, each) && is_said_by(unread, each));
        });
        all->merge(*values);
        return settings_bytes(*all);
    };
    return part;
}

MemoryItem settings_item(const Settings& settings, std::string name, std::string file,
                         MemoryGroup group, const NextProgram& program)
{
    MemoryItem item{.name = std::move(name), .group = group, .files = {std::move(file)}};
    item.part = settings_part(settings, group == MemoryGroup::SecurityProfile, program);
    item.check = [&settings, program](std::string_view, std::span<const std::byte> bytes) {
        return values_in(settings, bytes).and_then([&](const SettingValues& values) {
            return settings.check_restored(values, program->sources(settings));
        });
    };
    return item;
}

/// Makes a document that is equal for equal programs, regardless of sender and time.
std::string plain_document(std::string name, std::string text)
{
    return document_of({.name = std::move(name), .user = {}, .time = {}, .text = std::move(text)});
}

constexpr const char* program_name = "Program";

std::string name_of_received()
{
    return std::string{ReceivedProgram::file_name};
}

std::string_view text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Bytes copy_of(std::string_view text)
{
    const auto bytes = std::as_bytes(std::span{text});
    return {bytes.begin(), bytes.end()};
}

Configured<std::string> plain_document(std::span<const std::byte> received)
{
    return read_received(text_of(received), name_of_received())
        .transform([](ReceivedProgram program) {
            return plain_document(std::move(program.name), std::move(program.text));
        });
}

/// The document of the configured file, as `sources` have it; empty if there is none.
std::string file_document(const Settings& settings, SourceFiles sources)
{
    const std::string& file = settings.config().machine.program_file;
    const auto text = sources.program_text(file, ReceivedProgram::max_text);
    const std::string name = program_name_of(file);
    return text && is_program_name(name) ? plain_document(name, **text) : std::string{};
}

/// In a backup, the program of the configured file looks like a received one.
MemoryItem program_item(const Settings& settings, const NextProgram& next)
{
    const std::string name = name_of_received();
    MemoryItem item{.name = program_name, .group = MemoryGroup::ServerSettings, .files = {name}};
    controller::FilePart part{.file = name};
    part.take = [&settings](std::span<const std::byte> whole) -> Configured<Bytes> {
        if (whole.empty()) {
            const bool is_there = settings.config().machine.program != nullptr;
            return is_there ? copy_of(file_document(settings, settings.sources())) : Bytes{};
        }
        return plain_document(whole).transform(copy_of);
    };
    part.put = [&settings, next](std::span<const std::byte>,
                                 std::span<const std::byte> own) -> Configured<Bytes> {
        const bool is_of_file = own.empty() || text_of(own) == file_document(settings, {});
        next->kind = is_of_file ? Next::Kind::OfFile : Next::Kind::Received;
        next->document = text_of(own);
        next->text = read_received(next->document, name_of_received())
                         .transform([](ReceivedProgram program) { return std::move(program.text); })
                         .value_or(std::string{});
        return is_of_file ? Bytes{} : Bytes{own.begin(), own.end()};
    };
    item.part = std::move(part);
    item.check = [next, &settings](std::string_view, std::span<const std::byte> bytes) {
        const ProgramReading reading = settings.config().machine.reading;
        return read_received(text_of(bytes), name_of_received())
            .and_then([&](const ReceivedProgram& program) {
                return next->is_prepared(program.text)
                           ? Configured<void>{}
                           : read_program(program.text, program.name, reading)
                                 .transform([](const auto&) {});
            });
    };
    return item;
}

MemoryItem users_item(const Settings& settings)
{
    MemoryItem item{
        .name = "Users", .group = MemoryGroup::SecurityProfile, .files = {"users.json"}};
    item.check = [&settings](std::string_view name, std::span<const std::byte> bytes) {
        return check_file(name, bytes, [&](Storage& memory, std::string file) {
            server::PasswordUsers nobody;
            administration::UserList list{memory, std::move(file),
                                          settings.config().users.password_rules, nobody};
            return list.load();
        });
    };
    return item;
}

MemoryItem roles_item()
{
    MemoryItem item{
        .name = "Roles", .group = MemoryGroup::SecurityProfile, .files = {"roles.json"}};
    item.check = [](std::string_view name, std::span<const std::byte> bytes) {
        return check_file(name, bytes, [](Storage& memory, std::string file) {
            return administration::RoleList{memory, std::move(file)}.load();
        });
    };
    return item;
}

/// Takes any file of these folders: the stores ignore those that are not certificates.
MemoryItem certificates_item(std::string name, std::vector<std::string> folders)
{
    return {.name = std::move(name),
            .group = MemoryGroup::SecurityProfile,
            .folders = std::move(folders),
            .access = FileAccess::Everyone};
}

} // namespace

void prepare_restored(const ProgramBase& base, std::span<const std::byte> backup,
                      RestoredProgram& program)
{
    program = {};
    const auto memory = controller::detail::read_backup(backup, {});
    if (!memory) {
        return;
    }
    for (const controller::detail::SavedItem& item : memory->items) {
        if (item.name != program_name || item.files.size() != 1) {
            continue;
        }
        auto received = read_received(text_of(item.files.front().bytes), name_of_received());
        auto prepared = received ? prepare_program(base, received->text, received->name)
                                 : Configured<PreparedProgram>{Unexpected{received.error()}};
        if (prepared) {
            program = {std::move(received->text), std::move(prepared->files)};
        }
    }
}

std::vector<MemoryItem> machine_items(Settings& settings, Storage& state,
                                      std::shared_ptr<RestoredProgram> prepared)
{
    const auto program = std::make_shared<Next>(Next{.prepared = std::move(prepared)});
    return {settings_item(settings, "Server settings", Settings::file_name,
                          MemoryGroup::ServerSettings, program),
            program_item(settings, program),
            values_item(state),
            certificates_item("Client certificates", {"trusted/certs"}),
            certificates_item("CA certificates", {"issuers/certs"}),
            certificates_item("Certificate revocation lists", {"trusted/crl", "issuers/crl"}),
            certificates_item("User certificates", {"users/trusted/certs", "users/trusted/crl",
                                                    "users/issuers/certs", "users/issuers/crl"}),
            settings_item(settings, "Security settings", "security-settings.json",
                          MemoryGroup::SecurityProfile, program),
            users_item(settings),
            roles_item(),
            {.name = "Event log",
             .group = MemoryGroup::EventLog,
             .folders = {std::string{MachineFiles::event_folder}}},
            {.name = "Server certificate",
             .group = MemoryGroup::ServerCertificate,
             .files = {"setup.code"},
             .folders = {"own/certs", "own/private", "own/crl", "own/replaced", "rejected/certs",
                         "rejected/crl", "users/rejected/certs", "users/rejected/crl"}}};
}

} // namespace busbar::product
