#include "text_places.hpp"

#include <algorithm>

#include "core/utf8.hpp"

namespace busbar::controller::detail {

namespace {

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
