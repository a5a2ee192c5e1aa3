#include "describe.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/controller/machine_event.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "core/nearest.hpp"
#include "product/configuration/limit_keys.hpp"
#include "product/configuration/setting_keys.hpp"
#include "product/configuration/settings.hpp"
#include "product/machine/program_file.hpp"

namespace busbar::product {

namespace {

using administration::Setting;

constexpr std::string_view all_keys = "all";

std::string in_quotes(std::string_view text)
{
    return "\"" + std::string{text} + "\"";
}

std::string flag_text(bool flag)
{
    return flag ? "true" : "false";
}

std::string with_unit(const std::string& text, std::string_view unit)
{
    return unit.empty() ? text : text + " " + std::string{unit};
}

/// Writes " by chief at 2026-11-21T06:00:00Z". Changes without an author are at least as old as the
/// file.
std::string author_text(const Provenance& provenance, const std::string& name)
{
    const auto author = provenance.authors().find(name);
    if (author != provenance.authors().end()) {
        const std::string& user = author->second.user;
        return (user.empty() ? "" : " by " + user) + " at " + to_string(author->second.time);
    }
    storage::FolderStorage folder{provenance.config().certificates.folder};
    const auto entry = folder.entry(Settings::file_name);
    return entry ? ", where settings were changed last at " + to_string(entry->modified)
                 : std::string{};
}

std::string file_text(const std::string& place)
{
    const std::string built_in = name_of_file("") + ":";
    return place.starts_with(built_in)
               ? "built-in, line " + place.substr(built_in.size()) + " of --print-config"
               : "file " + place;
}

std::string origin_text(const Saying& saying, const Provenance& provenance, const std::string& name)
{
    const std::string at = saying.where.empty() ? std::string{} : " " + saying.where;
    switch (saying.layer) {
    case Layer::Preset:
        return saying.where.starts_with("limits.") ? saying.where : "preset" + at;
    case Layer::File:
        return saying.where.empty() ? "follows from other keys of the file"
                                    : file_text(saying.where);
    case Layer::Project:
        return "project";
    case Layer::Online:
        return "changed online" + author_text(provenance, name);
    case Layer::CommandLine:
        return "command line" + at;
    case Layer::BuiltIn:
        break;
    }
    return "built-in";
}

/// A key that is not a setting, so that only the file sets it.
struct FileKey {
    std::string_view name;
    std::string (*value)(const ControllerConfig& config);
};
using Config = const ControllerConfig&;

std::string list_names(const std::vector<std::string>& names)
{
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + in_quotes(name);
    }
    return "[" + text + "]";
}

/// Writes the path of a program, or the list of several.
std::string paths_text(const std::string& paths)
{
    const std::vector<std::string> names = paths_of(paths);
    return names.size() > 1 ? list_names(names) : in_quotes(paths);
}

std::string encoding_text(controller::TextEncoding encoding)
{
    return in_quotes(std::string{name(encoding)});
}

constexpr std::array file_keys{
    FileKey{"certificates.folder", [](Config c) { return in_quotes(c.certificates.folder); }},
    FileKey{"files",
            [](Config c) {
                std::vector<std::string> names;
                std::ranges::transform(c.files, std::back_inserter(names), &FilesConfig::name);
                return list_names(names);
            }},
    FileKey{"labels.encoding", [](Config c) { return encoding_text(c.labels.reading.encoding); }},
    FileKey{"labels.isolate_failures",
            [](Config c) { return flag_text(c.labels.isolates_failures); }},
    FileKey{"labels.program", [](Config c) { return paths_text(c.labels.program_file); }},
    FileKey{"labels.sampling", [](Config c) { return flag_text(c.labels.options.can_sample); }},
    FileKey{"labels.strict",
            [](Config c) {
                return flag_text(c.labels.options.unserved == controller::Unserved::Refuse);
            }},
    FileKey{"machine.encoding", [](Config c) { return encoding_text(c.machine.reading.encoding); }},
    FileKey{"machine.event_levels",
            [](Config c) {
                std::vector<std::string> levels;
                for (const controller::EventLevelChoice& each : c.machine.event_levels) {
                    levels.push_back(code_text(*controller::machine_event_type(each.code)) + " " +
                                     std::string{name(each.level)});
                }
                return list_names(levels);
            }},
    FileKey{"machine.make_medium", [](Config c) { return flag_text(c.machine.makes_medium); }},
    FileKey{"machine.medium", [](Config c) { return in_quotes(c.machine.medium_folder); }},
    FileKey{"machine.plcopen_model", [](Config c) { return flag_text(c.machine.has_plcopen); }},
    FileKey{"machine.program", [](Config c) { return paths_text(c.machine.program_file); }},
    FileKey{"machine.simulated_hardware",
            [](Config c) { return flag_text(c.machine.simulates_hardware); }},
    FileKey{"machine.state", [](Config c) { return in_quotes(c.machine.state_folder); }},
    FileKey{"machine.strict",
            [](Config c) {
                return flag_text(c.machine.reading.unserved == controller::Unserved::Refuse);
            }},
    FileKey{"machine.types",
            [](Config c) {
                return in_quotes(c.machine.types.elementary == controller::ElementaryTypes::BuiltIn
                                     ? "built-in"
                                     : "plcopen");
            }},
    FileKey{"server.application_uri", [](Config c) { return in_quotes(c.server.application_uri); }},
    FileKey{"server.key_log", [](Config c) { return in_quotes(c.key_log); }},
    FileKey{"users.account",
            [](Config c) {
                std::vector<std::string> names;
                std::ranges::transform(c.users.accounts, std::back_inserter(names), &Account::name);
                return list_names(names);
            }},
    FileKey{"users.setup", [](Config c) { return flag_text(c.users.has_setup); }},
};

std::string rule_of(std::string_view key)
{
    for (const Rule& rule : rules()) {
        const std::string_view start = rule.key.substr(0, rule.key.find('*'));
        if (key == start || (start != rule.key && key.starts_with(start))) {
            return std::string{rule.source};
        }
    }
    return {};
}

/// Writes a line such as "  from       file controller.toml:12".
std::string line(std::string_view what, const std::string& text)
{
    constexpr std::size_t width = 12;
    std::string head = "  " + std::string{what};
    head.resize(std::max(head.size() + 1, width + 2), ' ');
    return text.empty() ? std::string{} : head + text + "\n";
}

std::string range_lines(const std::string& least, const std::string& most)
{
    return line("least", least) + line("most", most);
}

std::string when_text(const std::string& name)
{
    const auto guarded = program_only_settings();
    return std::string{is_live(name) ? "counts at once" : "counts after a restart"} +
           (std::ranges::find(guarded, name) != guarded.end()
                ? "; a machine takes it in PROGRAM only"
                : "") +
           (is_security_setting(name) ? "; of SecurityAdmin" : "");
}

std::string explain_setting(const Provenance& provenance, const Setting& setting)
{
    const auto sayings = provenance.sayings(setting);
    const Saying& counts = sayings.back();
    std::string text = setting.name + " = " + with_unit(value_text(counts.value), setting.unit) +
                       "\n" + line("from", origin_text(counts, provenance, setting.name));
    for (auto before = sayings.rbegin() + 1; before != sayings.rend(); ++before) {
        text +=
            line(before == sayings.rbegin() + 1 ? "otherwise" : "",
                 value_text(before->value) + ", " + origin_text(*before, provenance, setting.name));
    }
    text += line("default", value_text(sayings.front().value));
    if (setting.range) {
        text += range_lines(value_text(Variant{setting.range->low}),
                            value_text(Variant{setting.range->high}));
    }
    return text + line("a change", when_text(setting.name)) + line("rule", rule_of(setting.name));
}

/// `range` is the result of range_lines().
std::string explain_file_key(const Provenance& provenance, std::string_view name,
                             const std::string& value, const std::string& range = {})
{
    const std::string place = provenance.place(name);
    return std::string{name} + " = " + value + "\n" +
           line("from", place.empty() ? "built-in" : file_text(place)) + range +
           line("a change", "of the file only; counts after a restart") +
           line("rule", rule_of(name));
}

/// Explains every key, sorted by name.
std::vector<std::pair<std::string, std::string>> explanations(const Provenance& provenance)
{
    std::vector<std::pair<std::string, std::string>> all;
    for (const Setting& setting : provenance.settings()) {
        all.emplace_back(setting.name, explain_setting(provenance, setting));
    }
    for (const LimitKey& key : limit_keys()) {
        if (!key.is_setting) {
            const std::string name = setting_name(key);
            all.emplace_back(
                name,
                explain_file_key(provenance, name,
                                 with_unit(std::to_string(key.get(provenance.config())), key.unit),
                                 range_lines(std::to_string(key.least), std::to_string(key.most))));
        }
    }
    for (const FileKey& key : file_keys) {
        all.emplace_back(key.name,
                         explain_file_key(provenance, key.name, key.value(provenance.config())));
    }
    std::ranges::sort(all);
    return all;
}

/// Writes a summary such as "limits.sessions = 7  (file controller.toml:12)".
std::string summary_of(const std::string& explanation)
{
    const std::size_t end = explanation.find('\n');
    const std::size_t from = explanation.find_first_not_of(' ', explanation.find("from ") + 5);
    return explanation.substr(0, end) + "  (" +
           explanation.substr(from, explanation.find('\n', from) - from) + ")\n";
}

} // namespace

