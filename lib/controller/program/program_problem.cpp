#include "program_problem.hpp"

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

} // namespace busbar::controller::detail
