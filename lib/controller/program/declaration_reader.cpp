#include <busbar/controller/declaration_reader.hpp>

#include <iterator>
#include <utility>

#include "constant_table.hpp"
#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"
#include "declaration_parts.hpp"
#include "enumerator_numbers.hpp"

namespace busbar::controller {

namespace detail {

namespace {

template <typename T>
void append(std::vector<T>& all, std::vector<T>& more)
{
    all.insert(all.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
}

void append(Program& all, Program& more)
{
    append(all.types, more.types);
    append(all.variables, more.variables);
    append(all.tasks, more.tasks);
    append(all.instances, more.instances);
    append(all.left_out, more.left_out);
}

Configured<Program> read_part(const DeclarationPart& part, const DeclarationLimits& limits,
                              MemoryBudget& memory, ConstantTable& constants, Unserved unserved)
{
    constants.set_file(part.file);
    constants.set_list(part.list);
    DeclarationCursor cursor{part.text, part.file, part.places, limits,
                             memory,    constants, part.begin};
    DeclarationParser parser{cursor, unserved};
    if (!parser.read()) {
        return Unexpected<Problem>{cursor.problem()};
    }
    return std::move(parser.program());
}

} // namespace

Configured<Program> read_declaration_parts(std::span<const DeclarationPart> parts,
                                           const DeclarationLimits& limits, Unserved unserved)
{
    ConstantTable constants;
    const bool is_one = parts.size() == 1;
    auto program = read_in_passes(constants, unserved, [&](Unserved choice) {
        Configured<Program> all = Program{};
        MemoryBudget memory{limits.max_memory};
        for (const DeclarationPart& part : parts) {
            auto one = read_part(part, limits, memory, constants, choice);
            if (!one) {
                return one;
            }
            for (LeftOut& each : one->left_out) {
                each.problem.where.insert(0, is_one ? "" : std::string{part.file} + ":");
            }
            append(*all, *one);
        }
        return all;
    });
    if (!program) {
        return program;
    }
    if (const LeftOut* first = not_understood(*program)) {
        const std::string_view file = is_one ? parts.front().file : std::string_view{};
        return misconfigured(is_one ? place_text(file, first->declared.place)
                                    : first->problem.where,
                             first->problem.text);
    }
    settle_enumerators(*program);
    return program;
}

} // namespace detail

Configured<Program> read_declarations(std::string_view text, std::string_view file_name,
                                      const DeclarationLimits& limits, Unserved unserved,
                                      TextEncoding encoding)
{
    const auto decoded = decode_text(text, file_name, limits.max_text_size, encoding);
    if (!decoded) {
        return Unexpected{decoded.error()};
    }
    const detail::TextPlaces places{decoded->text()};
    const detail::DeclarationPart part{
        .text = decoded->text(), .places = &places, .file = file_name};
    return detail::read_declaration_parts({&part, 1}, limits, unserved)
        .transform([&](Program program) {
            program.encoding = decoded->encoding();
            return program;
        });
}

} // namespace busbar::controller
