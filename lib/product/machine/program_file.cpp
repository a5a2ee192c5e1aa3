#include "program_file.hpp"

#include <utility>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/plcopen_xml.hpp>
#include <busbar/core/status_codes.hpp>

#include "product/store/received_program.hpp"

namespace busbar::product {

namespace {

constexpr std::string_view xml_ending = ".xml";

using ReadProgram = std::shared_ptr<const controller::CheckedProgram>;

/// Returns the program at this place: the remembered one, or a new reading.
ReadProgram program_of(SourceFiles& sources, const std::string& place, std::string_view text,
                       const std::string& name)
{
    ReadProgram& program = sources.program(place);
    if (program == nullptr) {
        program = expect(read_program(text, name));
    }
    return program;
}

Configured<controller::Program> read_unchecked(std::string_view text, const std::string& name)
{
    return name.ends_with(xml_ending) ? controller::read_plcopen_xml(text, name)
                                      : controller::read_declarations(text, name);
}

std::shared_ptr<const std::string> text_of_file(const TomlTable& table, const std::string& key)
{
    const std::size_t most = controller::DeclarationLimits{}.max_text_size;
    auto text = table.sources().text(table.text(key), most);
    if (!text && text.error().status == status::Bad_EncodingLimitsExceeded) {
        table.fail(key, "a file of at most " + std::to_string(most) + " bytes");
    }
    if (!text) {
        table.fail(key, "a file of declarations (IEC 61131-3) or PLCopen XML");
    }
    return *std::move(text);
}

} // namespace

Configured<ReadProgram> read_program(std::string_view text, const std::string& name)
{
    return read_unchecked(text, name).and_then([&](controller::Program read) {
        return controller::CheckedProgram::create(std::move(read))
            .transform_error([&](Problem problem) { return in_file(std::move(problem), name); });
    });
}

ProgramFile<controller::Program> read_labels_program(const TomlTable& table, const std::string& key)
{
    auto text = text_of_file(table, key);
    const std::string path = table.text(key);
    SourceFiles::Labels& labels = table.sources().labels(path);
    if (labels == nullptr) {
        labels = std::make_shared<const controller::Program>(expect(read_unchecked(*text, path)));
    }
    return {std::move(text), labels, path};
}

ProgramFile<controller::CheckedProgram> read_machine_program(const TomlTable& table,
                                                             const std::string& key)
{
    SourceFiles& sources = table.sources();
    const auto document = expect(sources.received());
    if (!document) {
        auto text = text_of_file(table, key);
        const std::string path = table.text(key);
        auto program = program_of(sources, path, *text, path);
        return {std::move(text), std::move(program), path};
    }
    auto received = expect(read_received(**document, sources.received_place()));
    auto program = program_of(sources, sources.received_place(), received.text, received.name);
    return {std::make_shared<const std::string>(std::move(received.text)), std::move(program),
            std::move(received.name)};
}

Problem in_file(Problem problem, const std::string& file)
{
    problem.where = problem.where.empty() ? file : file + ":" + problem.where;
    return problem;
}

} // namespace busbar::product