std::string explain(const Provenance& provenance, const std::string& key)
{
    std::string text;
    for (const auto& [name, explanation] : explanations(provenance)) {
        if (key == all_keys) {
            text += summary_of(explanation);
        } else if (name == key) {
            text = explanation;
        }
    }
    return text;
}

std::vector<std::string> keys_like(const Provenance& provenance, const std::string& word)
{
    constexpr std::size_t most = 5;
    std::vector<std::string> names;
    for (auto& [name, explanation] : explanations(provenance)) {
        names.push_back(std::move(name));
    }
    std::vector<std::string> like;
    std::ranges::copy_if(names, std::back_inserter(like), [&](const std::string& name) {
        return name.find(word) != std::string::npos;
    });
    if (like.empty()) {
        like = busbar::detail::nearest(word, names);
    }
    like.resize(std::min(like.size(), most));
    return like;
}

int print_explanation(const Configuration& configuration, const std::string& key)
{
    const Provenance provenance = provenance_of(configuration);
    const std::string wanted = key.empty() ? std::string{all_keys} : key;
    const std::string text = explain(provenance, wanted);
    if (!text.empty()) {
        std::fputs(text.c_str(), stdout);
        return 0;
    }
    std::string hint = "busbar-controller --explain all";
    for (const std::string& name : keys_like(provenance, key)) {
        hint += (hint.ends_with("all") ? "; did you mean " : ", ") + name;
    }
    std::fprintf(stderr, "busbar-controller: found no key \"%s\"\n  hint: %s\n", key.c_str(),
                 hint.c_str());
    return 2;
}

} // namespace busbar::product
