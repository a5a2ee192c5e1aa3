#include "twincat_reader.hpp"

#include <cstring>
#include <vector>

#include "plcopen_reader.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::string_view root_name = "TcPlcObject";

Unexpected<Problem> refused(std::string_view file, const TextPlaces& places, std::ptrdiff_t offset,
                            std::string text)
{
    const auto at = static_cast<std::size_t>(std::max(offset, std::ptrdiff_t{0}));
    return misconfigured(place_text(file, places.at(at)), std::move(text));
}

} // namespace

Configured<Program> read_twincat(std::string_view text, std::string_view file_name,
                                 const DeclarationLimits& limits, Unserved unserved)
{
    const TextPlaces places{text};
    if (memory_of_document(text) > limits.max_memory) {
        return refused(file_name, places, 0,
                       "takes more than " + std::to_string(limits.max_memory) + " bytes of memory");
    }
    // Texts stay as they are, so that their bytes have places in the file.
    pugi::xml_document document;
    const auto parsed =
        document.load_buffer(text.data(), text.size(), pugi::parse_cdata, pugi::encoding_utf8);
    if (!parsed) {
        return refused(file_name, places, parsed.offset,
                       std::string{"is not well-formed XML: "} + parsed.description());
    }
    const pugi::xml_node root = document.document_element();
    if (local_name_of(root) != root_name) {
        return refused(file_name, places, root.offset_debug() - 1,
                       "found " + tag_of(root) + ", expected <TcPlcObject>");
    }
    std::vector<DeclarationPart> parts;
    for (const pugi::xml_node& object : root.children()) {
        const pugi::xml_node content = child_of(object, "Declaration").first_child();
        const std::ptrdiff_t offset = content.offset_debug();
        if (offset < 0) {
            continue;
        }
        const auto begin = static_cast<std::size_t>(offset);
        parts.push_back({.text = text.substr(0, begin + std::strlen(content.value())),
                         .begin = begin,
                         .places = &places,
                         .file = file_name,
                         .list = object.attribute("Name").value()});
    }
    if (parts.empty()) {
        return refused(file_name, places, root.offset_debug() - 1,
                       "found <TcPlcObject>, expected an object with a <Declaration> in it");
    }
    return read_declaration_parts(parts, limits, unserved);
}

} // namespace busbar::controller::detail
