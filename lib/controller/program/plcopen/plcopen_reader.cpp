#include "plcopen_reader.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include <busbar/core/text.hpp>

#include "controller/program/literal.hpp"
#include "core/ascii_case.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::array<std::string_view, 5> plcopen_namespaces{
    "http://www.plcopen.org/xml/tc6_0201", "http://www.plcopen.org/xml/tc6_0200",
    "http://www.plcopen.org/xml/tc6_0101",
    "http://www.plcopen.org/xml/tc6.xsd", // 1.0 and 1.01
    "www.iec.ch/public/TC65SC65BWG7TF10", // IEC 61131-10
};

/// Elements that are only searched for the elements inside.
constexpr std::array<std::string_view, 10> container_names{
    "types",    "dataTypes", "instances", "configurations",  "configuration",
    "resource", "addData",   "data",      "globalNamespace", "namespaceDecl",
};

/// Elements with a body that are types to variables, if at all.
struct UnitName {
    std::string_view name;
    std::string_view words;
};
constexpr std::array unit_names{
    UnitName{"functionBlock", "is a function block"},
    UnitName{"function", "is a function"},
    UnitName{"program", "is a program"},
    UnitName{"class", "is a class"},
    UnitName{"interface", "is an interface"},
};

/// Converts "PT1H2.5S" to the notation of IEC 61131-3; empty for any other text.
std::string iec_interval(std::string_view text)
{
    constexpr std::string_view prefix = "PT";
    if (!text.starts_with(prefix)) {
        return {};
    }
    std::string interval = "T#";
    for (const char c : text.substr(prefix.size())) {
        interval += busbar::detail::to_ascii_lower(c);
    }
    return interval;
}

} // namespace

Configured<void> PlcopenReader::open(ProgramParts& to)
{
    const bool is_open = parse(to) && check_root(document_.document_element());
    return is_open ? Configured<void>{} : Unexpected<Problem>{*problem_};
}

Configured<void> PlcopenReader::read(ReadingPass& pass)
{
    pass_ = &pass;
    problem_.reset();
    is_exhausted_ = false;
    depth_ = 0;
    leaves_out_ = pass.unserved == Unserved::LeaveOut;
    const bool is_read = read_container(document_.document_element(), 0);
    return is_read ? Configured<void>{} : Unexpected<Problem>{*problem_};
}

