#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/controller/mapping.hpp>

namespace busbar::controller::detail {

/// Elements that have attributes (SH-082679, appendix 8).
enum class ExtensionElement : std::uint8_t {
    DataMapping,
    Element,
    Field,
    MethodMapping,
    Handle,
    Input,
    Argument,
};
inline constexpr std::size_t extension_element_count = 7;

[[nodiscard]] std::string_view name_of(ExtensionElement element);

/// Whether an element needs an attribute.
enum class AttributeUse : std::uint8_t {
    Ignored, // known, but without a meaning there
    Optional,
    Required,
};

enum class ExtensionAttribute : std::uint8_t {
    IsArray,
    IsStructure,
    Num,
    Name,
    Data,
    Rank,
    Dim1,
    Dim2,
    Dim3,
    Sign,
};

struct AttributeRule {
    std::string_view name;
    ExtensionAttribute attribute;
    /// Indexed by ExtensionElement.
    std::array<AttributeUse, extension_element_count> uses;
};

/// Finds the rule of an attribute, from both tables; null for an unknown name.
[[nodiscard]] const AttributeRule* rule_of_attribute(std::string_view name);
/// Returns the attribute's name as it is written.
[[nodiscard]] std::string_view name_of(ExtensionAttribute attribute);

/// The values of one element's attributes.
struct PartAttributes {
    MappedPart part{};
    std::string sign{};
};

/// Parses one value, regardless of case. False, with nothing changed, if it is not valid.
[[nodiscard]] bool take_value(ExtensionAttribute attribute, std::string_view value,
                              std::uint32_t max_elements, std::size_t max_label_length,
                              PartAttributes& to);

/// Counts the characters of a UTF-8 text.
[[nodiscard]] std::size_t character_count(std::string_view text);

} // namespace busbar::controller::detail
