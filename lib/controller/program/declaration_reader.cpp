#include <busbar/controller/declaration_reader.hpp>

#include "constant_table.hpp"
#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"
#include "enumerator_numbers.hpp"

namespace busbar::controller {

Configured<Program> read_declarations(std::string_view text, std::string_view file_name,
                                      const DeclarationLimits& limits, Unserved unserved,
                                      TextEncoding encoding)
{
    const auto decoded = decode_text(text, file_name, limits.max_text_size, encoding);
    if (!decoded) {
        return Unexpected{decoded.error()};
    }
    const std::string_view declarations = decoded->text();
    const detail::TextPlaces places{declarations};
    detail::ConstantTable constants;
    constants.set_file(file_name);
    const auto read_once = [&](Unserved choice) -> Configured<Program> {
        detail::MemoryBudget memory{limits.max_memory};
        detail::DeclarationCursor cursor{declarations, file_name, &places,
                                         limits,       memory,    constants};
        detail::DeclarationParser parser{cursor, choice};
        if (!parser.read()) {
            return Unexpected<Problem>{cursor.problem()};
        }
        return std::move(parser.program());
    };
    auto program = detail::read_in_passes(constants, unserved, read_once);
    if (!program) {
        return program;
    }
    if (const LeftOut* first = detail::not_understood(*program)) {
        return misconfigured(detail::place_text(file_name, first->declared.place),
                             first->problem.text);
    }
    detail::settle_enumerators(*program);
    program->encoding = decoded->encoding();
    return program;
}

} // namespace busbar::controller
