#include <algorithm>
#include <span>

#include <busbar/controller/mapping.hpp>
#include <busbar/crypto/digest.hpp>

namespace busbar::controller {

namespace {

constexpr std::string_view sign_prefix = "busbar-";
constexpr std::size_t sign_bytes = 16;
constexpr std::string_view digits = "0123456789abcdef";

/// Appends a text after its length, so that different contents never give the same text.
void add(std::string& to, std::string_view text)
{
    to += std::to_string(text.size()) + ':';
    to += text;
}

void add_all(std::string& to, const std::vector<MappedPart>& parts);

void add(std::string& to, const MappedPart& part)
{
    to += std::to_string(static_cast<int>(part.kind)) + ',' + std::to_string(part.number) + ',';
    add(to, part.name);
    add(to, part.label);
    to += part.is_array ? 'A' : 'a';
    to += part.is_structure ? 'S' : 's';
    to += std::to_string(part.specification.rank);
    for (const std::uint32_t dimension : part.specification.dimensions) {
        to += ',' + std::to_string(dimension);
    }
    add_all(to, part.parts);
}

void add_all(std::string& to, const std::vector<MappedPart>& parts)
{
    to += '(' + std::to_string(parts.size()) + ')';
    for (const MappedPart& part : parts) {
        add(to, part);
    }
}

std::string digest_of(const std::string& content)
{
    const auto digest = crypto::sha256(std::as_bytes(std::span{content}));
    std::string sign{sign_prefix};
    for (const std::byte byte : std::span{digest}.first<sign_bytes>()) {
        sign += digits[std::to_integer<std::size_t>(byte >> 4U)];
        sign += digits[std::to_integer<std::size_t>(byte & std::byte{0x0F})];
    }
    return sign;
}

} // namespace

std::string sign_of(const DataMapping& mapping)
{
    MappedPart value = mapping.value;
    drop_unmapped(value);
    std::string content = "data";
    add(content, value);
    // Skip this if unused, so that the sign of a mapping in the manual's format stays the same.
    if (!mapping.quality.empty() || mapping.scaling.is_set()) {
        add(content, mapping.quality);
        add(content, to_text(mapping.scaling));
    }
    return digest_of(content);
}

std::string sign_of(const MethodMapping& mapping)
{
    MappedPart arguments;
    arguments.parts = mapping.arguments;
    drop_unmapped(arguments);
    std::string content = "method";
    add(content, mapping.handle);
    add_all(content, arguments.parts);
    if (!mapping.done.empty() || !mapping.outputs.empty()) {
        add(content, mapping.done);
        MappedPart outputs;
        outputs.parts = mapping.outputs;
        drop_unmapped(outputs);
        add_all(content, outputs.parts);
    }
    return digest_of(content);
}

bool is_own_sign(std::string_view sign)
{
    return sign.size() == sign_prefix.size() + 2 * sign_bytes && sign.starts_with(sign_prefix) &&
           sign.find_first_not_of(digits, sign_prefix.size()) == std::string_view::npos;
}

} // namespace busbar::controller
