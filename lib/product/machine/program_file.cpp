#include "program_file.hpp"

#include <utility>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/plcopen_xml.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar::product {

namespace {

constexpr std::string_view xml_ending = ".xml";

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
    const std::size_t most = controller::DeclarationLimits{}.max_text_size;
    auto text = table.sources().text(path, most);
    if (!text && text.error().status == status::Bad_EncodingLimitsExceeded) {
        table.fail(key, "a file of at most " + std::to_string(most) + " bytes");
    }
    if (!text) {
        table.fail(key, "a file of declarations (IEC 61131-3) or PLCopen XML");
    }
    auto& program = table.sources().program(path);
    if (program == nullptr) {
        program = std::make_shared<const controller::Program>(read_program(**text, path));
    }
    return {*std::move(text), program};
}

Problem in_file(Problem problem, const std::string& file)
{
    problem.where = problem.where.empty() ? file : file + ":" + problem.where;
    return problem;
}

} // namespace busbar::product
