#include "plcopen_reader.hpp"

#include <algorithm>
#include <cstring>
#include <memory>

namespace busbar::controller::detail {

namespace {

constexpr std::string_view root_name = "TcPlcObject";

Unexpected<Problem> refused(const SourceText& source, std::ptrdiff_t offset, std::string text)
{
    const auto at = static_cast<std::size_t>(std::max(offset, std::ptrdiff_t{0}));
    return misconfigured(place_text(source.file, source.places.at(at)), std::move(text));
}

} // namespace

Configured<void> add_twincat(const SourceText& source, const DeclarationLimits& limits,
                             ProgramParts& to)
{
    if (!take_document(source.text, limits, to)) {
        return refused(source, 0,
                       "takes more than " + std::to_string(limits.max_memory) + " bytes of memory");
    }
    // Texts stay as they are, so that their bytes have places in the file.
    const auto document = std::make_shared<pugi::xml_document>();
    const auto parsed = document->load_buffer(source.text.data(), source.text.size(),
                                              pugi::parse_cdata, pugi::encoding_utf8);
    if (!parsed) {
        return refused(source, parsed.offset,
                       std::string{"is not well-formed XML: "} + parsed.description());
    }
    const pugi::xml_node root = document->document_element();
    if (local_name_of(root) != root_name) {
        return refused(source, root.offset_debug() - 1,
                       "found " + tag_of(root) + ", expected <TcPlcObject>");
    }
    to.documents.push_back(document);
    const std::size_t before = to.list.size();
    for (const pugi::xml_node& object : root.children()) {
        const pugi::xml_node content = child_of(object, "Declaration").first_child();
        const std::ptrdiff_t offset = content.offset_debug();
        if (offset < 0) {
            continue;
        }
        const auto begin = static_cast<std::size_t>(offset);
        add_declarations(source,
                         {.text = source.text.substr(0, begin + std::strlen(content.value())),
                          .begin = begin,
                          .list = object.attribute("Name").value()},
                         to);
    }
    if (to.list.size() == before) {
        return refused(source, root.offset_debug() - 1,
                       "found <TcPlcObject>, expected an object with a <Declaration> in it");
    }
    return {};
}

} // namespace busbar::controller::detail
