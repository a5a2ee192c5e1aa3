#include "start.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/administration/role_list.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/access/administered.hpp"
#include "product/configuration/toml.hpp"
#include "product/configuration/toml_reader.hpp"
#include "product/machine/program_change.hpp"
#include "product/machine/program_file.hpp"
#include "product/store/received_program.hpp"
#include "startup.hpp"

namespace busbar::product {

namespace {

/// The parts of a TakenOver to use.
struct Way {
    /// All files except the received program.
    bool takes_files;
    bool takes_received;
    bool takes_settings;
    bool takes_project;
};

/// A received program that can be read is used; the first way is for a damaged one.
constexpr std::array ways{Way{false, true, false, false}, Way{true, false, false, false},
                          Way{true, true, false, false},  Way{false, false, true, false},
                          Way{false, false, false, true}, Way{true, true, true, true}};

/// Returns the first lines of a text, up to this one, counted from 1.
std::string_view lines_before(std::string_view text, std::size_t line)
{
    std::size_t end = 0;
    for (; line > 1 && end < text.size(); --line) {
        end = std::min(text.find('\n', end), text.size() - 1) + 1;
    }
    return text.substr(0, end);
}

/// Returns the folder of certificates as far as the file can be read: up to the first line that is
/// not TOML.
std::string kept_in(const Configuration& configuration)
{
    try {
        SourceFiles sources;
        const std::string text = read_config_text(configuration.file, sources);
        auto table = parse_toml(text);
        if (!table) {
            table = parse_toml(lines_before(text, table.error().line));
        }
        return certificate_folder(table ? *table : toml::table{});
    } catch (const ConfigError&) {
        return certificate_folder(toml::table{});
    }
}

/// Returns the files of the last run with the program that was received since, or without one: the
/// user who sent it or took it back was told that this is done.
SourceFiles::Texts with_received(SourceFiles::Texts files, Storage& folder)
{
    const std::string place = folder.place(ReceivedProgram::file_name);
    const auto bytes = read_file(folder, ReceivedProgram::file_name, ReceivedProgram::max_size);
    if (bytes) {
        files[place] = std::make_shared<const std::string>(
            reinterpret_cast<const char*>(bytes->data()), bytes->size());
    } else if (bytes.error() == StorageError::NotFound) {
        files.erase(place);
    }
    return files;
}

/// Returns true if a program was received and the file has become damaged.
bool has_damaged_received(Storage& folder)
{
    const auto bytes = read_file(folder, ReceivedProgram::file_name, ReceivedProgram::max_size);
    if (!bytes) {
        return bytes.error() != StorageError::NotFound;
    }
    const std::string_view document{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    return !read_received(document, {}).has_value();
}

/// Returns only the program that was received when the files were taken over.
SourceFiles::Texts received_alone(const SourceFiles::Texts& files, Storage& folder)
{
    const auto received = files.find(folder.place(ReceivedProgram::file_name));
    return received != files.end() ? SourceFiles::Texts{*received} : SourceFiles::Texts{};
}

/// Throws ConfigError if the program of a file leaves out more than the one that ran last: the
/// controller goes on with that one.
void check_left_out(const ControllerConfig& config, const TakenOver& last)
{
    using AnyProgram = std::shared_ptr<const controller::Program>;
    constexpr auto lenient = controller::Unserved::LeaveOut;
    const auto check = [&](const controller::Program& program, const std::string& file,
                           const std::string& text, const auto& read_before) {
        const auto found = last.files.find(file);
        if (program.left_out.empty() || found == last.files.end() || *found->second == text) {
            return;
        }
        if (const Configured<AnyProgram> before = read_before(*found->second, file)) {
            expect(product::check_left_out(**before, program, file));
        }
    };
    const MachineConfig& machine = config.machine;
    if (machine.program != nullptr && machine.program_name == machine.program_file &&
        !machine.may_leave_out_more) {
        check(machine.program->program(), machine.program_file, *machine.program_text,
              [&](const std::string& text, const std::string& file) {
                  return read_program(text, file,
                                      {.unserved = lenient, .encoding = machine.reading.encoding})
                      .transform([](const auto& read) {
                          return AnyProgram{read, &read->program()};
                      });
              });
    }
    const LabelConfig& labels = config.labels;
    if (labels.program != nullptr && !labels.may_leave_out_more) {
        check(*labels.program, labels.program_file, *labels.program_text,
              [&](const std::string& text, const std::string& file) {
                  return read_labels(text, file,
                                     {.unserved = lenient, .encoding = labels.reading.encoding});
              });
    }
}

/// Replaces the present settings, which are kept beside the others. Without use() they are restored
/// in the end.
class OtherSettings {
public:
    OtherSettings(Storage& folder, std::string_view document) : folder_{folder}
    {
        constexpr std::size_t most = 64U << 20U;
        constexpr std::string_view refused = "settings.json.refused";
        if (auto there = read_file(folder_, Settings::file_name, most)) {
            before_ = *std::move(there);
            if (!folder_.replace(refused, *before_, FileAccess::Owner)) {
                return; // nothing is lost, but this way fails
            }
        }
        static_cast<void>(put(std::as_bytes(std::span{document})));
    }
    OtherSettings(const OtherSettings&) = delete;
    OtherSettings& operator=(const OtherSettings&) = delete;
    ~OtherSettings()
    {
        if (is_used_) {
            return;
        }
        static_cast<void>(before_ ? put(*before_) : folder_.remove(Settings::file_name));
    }
    void use() { is_used_ = true; }

private:
    Stored<void> put(std::span<const std::byte> bytes)
    {
        return folder_.replace(Settings::file_name, bytes, FileAccess::Owner);
    }

    Storage& folder_;
    std::optional<std::vector<std::byte>> before_;
    bool is_used_{false};
};

/// Handles damaged lists of users and roles, so that a machine can start without giving any user
/// more rights. A damaged list is kept beside it as .refused, and its last good copy is used.
/// Without a copy its users are not admitted, or all roles but SecurityAdmin are closed.
class DamagedLists {
public:
    explicit DamagedLists(Storage& folder) : folder_{folder} {}

    /// Roles that this configuration gives to tokens are closed with the well-known ones.
    void give(const UserConfig& users)
    {
        given_.clear();
        if (users.tokens) {
            for (const auto& [role, access] : users.tokens->roles) {
                given_.push_back(role);
            }
        }
    }
    /// Replaces the list that the problem is about, and describes what was done; nothing if it is
    /// about something else, or the Storage refuses.
    std::optional<std::string> replace(const Problem& problem)
    {
        for (const char* const name : {Administered::users_file, Administered::roles_file}) {
            if (problem.where.starts_with(folder_.place(name))) {
                return set_aside(name) ? put_other(name) : std::nullopt;
            }
        }
        return std::nullopt;
    }

private:
    /// A list stays until it is replaced: without a list of roles there are no restrictions.
    bool set_aside(const std::string& name)
    {
        constexpr std::size_t most = 64U << 20U;
        const auto bytes = read_file(folder_, name, most);
        return bytes && folder_.replace(name + ".refused", *bytes, FileAccess::Owner);
    }
    std::optional<std::string> put_other(const std::string& name)
    {
        const auto times = std::ranges::count(replaced_, name);
        if (times > 1) {
            return std::nullopt;
        }
        replaced_.push_back(name);
        const auto copy = times == 0 ? TakenOverFiles{folder_}.copy(name) : std::nullopt;
        if (copy) {
            return put(name, *copy, ", and its last good copy is used");
        }
        if (name == Administered::roles_file) {
            return put(name, administration::RoleList::closed_document(given_),
                       " and is not used; every role but SecurityAdmin is closed until an "
                       "administrator opens it");
        }
        return folder_.remove(name) ? std::optional<std::string>{" and is not used"} : std::nullopt;
    }
    std::optional<std::string> put(const std::string& name, std::string_view document,
                                   const char* done)
    {
        const auto bytes = std::as_bytes(std::span{document});
        return folder_.replace(name, bytes, FileAccess::Owner) ? std::optional<std::string>{done}
                                                               : std::nullopt;
    }

    Storage& folder_;
    std::vector<std::string> given_;
    std::vector<std::string> replaced_;
};

/// Calls `make` until no damaged list is in its way, each time with a description of what was done
/// about them.
std::unique_ptr<RunningController>
without_damaged(DamagedLists& lists,
                FunctionRef<std::unique_ptr<RunningController>(const std::string& damage)> make)
{
    std::string damage;
    for (;;) {
        try {
            return make(damage);
        } catch (const ConfigError& error) {
            const auto done = lists.replace(error.problem());
            if (!done) {
                throw;
            }
            damage += (damage.empty() ? "" : "; ") + std::string{error.what()} +
                      ", which is kept beside it as .refused" + *done;
        }
    }
}

/// Creates a controller from its starting point.
using Make = FunctionRef<std::unique_ptr<RunningController>(Beginning beginning)>;

std::unique_ptr<RunningController> start_by(const Way& way, const Configuration& configuration,
                                            const TakenOver& last, Storage& folder,
                                            const std::string& refusal, const std::string& damage,
                                            Make make)
{
    Substitutes substitutes{.project = last.project_text(),
                            .takes_other_project = way.takes_project};
    if (way.takes_files) {
        substitutes.files =
            SourceFiles{way.takes_received ? last.files : with_received(last.files, folder)};
    } else if (way.takes_received) {
        substitutes.files = SourceFiles{received_alone(last.files, folder)};
    }
    std::optional<OtherSettings> settings;
    if (way.takes_settings && last.settings) {
        settings.emplace(folder, *last.settings);
    }
    auto controller = make({read(configuration, std::move(substitutes)), last, refusal, damage});
    if (settings) {
        settings->use();
    }
    return controller;
}

} // namespace

std::unique_ptr<RunningController> start(const Configuration& configuration, Runtime& runtime,
                                         LogSink& log, const ControllerOptions& options,
                                         controller::ThreadMaker& threads)
{
    storage::FolderStorage folder{kept_in(configuration)};
    DamagedLists lists{folder};
    const auto make = [&](Beginning beginning) {
        lists.give(beginning.reading.config.users);
        return std::make_unique<RunningController>(configuration, std::move(beginning), runtime,
                                                   log, options, threads);
    };
    auto last = TakenOverFiles{folder}.read();
    if (last && !configuration.file.empty() && !last->files.contains(configuration.file)) {
        last.reset(); // it belongs to another controller with the same folder
    }
    try {
        return without_damaged(lists, [&](const std::string& damage) {
            Substitutes substitutes{.project = last ? last->project_text() : std::string{}};
            Reading reading = read(configuration, std::move(substitutes));
            if (last) {
                check_left_out(reading.config, *last);
            }
            return make({std::move(reading), last, {}, damage});
        });
    } catch (const ConfigError& error) {
        if (!last) {
            throw;
        }
        const bool is_damaged = has_damaged_received(folder);
        for (const Way& way : ways) {
            if (&way == ways.data() && !is_damaged) {
                continue;
            }
            try {
                return without_damaged(lists, [&](const std::string& damage) {
                    return start_by(way, configuration, *last, folder, error.what(), damage, make);
                });
            } catch (const ConfigError&) {
                // Try the next way; the first reason is the one to report.
            }
        }
        throw;
    }
}

} // namespace busbar::product
