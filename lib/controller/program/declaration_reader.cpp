#include <busbar/controller/declaration_reader.hpp>

#include <utility>

#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"
#include "program_parts.hpp"

namespace busbar::controller {

namespace detail {

void add_declarations(const SourceText& source, const DeclarationPart& part, ProgramParts& to)
{
    to.list.push_back({source.file, [&source, part](ReadingPass& pass) -> Configured<void> {
                           pass.constants.set_list(part.list);
                           DeclarationCursor cursor{part.text,   source.file, &source.places,
                                                    pass.limits, pass.memory, pass.constants,
                                                    part.begin};
                           DeclarationParser parser{cursor, pass};
                           if (!parser.read()) {
                               return Unexpected<Problem>{cursor.problem()};
                           }
                           return {};
                       }});
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
    const detail::SourceText source{decoded->text(), file_name};
    detail::ProgramParts parts;
    detail::add_declarations(source, {.text = source.text}, parts);
    return detail::read_parts(parts, limits, unserved).transform([&](Program program) {
        program.encoding = decoded->encoding();
        return program;
    });
}

} // namespace busbar::controller
