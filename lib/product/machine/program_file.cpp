#include "program_file.hpp"

#include <filesystem>
#include <fstream>
#include <utility>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/plcopen_xml.hpp>

namespace busbar::product {

namespace {

constexpr std::string_view xml_ending = ".xml";

std::string read_text(const TomlTable& table, const std::string& key, const std::string& path)
{
    const controller::DeclarationLimits limits;
    std::ifstream file{path, std::ios::binary | std::ios::ate};
    const auto size = file ? static_cast<std::streamoff>(file.tellg()) : std::streamoff{-1};
    if (size < 0 || std::filesystem::is_directory(path)) {
        table.fail(key, "a file of declarations (IEC 61131-3) or PLCopen XML");
    }
    if (static_cast<std::uint64_t>(size) > limits.max_text_size) {
        table.fail(key, "a file of at most " + std::to_string(limits.max_text_size) + " bytes");
    }
    std::string text(static_cast<std::size_t>(size), '\0');
    file.seekg(0);
    file.read(text.data(), size);
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text;
}

controller::Program read_program(const std::string& text, const std::string& path)
{
    if (path.ends_with(xml_ending)) {
        return expect(controller::read_plcopen_xml(text, path));
    }
    return expect(controller::read_declarations(text, path));
}

} // namespace

ProgramFile read_program_file(const TomlTable& table, const std::string& key)
{
    const std::string path = table.text(key);
    ProgramFile file;
    file.text = std::make_shared<const std::string>(read_text(table, key, path));
    file.program = std::make_shared<const controller::Program>(read_program(*file.text, path));
    return file;
}

Problem in_file(Problem problem, const std::string& file)
{
    problem.where = problem.where.empty() ? file : file + ":" + problem.where;
    return problem;
}

} // namespace busbar::product
