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

/// What an attribute is to an element.
enum class AttributeUse : std::uint8_t {
    Ignored, // it exists and means nothing there
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
    /// By ExtensionElement.
    std::array<AttributeUse, extension_element_count> uses;
};

/// The two tables of attributes in one; null for an attribute that there is none of.
[[nodiscard]] const AttributeRule* rule_of_attribute(std::string_view name);
/// The name of an attribute as it is written.
[[nodiscard]] std::string_view name_of(ExtensionAttribute attribute);

/// What the attributes of one element say.
struct PartAttributes {
    MappedPart part{};
    std::string sign{};
};

/// Takes in one value, whose case does not count. False, and nothing changes, if it is impossible.
[[nodiscard]] bool take_value(ExtensionAttribute attribute, std::string_view value,
                              std::uint32_t max_elements, std::size_t max_label_length,
                              PartAttributes& to);

/// Characters of UTF-8.
[[nodiscard]] std::size_t character_count(std::string_view text);

} // namespace busbar::controller::detail
