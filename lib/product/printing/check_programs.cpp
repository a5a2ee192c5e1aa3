#include "check.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <busbar/controller/published_program.hpp>
#include <busbar/core/text.hpp>

#include "core/json_writer.hpp"
#include "product/machine/program_file.hpp"
#include "product/store/received_program.hpp"
#include "product/store/source_files.hpp"

namespace busbar::product {

namespace {

/// The result for one file.
struct CheckedFile {
    std::string name;
    /// Empty unless the whole file is refused.
    std::string refusal{};
    std::unique_ptr<controller::PublishedProgram> program{};

    [[nodiscard]] bool is_good() const
    {
        const auto is_part = [](const controller::LeftOut& each) {
            return each.kind == controller::LeftOut::Kind::Part;
        };
        return program != nullptr && program->publication().unpublished().empty() &&
               program->publication().left_out() == 0 &&
               std::ranges::none_of(program->program().left_out, is_part);
    }
    /// Lists what is left out and is not listed as a variable that is not published.
    [[nodiscard]] std::vector<std::string> left_out() const
    {
        std::vector<std::string> all;
        for (const controller::LeftOut& each : program->program().left_out) {
            if (each.kind != controller::LeftOut::Kind::Unit &&
                each.declared.publish == controller::NetworkPublish::Hidden) {
                all.emplace_back(text(each.problem));
            }
        }
        return all;
    }
    /// The limit that keeps variables out; empty if none does.
    [[nodiscard]] std::string exceeded() const
    {
        std::string limits;
        for (const auto limit :
             {controller::PublishingLimit::Variables, controller::PublishingLimit::Values,
              controller::PublishingLimit::DataTypes}) {
            if (program->publication().exceeds(limit)) {
                limits = controller::name(limit);
            }
        }
        return limits;
    }
};

CheckedFile check_file(const ControllerConfig& config, const std::string& name)
{
    CheckedFile file{.name = name};
    auto program = SourceFiles{}
                       .text(name, ReceivedProgram::max_text)
                       .and_then([&](const SourceFiles::Text& text) {
                           return read_program(*text, name, config.machine.reading);
                       });
    if (program) {
        file.program =
            controller::PublishedProgram::create(*std::move(program), config.machine.publishing);
    } else {
        file.refusal = text(program.error());
    }
    return file;
}

std::string counted(std::uint64_t count, const char* what)
{
    return std::to_string(count) + " " + what;
}

void print_text(const CheckedFile& file)
{
    if (file.program == nullptr) {
        std::printf("%s is refused: %s\n", file.name.c_str(), file.refusal.c_str());
        return;
    }
    const controller::Publication& publication = file.program->publication();
    const std::vector<std::string> left_out = file.left_out();
    std::printf("%s: %s with %s and %s; %s; %s\n", file.name.c_str(),
                counted(publication.published().size(), "variables are published").c_str(),
                counted(publication.values(), "values").c_str(),
                counted(publication.data_types(), "structure definitions").c_str(),
                counted(publication.unpublished().size() + publication.left_out(),
                        "are not although they are to be")
                    .c_str(),
                counted(left_out.size(), "other declarations are left out").c_str());
    std::printf("  encoding       %s\n",
                std::string{name(file.program->program().encoding)}.c_str());
    for (const controller::PublishedVariable& each : publication.published()) {
        std::printf("  published      %s  %llu bytes\n", printable(each.variable->name).c_str(),
                    static_cast<unsigned long long>(each.size));
    }
    for (const controller::UnpublishedVariable& each : publication.unpublished()) {
        std::printf("  not published  %s  %s\n", printable(each.variable->name).c_str(),
                    controller::reason_text(each).c_str());
    }
    if (publication.left_out() != 0) {
        std::printf("  not published  %zu more, because of the limit %s\n", publication.left_out(),
                    file.exceeded().c_str());
    }
    for (const std::string& each : left_out) {
        std::printf("  left out       %s\n", each.c_str());
    }
}

void write_variables(detail::JsonWriter& json, const controller::Publication& publication)
{
    json.name("published");
    json.begin_list();
    for (const controller::PublishedVariable& each : publication.published()) {
        json.begin_object();
        add_member(json, "name", each.variable->name);
        add_member(json, "size", each.size);
        add_member(json, "values", each.values);
        json.end_object();
    }
    json.end_list();
    json.name("notPublished");
    json.begin_list();
    for (const controller::UnpublishedVariable& each : publication.unpublished()) {
        json.begin_object();
        add_member(json, "name", each.variable->name);
        add_member(json, "reason", std::string{controller::name(each.reason)});
        add_member(json, "text", controller::reason_text(each));
        json.end_object();
    }
    json.end_list();
}

void write_json(detail::JsonWriter& json, const CheckedFile& file)
{
    json.begin_object();
    add_member(json, "file", file.name);
    if (file.program == nullptr) {
        add_member(json, "refused", file.refusal);
        json.end_object();
        return;
    }
    const controller::Publication& publication = file.program->publication();
    add_member(json, "encoding", std::string{name(file.program->program().encoding)});
    add_member(json, "values", publication.values());
    add_member(json, "dataTypes", publication.data_types());
    add_member(json, "exceeded", file.exceeded());
    add_member(json, "beyondLimit", publication.left_out());
    write_variables(json, publication);
    json.name("leftOut");
    json.begin_list();
    for (const std::string& each : file.left_out()) {
        json.string(each);
    }
    json.end_list();
    json.end_object();
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
        const CheckedFile file = check_file(config, name);
        is_good = is_good && file.is_good();
        if (json != nullptr) {
            write_json(*json, file);
        } else {
            print_text(file);
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
