#include "describe.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "controller/machine/program_report.hpp"
#include "core/json_writer.hpp"
#include "product/machine/program_file.hpp"
#include "product/store/received_program.hpp"
#include "product/store/source_files.hpp"

namespace busbar::product {

namespace {

controller::detail::ProgramReport check_file(const ControllerConfig& config,
                                             const std::string& name)
{
    auto program = SourceFiles{}
                       .program_text(name, ReceivedProgram::max_text)
                       .and_then([&](const SourceFiles::Text& text) {
                           return read_program(*text, name, config.machine.reading);
                       });
    return {name, std::move(program), config.machine.publishing};
}

} // namespace

void add_member(detail::JsonWriter& json, const char* name, const std::string& text)
{
    json.name(name);
    json.string(text);
}

void add_member(detail::JsonWriter& json, const char* name, std::uint64_t number)
{
    json.name(name);
    json.word(std::to_string(number));
}

bool check_programs(const ControllerConfig& config, const std::vector<std::string>& files,
                    detail::JsonWriter* json)
{
    bool is_good = true;
    for (const std::string& name : files) {
        const controller::detail::ProgramReport report = check_file(config, name);
        is_good = is_good && report.is_good();
        if (json != nullptr) {
            report.write(*json);
            continue;
        }
        for (const std::string& line : report.lines()) {
            std::puts(line.c_str());
        }
    }
    return is_good;
}

int check(const ControllerConfig& config, std::vector<std::string> files, bool is_json)
{
    const std::string& own = config.machine.program_file.empty() ? config.labels.program_file
                                                                 : config.machine.program_file;
    std::erase(files, ""); // the option without an argument
    const bool has_own = files.empty();
    if (has_own && !own.empty()) {
        files = {own};
    }
    if (files.empty() && config.backends.empty()) {
        throw ConfigError{"--check", "found no file, and a configuration without a program or "
                                     "backend, expected a file with declarations"};
    }
    detail::JsonWriter json;
    json.begin_list();
    detail::JsonWriter* const to = is_json ? &json : nullptr;
    bool is_good = check_programs(config, files, to);
    if (has_own && !config.backends.empty()) {
        is_good = check_backends(config, to) && is_good;
    }
    json.end_list();
    if (is_json) {
        std::puts(json.document().c_str());
    }
    return is_good ? 0 : 1;
}

} // namespace busbar::product
