#include "name_order.hpp"

#include "core/utf8.hpp"

namespace busbar::controller::detail {

namespace {

/// Decodes a valid UTF-8 sequence.
char32_t code_point(std::string_view sequence)
{
    const auto lead = static_cast<unsigned char>(sequence[0]);
    if (sequence.size() == 1) {
        return lead;
    }
    // A lead byte begins with as many ones as the sequence has bytes, followed by a zero.
    char32_t value = lead & (0x7FU >> sequence.size());
    for (const char c : sequence.substr(1)) {
        value = (value << 6U) | (static_cast<unsigned char>(c) & 0x3FU);
    }
    return value;
}

void append_code_units(std::u16string& key, char32_t character)
{
    constexpr char32_t first_supplementary = 0x10000;
    if (character < first_supplementary) {
        const bool is_small = character >= U'a' && character <= U'z';
        key += static_cast<char16_t>(is_small ? character - U'a' + U'A' : character);
        return;
    }
    const char32_t rest = character - first_supplementary;
    key += static_cast<char16_t>(0xD800U + (rest >> 10U));
    key += static_cast<char16_t>(0xDC00U + (rest & 0x3FFU));
}

} // namespace

std::u16string sorting_key(std::string_view name)
{
    std::u16string key;
    key.reserve(name.size());
    while (!name.empty()) {
        const std::size_t size = busbar::detail::utf8_sequence(name);
        if (size == 0) { // the name was not checked
            break;
        }
        append_code_units(key, code_point(name.substr(0, size)));
        name.remove_prefix(size);
    }
    return key;
}

} // namespace busbar::controller::detail
