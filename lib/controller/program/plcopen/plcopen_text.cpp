#include <algorithm>

#include <busbar/core/text.hpp>

#include "controller/program/declaration_cursor.hpp"
#include "controller/program/program_problem.hpp"
#include "core/ascii_case.hpp"
#include "plcopen_reader.hpp"

namespace busbar::controller::detail {

std::size_t memory_of_document(std::string_view text)
{
    constexpr std::size_t node = 64;
    constexpr std::size_t attribute = 40;
    const auto count = [&](char c) {
        return static_cast<std::size_t>(std::count(text.begin(), text.end(), c));
    };
    return text.size() + count('<') * 2 * node + count('=') * attribute;
}

bool take_document(std::string_view text, const DeclarationLimits& limits, ProgramParts& to)
{
    const std::size_t bytes = memory_of_document(text);
    const std::size_t left = limits.max_memory - std::min(limits.max_memory, to.memory);
    to.memory += bytes <= left ? bytes : 0;
    return bytes <= left;
}

std::string_view local_name_of(const pugi::xml_node& xml)
{
    const std::string_view name = xml.name();
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

bool is_named(const pugi::xml_node& xml, std::string_view name)
{
    const std::string_view found = local_name_of(xml);
    return found.size() == name.size() && !name.empty() &&
           busbar::detail::to_ascii_lower(found.front()) ==
               busbar::detail::to_ascii_lower(name.front()) &&
           found.substr(1) == name.substr(1);
}

pugi::xml_node child_of(const pugi::xml_node& xml, std::string_view name)
{
    return xml.find_child([&](const pugi::xml_node& child) {
        return child.type() == pugi::node_element && is_named(child, name);
    });
}

pugi::xml_node first_element_of(const pugi::xml_node& xml)
{
    return xml.find_child(
        [](const pugi::xml_node& child) { return child.type() == pugi::node_element; });
}

std::string tag_of(const pugi::xml_node& xml)
{
    constexpr std::size_t enough = 60;
    return "<" + printable(xml.name(), enough) + ">";
}

bool PlcopenReader::read_name(const pugi::xml_node& xml, const char* attribute, std::string& name)
{
    name = xml.attribute(attribute).value();
    if (name.empty()) {
        return fail(xml, "found " + tag_of(xml) + ", expected the attribute " + attribute);
    }
    return name.size() <= limits_->max_name_length
               ? keep(xml, name.size())
               : fail(xml, "found " + tag_of(xml) + " with a name of " +
                               std::to_string(name.size()) + " bytes, expected at most " +
                               std::to_string(limits_->max_name_length));
}

bool PlcopenReader::read_number(const pugi::xml_node& xml, const char* attribute,
                                std::int64_t& number)
{
    const std::string_view text = xml.attribute(attribute).value();
    DeclarationCursor cursor{text,     source_->file, nullptr,
                             *limits_, pass_->memory, pass_->constants};
    const std::string expected = std::string{"a whole number as the attribute "} + attribute;
    if (read_whole_number(cursor, number, expected) &&
        (cursor.is_end() || cursor.fail("the end of the number"))) {
        return true;
    }
    return fail(xml, "in " + tag_of(xml) + ": " + cursor.problem().text);
}

bool PlcopenReader::keep(const pugi::xml_node& xml, std::size_t bytes)
{
    if (pass_->memory.take(bytes)) {
        return true;
    }
    is_exhausted_ = true;
    return fail(xml, "takes more than " + std::to_string(limits_->max_memory) +
                         " bytes of memory up to here");
}

ProgramPlace PlcopenReader::place_of(const pugi::xml_node& xml) const
{
    // offset_debug() is that of the name, after the bracket.
    const std::ptrdiff_t offset = xml.offset_debug() - 1;
    return source_->places.at(static_cast<std::size_t>(std::max(offset, std::ptrdiff_t{0})));
}

bool PlcopenReader::fail(const pugi::xml_node& xml, std::string text)
{
    const std::ptrdiff_t offset = xml.offset_debug() - 1;
    return fail_at(static_cast<std::size_t>(std::max(offset, std::ptrdiff_t{0})), std::move(text));
}

bool PlcopenReader::fail_at(std::size_t offset, std::string text)
{
    if (!problem_) {
        problem_place_ = source_->places.at(offset);
        problem_.emplace();
        problem_->where = place_text(source_->file, problem_place_);
        problem_->text = std::move(text);
    }
    return false;
}

bool PlcopenReader::leave_out(const pugi::xml_node& xml, LeftOut::Kind kind, NetworkPublish publish)
{
    if (!leaves_out_ || is_exhausted_) {
        return false;
    }
    const std::string text = std::move(problem_->text);
    problem_.reset();
    const std::string_view name = xml.attribute("name").value();
    if (!keep(xml, sizeof(LeftOut) + text.size() + 2 * name.size())) {
        return false;
    }
    pass_->program.left_out.push_back(
        left_out(kind, std::string{name}, publish, problem_place_, text));
    return true;
}

} // namespace busbar::controller::detail
