#include "extension_attributes.hpp"

#include <algorithm>

#include "core/ascii_case.hpp"
#include "core/number_text.hpp"

namespace busbar::controller::detail {

namespace {

constexpr AttributeUse ignored = AttributeUse::Ignored;
constexpr AttributeUse optional = AttributeUse::Optional;
constexpr AttributeUse required = AttributeUse::Required;

using Attribute = ExtensionAttribute;
using Uses = std::array<AttributeUse, extension_element_count>;

// DataMapping, Element, Field, MethodMapping, Handle, Input, Argument
constexpr Uses flag{optional, ignored, optional, ignored, ignored, ignored, optional};
constexpr Uses specification{optional, ignored, optional, ignored, ignored, ignored, ignored};

constexpr std::array<AttributeRule, 12> rules{{
    {"IsArray", Attribute::IsArray, flag},
    {"isArray", Attribute::IsArray, flag},
    {"IsStructure", Attribute::IsStructure, flag},
    {"isStructure", Attribute::IsStructure, flag},
    {"Num", Attribute::Num, {ignored, required, ignored, ignored, ignored, ignored, required}},
    {"Name", Attribute::Name, {ignored, ignored, required, ignored, ignored, ignored, ignored}},
    {"Data", Attribute::Data, {optional, optional, optional, ignored, required, ignored, optional}},
    {"Rank", Attribute::Rank, specification},
    {"Dim1", Attribute::Dim1, specification},
    {"Dim2", Attribute::Dim2, specification},
    {"Dim3", Attribute::Dim3, specification},
    {"Sign", Attribute::Sign, {optional, ignored, ignored, optional, ignored, ignored, ignored}},
}};

constexpr std::array<std::string_view, extension_element_count> element_names{
    "DataMapping", "Element", "Field", "MethodMapping", "Handle", "Input", "Argument",
};

template <typename Number>
bool read_whole(std::string_view text, Number low, Number high, Number& to)
{
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = busbar::detail::read_number(text.data(), end, value);
    if (error != std::errc{} || stop != end || value < low || value > high) {
        return false;
    }
    to = value;
    return true;
}

bool take_flag(std::string_view value, bool& to)
{
    if (!busbar::detail::is_same_ignoring_case(value, "true")) {
        return false;
    }
    to = true;
    return true;
}

bool is_blank(std::string_view value)
{
    return value.find_first_not_of(' ') == std::string_view::npos;
}

bool take_text(std::string_view value, std::size_t max_length, std::string& to)
{
    if (is_blank(value) || character_count(value) > max_length) {
        return false;
    }
    to = value;
    return true;
}

bool take_rank(std::string_view value, std::int32_t& to)
{
    std::int32_t rank = 0;
    if (!read_whole<std::int32_t>(value, -1, 3, rank) || rank == ArraySpecification::none) {
        return false;
    }
    to = rank;
    return true;
}

/// Limit of attributes, such as names of fields and signs, that have none of their own.
constexpr std::size_t max_other_length = 4'096;

} // namespace

std::string_view name_of(ExtensionElement element)
{
    return element_names[static_cast<std::size_t>(element)];
}

std::string_view name_of(ExtensionAttribute attribute)
{
    const auto* const found =
        std::find_if(rules.begin(), rules.end(),
                     [&](const AttributeRule& rule) { return rule.attribute == attribute; });
    return found->name;
}

const AttributeRule* rule_of_attribute(std::string_view name)
{
    const auto* const found = std::find_if(
        rules.begin(), rules.end(), [&](const AttributeRule& rule) { return rule.name == name; });
    return found == rules.end() ? nullptr : found;
}

bool take_value(ExtensionAttribute attribute, std::string_view value, std::uint32_t max_elements,
                std::size_t max_label_length, PartAttributes& to)
{
    auto& dimensions = to.part.specification.dimensions;
    switch (attribute) {
    case Attribute::IsArray:
        return take_flag(value, to.part.is_array);
    case Attribute::IsStructure:
        return take_flag(value, to.part.is_structure);
    case Attribute::Num:
        return max_elements != 0 && read_whole(value, 0U, max_elements - 1, to.part.number);
    case Attribute::Name:
        return take_text(value, max_other_length, to.part.name);
    case Attribute::Data:
        return take_text(value, max_label_length, to.part.label);
    case Attribute::Rank:
        return take_rank(value, to.part.specification.rank);
    case Attribute::Dim1:
        return read_whole(value, 1U, max_elements, dimensions[0]);
    case Attribute::Dim2:
        return read_whole(value, 1U, max_elements, dimensions[1]);
    case Attribute::Dim3:
        return read_whole(value, 1U, max_elements, dimensions[2]);
    case Attribute::Sign:
        return take_text(value, max_other_length, to.sign);
    }
    return false;
}

std::size_t character_count(std::string_view text)
{
    constexpr unsigned char continuation_mask = 0xC0;
    constexpr unsigned char continuation = 0x80;
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
        return (static_cast<unsigned char>(c) & continuation_mask) != continuation;
    }));
}

} // namespace busbar::controller::detail
