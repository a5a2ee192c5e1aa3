#include "program_problem.hpp"

#include <array>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

namespace {

std::string at_place(const ProgramPlace& place, std::string where)
{
    return place.line == 0 ? std::move(where)
                           : std::to_string(place.line) + ":" + std::to_string(place.column) +
                                 ": " + std::move(where);
}

std::string file_prefix(const std::vector<std::string>& files, const ProgramPlace& place)
{
    return place.file != 0 && place.file <= files.size() ? printable(files[place.file - 1]) + ":"
                                                         : std::string{};
}

} // namespace

std::string quoted_name(const std::string& name)
{
    constexpr std::size_t enough = 60;
    return printable(std::string_view{name}.substr(0, enough));
}

std::string place_in(std::string_view list, std::size_t index, const std::string& name)
{
    return std::string{list} + "[" + std::to_string(index) + "] (" + quoted_name(name) + ")";
}

Problem problem_at(const Program& program, std::string where, const ProgramPlace& place,
                   std::string text)
{
    return {.where = file_prefix(program.files, place) + at_place(place, std::move(where)),
            .text = std::move(text)};
}

void add_file(LeftOut& one, const std::vector<std::string>& files)
{
    one.problem.where.insert(0, file_prefix(files, one.declared.place));
}

LeftOut left_out(LeftOut::Kind kind, std::string name, NetworkPublish publish,
                 const ProgramPlace& place, const std::string& text)
{
    constexpr std::array<std::string_view, 4> nouns{"text", "type ", "unit ", "variable "};
    LeftOut one;
    one.kind = kind;
    one.problem.where =
        at_place(place, std::string{nouns[static_cast<std::size_t>(kind)]} + quoted_name(name));
    one.problem.text = text;
    one.declared.name = std::move(name);
    one.declared.place = place;
    one.declared.publish = publish;
    return one;
}

} // namespace busbar::controller::detail
