#include "options.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include <busbar/core/version.hpp>

#include "command_line/manual_page.hpp"

namespace busbar::generator {

namespace {

constexpr const char* arguments = "--output FOLDER [options] NODESET2-FILE...";

struct Description {
    const char* option;
    const char* text;
};

constexpr std::array descriptions{
    Description{"--output FOLDER", "where to write; is created"},
    Description{"--dependency FILE[,CPP-NAMESPACE,INCLUDE-PATH]",
                "a NodeSet2 file whose code exists already; may be repeated; \"busbar\" and "
                "\"busbar/types\" by default"},
    Description{"--namespace-uri URI",
                "the namespace to generate; by default that of the first <Model>"},
    Description{"--cpp-namespace NAME", "default: busbar"},
    Description{"--include-path PATH",
                "how generated headers include each other; default: busbar/types"},
    Description{"--groups FILE", "CSV of \"TypeName,file\" that splits the structures over files"},
    Description{"--ids FILE", "CSV of \"Name,identifier,NodeClass\" with the constants' names"},
    Description{"--nodes", "emit the nodes as constant data, not the types"},
    Description{"--definitions", "emit the DataTypes of namespace 0 as constant data instead"},
    Description{"--node-list FILE", "with --nodes: the NodeIds to emit, one a line"},
    Description{"--features FILE", "with --nodes: CSV of \"feature,number\"; these nodes and what "
                                   "they consist of are left out"},
    Description{"--feature NAME", "but not those of this one; may be repeated"},
    Description{"--addition", "with --feature: emit its nodes alone, to be added to the others"},
    Description{"--given NAME",
                "with --addition: a feature that is among the others; may be repeated"},
    Description{"--help", "print this and end"},
    Description{"--version", "print the version and end"},
};

constexpr std::size_t text_column = 27;
constexpr std::size_t width = 80;

/// `text` from text_column on, in lines that end before `width`.
std::string in_column(std::string_view text)
{
    std::string result;
    while (text.size() > width - text_column) {
        const std::size_t end = text.rfind(' ', width - text_column);
        result += std::string{text.substr(0, end)} + "\n" + std::string(text_column, ' ');
        text.remove_prefix(end + 1);
    }
    return result + std::string{text} + "\n";
}

std::string usage()
{
    std::string text = std::string{"usage: busbar-generate "} + arguments + "\n";
    for (const Description& each : descriptions) {
        std::string option = std::string{"  "} + each.option;
        const bool is_beside = option.size() < text_column;
        option.resize(is_beside ? text_column : option.size(), ' ');
        text +=
            option + (is_beside ? "" : "\n" + std::string(text_column, ' ')) + in_column(each.text);
    }
    return text;
}

std::string manual_page()
{
    command_line::ManualPage page;
    page.program = "busbar-generate";
    page.summary = "Makes C++ types and constant nodes of NodeSet2 files";
    page.arguments = arguments;
    page.sections.push_back(
        {"DESCRIPTION",
         page.summary + ", which describe information models of OPC UA. In a project that uses "
                        "CMake, busbar_generate of the installed generate.cmake runs it.",
         {},
         false});
    page.sections.push_back({"OPTIONS", "", {}, false});
    for (const Description& each : descriptions) {
        page.sections.back().entries.push_back({each.option, each.text});
    }
    return text_of(page, version());
}

Unexpected<Failure> wrong(const std::string& what)
{
    return Unexpected{what + "\n" + usage()};
}

/// "file,namespace,path" or "file".
Options::Dependency dependency(const std::string& text)
{
    Options::Dependency result{text, "busbar", "busbar/types"};
    const std::size_t first = text.find(',');
    const std::size_t second = first == std::string::npos ? first : text.find(',', first + 1);
    if (second != std::string::npos) {
        result = {text.substr(0, first), text.substr(first + 1, second - first - 1),
                  text.substr(second + 1)};
    }
    return result;
}

/// Tells whether the file has this text: it is not written then, so that nothing is rebuilt.
bool has_text(const std::filesystem::path& path, const std::string& text)
{
    std::ifstream file{path, std::ios::binary};
    return file && std::string{std::istreambuf_iterator<char>{file}, {}} == text;
}

/// The option's place for its value; null if there is no such option.
std::string* text_option(Options& options, std::string_view name)
{
    if (name == "--output") {
        return &options.output_folder;
    }
    if (name == "--namespace-uri") {
        return &options.namespace_uri;
    }
    if (name == "--cpp-namespace") {
        return &options.cpp_namespace;
    }
    if (name == "--include-path") {
        return &options.include_path;
    }
    if (name == "--groups") {
        return &options.groups_file;
    }
    if (name == "--ids") {
        return &options.ids_file;
    }
    if (name == "--features") {
        return &options.features_file;
    }
    if (name == "--feature") {
        return &options.features.emplace_back();
    }
    if (name == "--given") {
        return &options.given.emplace_back();
    }
    return name == "--node-list" ? &options.node_list : nullptr;
}

} // namespace

std::optional<std::string> answer(std::string_view word)
{
    if (word == "--help") {
        return usage();
    }
    if (word == "--version") {
        return std::string{"busbar-generate "} + version() + "\n";
    }
    return word == "--print-man" ? std::optional{manual_page()} : std::nullopt;
}

Expected<Options, Failure> parse_options(int argc, char** argv)
{
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.substr(0, 2) != "--") {
            options.inputs.push_back(argument);
            continue;
        }
        if (argument == "--addition") {
            options.is_addition = true;
            continue;
        }
        if (argument == "--nodes" || argument == "--definitions") {
            (argument == "--nodes" ? options.nodes : options.definitions) = true;
            continue;
        }
        std::string* const text = text_option(options, argument);
        if (text == nullptr && argument != "--dependency") {
            return wrong("found " + argument + ", expected one of the options below");
        }
        if (++i == argc) {
            return wrong(argument + " needs a value");
        }
        if (text != nullptr) {
            *text = argv[i];
        } else {
            options.dependencies.push_back(dependency(argv[i]));
        }
    }
    if (options.inputs.empty() || options.output_folder.empty()) {
        return wrong(options.inputs.empty() ? "there is no NodeSet2 file" : "--output is missing");
    }
    return options;
}

Expected<void, Failure> write_output(const Options& options, const std::string& name,
                                     const std::string& text)
{
    const std::filesystem::path folder{options.output_folder};
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    const std::string path = (folder / name).string();
    if (!error && has_text(path, text)) {
        return {};
    }
    std::FILE* const file = error ? nullptr : std::fopen(path.c_str(), "wb");
    if (file == nullptr) {
        return Unexpected{
            path + ": cannot be written: " + (error ? error.message() : std::strerror(errno))};
    }
    const bool is_written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    if (std::fclose(file) != 0 || !is_written) {
        return Unexpected{path + ": cannot be written: " + std::strerror(errno)};
    }
    return {};
}

} // namespace busbar::generator
