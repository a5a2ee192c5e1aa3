#include "program_file.hpp"

#include <algorithm>
#include <utility>

#include <busbar/controller/label_program.hpp>
#include <busbar/controller/program_text.hpp>
#include <busbar/core/status_codes.hpp>

#include "product/store/received_program.hpp"

namespace busbar::product {

namespace {

using ReadProgram = std::shared_ptr<const controller::CheckedProgram>;

/// Refuses what was left out of a program that was read before the key "strict" had this value.
void check_strict(const TomlTable& table, const controller::Program& program,
                  const std::string& file)
{
    const auto left_out = left_out_texts(program, file);
    if (read_reading(table).unserved == controller::Unserved::Refuse && !left_out.empty()) {
        throw ConfigError{"", left_out.front()};
    }
}

/// Returns false if the text is in another encoding than the one that it was read in before.
bool is_read_so(std::string_view text, controller::TextEncoding asked,
                controller::TextEncoding before)
{
    return controller::program_encoding(text, asked) == before;
}

Problem in_file(Problem problem, const std::string& file)
{
    const std::string name = paths_in_line(file);
    problem.where = problem.where.empty() ? name : name + ":" + problem.where;
    return problem;
}

/// Returns the program at this place: the remembered one, or a new reading.
ReadProgram program_of(const TomlTable& table, const std::string& place, std::string_view text,
                       const std::string& name)
{
    SourceFiles& sources = table.sources();
    ReadProgram& program = sources.program(place);
    const ProgramReading reading = read_reading(table);
    if (program == nullptr || !is_read_so(text, reading.encoding, program->program().encoding)) {
        program = expect(read_program(text, name, reading));
    }
    check_strict(table, program->program(), name);
    return program;
}

Configured<controller::Program> read_unchecked(std::string_view text, const std::string& name,
                                               const ProgramReading& reading)
{
    return controller::read_program_text(text, paths_in_line(name), {}, reading.unserved,
                                         reading.encoding);
}

std::shared_ptr<const std::string> text_of_file(const TomlTable& table, const std::string& key)
{
    const std::size_t most = controller::DeclarationLimits{}.max_text_size;
    auto text = table.sources().program_text(read_program_path(table, key), most);
    if (!text) {
        if (text.error().status == status::Bad_NotFound) {
            table.fail(key, "a file of declarations (IEC 61131-3), PLCopen XML, IEC 61131-10 or "
                            "TwinCAT, a folder or a .plcproj of such, or a list of these");
        }
        table.refuse(key, busbar::text(text.error()));
    }
    return *std::move(text);
}

} // namespace

Configured<ReadProgram> read_program(std::string_view text, const std::string& name,
                                     const ProgramReading& reading)
{
    return read_unchecked(text, name, reading).and_then([&](controller::Program read) {
        controller::Program of_files;
        of_files.files = read.files;
        return controller::CheckedProgram::create(std::move(read), reading.unserved)
            .transform_error(
                [&](Problem problem) { return in_file(std::move(problem), name, of_files); });
    });
}

Configured<std::shared_ptr<const controller::Program>>
read_labels(std::string_view text, const std::string& name, const ProgramReading& reading)
{
    return read_unchecked(text, name, reading).transform([&](controller::Program program) {
        if (reading.unserved == controller::Unserved::LeaveOut) {
            controller::LabelProgram::leave_out(program);
        }
        return std::make_shared<const controller::Program>(std::move(program));
    });
}

ProgramFile<controller::Program> read_labels_program(const TomlTable& table, const std::string& key)
{
    auto text = text_of_file(table, key);
    const std::string path = read_program_path(table, key);
    SourceFiles::Labels& labels = table.sources().labels(path);
    const ProgramReading reading = read_reading(table);
    if (labels == nullptr || !is_read_so(*text, reading.encoding, labels->encoding)) {
        labels = expect(read_labels(*text, path, reading));
    }
    check_strict(table, *labels, path);
    return {std::move(text), labels, paths_in_line(path)};
}

ProgramFile<controller::CheckedProgram> read_machine_program(const TomlTable& table,
                                                             const std::string& key)
{
    SourceFiles& sources = table.sources();
    const auto document = expect(sources.received());
    if (!document) {
        auto text = text_of_file(table, key);
        const std::string path = read_program_path(table, key);
        auto program = program_of(table, path, *text, paths_in_line(path));
        return {std::move(text), std::move(program), path};
    }
    auto received = expect(read_received(**document, sources.received_place()));
    auto program = program_of(table, sources.received_place(), received.text, received.name);
    return {std::make_shared<const std::string>(std::move(received.text)), std::move(program),
            std::move(received.name)};
}

ProgramReading read_reading(const TomlTable& table)
{
    ProgramReading reading{.unserved = table.flag("strict", false)
                                           ? controller::Unserved::Refuse
                                           : controller::Unserved::LeaveOut};
    const std::string encoding = table.text("encoding", "");
    const auto found = controller::find_text_encoding(encoding);
    if (!encoding.empty() && !found) {
        table.fail("encoding", R"("utf-8", "utf-16", "utf-16be", "shift-jis" or "windows-1252")");
    }
    reading.encoding = found.value_or(controller::TextEncoding::Recognized);
    return reading;
}

std::vector<std::string> left_out_texts(const controller::Program& program, const std::string& file)
{
    std::vector<std::string> all;
    for (const controller::LeftOut& each : program.left_out) {
        if (each.kind != controller::LeftOut::Kind::Unit) {
            all.emplace_back(text(in_file(each, file)));
        }
    }
    return all;
}

void tell_left_out(LogSink& log, const controller::Program& program, const std::string& file)
{
    if (program.encoding != controller::TextEncoding::Utf8) {
        log.write(LogLevel::Info, "program",
                  paths_in_line(file) + " was read as " + std::string{name(program.encoding)} +
                      "; the key encoding of its section can name another encoding");
    }
    std::vector<std::string> all;
    for (const controller::LeftOut& each : program.left_out) {
        const bool is_told = each.declared.publish != controller::NetworkPublish::Hidden ||
                             each.kind == controller::LeftOut::Kind::Unit;
        if (!is_told) {
            all.emplace_back(text(in_file(each, file)));
        }
    }
    tell_left_out(log, all, file);
}

void tell_left_out(LogSink& log, std::span<const std::string> texts, const std::string& file)
{
    constexpr std::size_t most = 20;
    for (const std::string& each : texts.first(std::min(texts.size(), most))) {
        log.write(LogLevel::Info, "program", "left out: " + each);
    }
    if (texts.size() > most) {
        log.write(LogLevel::Info, "program",
                  "left out: " + std::to_string(texts.size() - most) + " more of " +
                      paths_in_line(file) + "; `busbar-controller --check` lists them all");
    }
}

std::string read_program_path(const TomlTable& table, const std::string& key)
{
    const toml::node* const node = table.node(key);
    if (node == nullptr || !node->is_array()) {
        return table.text(key, "");
    }
    std::string all;
    for (const std::string& path : table.texts(key)) {
        if (path.empty() || path.find('\n') != std::string::npos) {
            table.fail(key, "a list of paths");
        }
        all += (all.empty() ? "" : "\n") + path;
    }
    return all;
}

std::vector<std::string> paths_of(const std::string& program_file)
{
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin < program_file.size();) {
        const std::size_t end = std::min(program_file.find('\n', begin), program_file.size());
        if (end > begin) {
            all.push_back(program_file.substr(begin, end - begin));
        }
        begin = end + 1;
    }
    return all;
}

std::string paths_in_line(std::string path)
{
    std::ranges::replace(path, '\n', ' ');
    return path;
}

std::string program_name_of(const std::string& path)
{
    if (path.find('\n') != std::string::npos) {
        return "several files";
    }
    std::string name = path;
    while (name.size() > 1 && name.ends_with('/')) {
        name.pop_back();
    }
    return name.substr(name.rfind('/') + 1);
}

Problem in_file(Problem problem, const std::string& file, const controller::Program& program)
{
    const bool has_file = std::ranges::any_of(program.files, [&](const std::string& name) {
        return problem.where.starts_with(name + ":");
    });
    return has_file ? problem : in_file(std::move(problem), file);
}

Problem in_file(const controller::LeftOut& one, const std::string& file)
{
    return one.declared.place.file != 0 ? one.problem : in_file(one.problem, file);
}

} // namespace busbar::product
