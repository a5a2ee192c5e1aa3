#include "program_problem.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/core/text.hpp>

#include "core/utf8.hpp"

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

/// Moves the place past the byte `c`.
void pass_byte(ProgramPlace& place, char c)
{
    if (c == '\n') {
        ++place.line;
        place.column = 1;
    } else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) {
        ++place.column;
    }
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

std::optional<std::size_t> first_not_utf8(std::string_view text)
{
    for (std::size_t i = 0; i < text.size();) {
        if (static_cast<unsigned char>(text[i]) < 0x80) {
            ++i;
            continue;
        }
        const std::size_t size = busbar::detail::utf8_sequence(text.substr(i));
        if (size == 0) {
            return i;
        }
        i += size;
    }
    return {};
}

TextPlaces::TextPlaces(std::string_view text, std::uint32_t file) : text_{text}, file_{file}
{
    ProgramPlace place{.line = 1, .column = 1, .file = file};
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (i % step == 0) {
            noted_.push_back(place);
        }
        pass_byte(place, text[i]);
    }
}

ProgramPlace TextPlaces::at(std::size_t offset) const
{
    if (noted_.empty()) {
        return {.line = 1, .column = 1, .file = file_};
    }
    const std::size_t end = std::min(offset, text_.size());
    const std::size_t index = std::min(end / step, noted_.size() - 1);
    ProgramPlace place = noted_[index];
    for (std::size_t i = index * step; i < end; ++i) {
        pass_byte(place, text_[i]);
    }
    return place;
}

} // namespace busbar::controller::detail