bool PlcopenReader::parse(ProgramParts& to)
{
    if (!take_document(source_->text, *limits_, to)) {
        return fail_at(0, "takes more than " + std::to_string(limits_->max_memory) +
                              " bytes of memory");
    }
    const auto parsed =
        document_.load_buffer(source_->text.data(), source_->text.size(),
                              pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
    if (!parsed) {
        return fail_at(static_cast<std::size_t>(std::max(parsed.offset, std::ptrdiff_t{0})),
                       std::string{"is not well-formed XML: "} + parsed.description());
    }
    for (const pugi::xml_node& node : document_.children()) {
        if (node.type() == pugi::node_doctype) {
            return fail_at(0, "has a DOCTYPE, which PLCopen XML has no use for");
        }
    }
    return true;
}

bool PlcopenReader::check_root(const pugi::xml_node& root)
{
    if (!is_named(root, "project")) {
        return fail(root, "found " + tag_of(root) +
                              ", expected <project> of PLCopen XML or <Project> of IEC 61131-10");
    }
    const std::string_view name = root.name();
    const std::size_t colon = name.find(':');
    const std::string declaration =
        colon == std::string_view::npos ? "xmlns" : "xmlns:" + std::string{name.substr(0, colon)};
    const std::string_view uri = root.attribute(declaration.c_str()).value();
    return std::find(plcopen_namespaces.begin(), plcopen_namespaces.end(), uri) !=
               plcopen_namespaces.end() ||
           fail(root, "found the namespace '" + printable(uri, 80) + "', expected " +
                          std::string{plcopen_namespaces.front()} + ", tc6_0200, tc6.xsd or " +
                          std::string{plcopen_namespaces.back()});
}

bool PlcopenReader::read_container(const pugi::xml_node& container, std::size_t depth)
{
    if (depth > limits_->max_depth) {
        return fail(container,
                    "has more than " + std::to_string(limits_->max_depth) + " elements around it");
    }
    for (const pugi::xml_node& xml : container.children()) {
        if (!read_part(xml, depth)) {
            return false;
        }
    }
    return true;
}

bool PlcopenReader::read_part(const pugi::xml_node& xml, std::size_t depth)
{
    if (xml.type() != pugi::node_element) {
        return true;
    }
    if (std::any_of(container_names.begin(), container_names.end(),
                    [&](std::string_view name) { return is_named(xml, name); })) {
        return read_container(xml, depth + 1);
    }
    if (is_named(xml, "dataType") || is_named(xml, "union")) {
        return read_type(xml) || leave_out(xml, LeftOut::Kind::Type, {});
    }
    if (is_named(xml, "dataTypeDecl")) {
        return read_declared_type(xml) || leave_out(xml, LeftOut::Kind::Type, {});
    }
    if (is_named(xml, "globalVars")) {
        return read_variables(xml);
    }
    if (is_named(xml, "task")) {
        return read_task(xml);
    }
    if (leaves_out_ && is_named(xml.parent(), "globalNamespace")) {
        return note_unit(xml);
    }
    return !is_named(xml, "pouInstance") || read_instance(xml, {});
}

bool PlcopenReader::note_unit(const pugi::xml_node& xml)
{
    for (const UnitName& each : unit_names) {
        if (is_named(xml, each.name)) {
            static_cast<void>(fail(xml, std::string{each.words}));
            return leave_out(xml, LeftOut::Kind::Unit, {});
        }
    }
    return true;
}

bool PlcopenReader::read_task(const pugi::xml_node& xml)
{
    ProgramTask task;
    std::int64_t priority = 0;
    if (!keep(xml, sizeof task) || !read_name(xml, "name", task.name) ||
        !read_interval(xml, task) ||
        (xml.attribute("priority") && !read_number(xml, "priority", priority))) {
        return false;
    }
    if (priority < 0 || priority > UINT32_MAX) {
        return fail(xml, "found <task> with the priority " + std::to_string(priority) +
                             ", expected one of 32 bits without a sign");
    }
    task.priority = static_cast<std::uint32_t>(priority);
    pass_->program.tasks.push_back(task);
    for (const pugi::xml_node& child : xml.children()) {
        if (is_named(child, "pouInstance") && !read_instance(child, task.name)) {
            return false;
        }
    }
    return true;
}

bool PlcopenReader::read_interval(const pugi::xml_node& xml, ProgramTask& task)
{
    const std::string_view text = trimmed_text(xml.attribute("interval").value());
    const std::string iso = iec_interval(text);
    task.interval = iso.empty() ? text : std::string_view{iso};
    // The interval may also be the name of a variable.
    if (text.empty() || task.interval.find('#') == std::string::npos) {
        task.interval.clear();
        return true;
    }
    const auto literal = read_typed_literal(task.interval);
    const bool is_duration =
        literal && *literal && (*literal)->notation == InitialValue::Notation::Duration;
    return is_duration ? keep(xml, task.interval.size())
                       : fail(xml, "in <task>: " + found_expected(text, "an interval as T#10ms"));
}

bool PlcopenReader::read_instance(const pugi::xml_node& xml, const std::string& task)
{
    ProgramInstance instance{.name = {}, .type_name = {}, .task = task};
    instance.type_name = xml.attribute("typeName").value();
    if (!keep(xml, sizeof instance + instance.type_name.size() + task.size()) ||
        !read_name(xml, "name", instance.name)) {
        return false;
    }
    pass_->program.instances.push_back(std::move(instance));
    return true;
}

Configured<void> add_plcopen(const SourceText& source, const DeclarationLimits& limits,
                             ProgramParts& to)
{
    const auto reader = std::make_shared<PlcopenReader>(source, limits);
    return reader->open(to).transform([&] {
        to.documents.push_back(reader);
        to.list.push_back(
            {source.file, [reader](ReadingPass& pass) { return reader->read(pass); }});
    });
}

} // namespace busbar::controller::detail

namespace busbar::controller {

Configured<Program> read_plcopen_xml(std::string_view text, std::string_view file_name,
                                     const DeclarationLimits& limits, Unserved unserved,
                                     TextEncoding encoding)
{
    const auto decoded = decode_text(text, file_name, limits.max_text_size, encoding);
    if (!decoded) {
        return Unexpected{decoded.error()};
    }
    const detail::SourceText source{decoded->text(), file_name};
    detail::ProgramParts parts;
    return detail::add_plcopen(source, limits, parts)
        .and_then([&] { return detail::read_parts(parts, limits, unserved); })
        .transform([&](Program program) {
            program.encoding = decoded->encoding();
            return program;
        });
}

} // namespace busbar::controller
