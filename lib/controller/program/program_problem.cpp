#include "program_problem.hpp"

#include <array>

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

std::string quoted_name(const std::string& name)
{
    constexpr std::size_t enough = 60;
    return printable(std::string_view{name}.substr(0, enough));
}

std::string place_in(std::string_view list, std::size_t index, const std::string& name)
{
    return std::string{list} + "[" + std::to_string(index) + "] (" + quoted_name(name) + ")";
}

Problem problem_at(std::string where, const ProgramPlace& place, std::string text)
{
    if (place.line != 0) {
        where = std::to_string(place.line) + ":" + std::to_string(place.column) + ": " + where;
    }
    return Problem{status::Bad_ConfigurationError, std::move(where), std::move(text)};
}

LeftOut left_out(LeftOut::Kind kind, std::string name, NetworkPublish publish,
                 const ProgramPlace& place, const std::string& text)
{
    constexpr std::array<std::string_view, 4> nouns{"text", "type ", "unit ", "variable "};
    LeftOut one;
    one.kind = kind;
    one.problem = problem_at(std::string{nouns[static_cast<std::size_t>(kind)]} + quoted_name(name),
                             place, text);
    one.declared.name = std::move(name);
    one.declared.place = place;
    one.declared.publish = publish;
    return one;
}

} // namespace busbar::controller::detail
