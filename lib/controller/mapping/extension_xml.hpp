#pragma once

#include <string_view>

#include <pugixml.hpp>

#include <busbar/controller/mapping_extensions.hpp>

/// Recognizes mapping elements in the XML that is kept for a node.
namespace busbar::controller::detail {

[[nodiscard]] inline std::string_view local_name(const pugi::xml_node& xml)
{
    const std::string_view name = xml.name();
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

/// True for a <DataMapping> or <MethodMapping>, whatever its namespace.
[[nodiscard]] inline bool has_mapping_name(const pugi::xml_node& xml)
{
    const std::string_view name = local_name(xml);
    return name == "DataMapping" || name == "MethodMapping";
}

/// True if the element is in mapping_namespace as the manual requires: by xmlns in the element or
/// in its <Extension>.
[[nodiscard]] inline bool is_in_mapping_namespace(const pugi::xml_node& xml)
{
    const std::string_view name = xml.name();
    if (name.find(':') != std::string_view::npos) {
        return false;
    }
    pugi::xml_attribute declared = xml.attribute("xmlns");
    if (!declared && local_name(xml.parent()) == "Extension") {
        declared = xml.parent().attribute("xmlns");
    }
    return declared.value() == mapping_namespace;
}

/// True for an <Addition>, which extends the manual's format.
[[nodiscard]] inline bool is_addition(const pugi::xml_node& xml)
{
    return std::string_view{xml.name()} == "Addition" &&
           std::string_view{xml.attribute("xmlns").value()} == addition_namespace;
}

/// True if the element is in mapping_namespace by the rules of XML: by a prefix or an outer
/// declaration.
[[nodiscard]] inline bool is_elsewhere_in_mapping_namespace(const pugi::xml_node& xml)
{
    const std::string_view name = xml.name();
    const std::size_t colon = name.find(':');
    std::string declaration = "xmlns";
    if (colon != std::string_view::npos) {
        declaration += ':';
        declaration += name.substr(0, colon);
    }
    for (pugi::xml_node at = xml; at; at = at.parent()) {
        if (const pugi::xml_attribute declared = at.attribute(declaration.c_str())) {
            return declared.value() == mapping_namespace;
        }
    }
    return false;
}

/// True if the element has only the namespace of the file itself, so that xmlns was forgotten.
[[nodiscard]] inline bool has_no_namespace(const pugi::xml_node& xml)
{
    constexpr std::string_view file_namespace = "http://opcfoundation.org/UA/2011/03/UANodeSet.xsd";
    if (std::string_view{xml.name()}.find(':') != std::string_view::npos) {
        return false;
    }
    for (pugi::xml_node at = xml; at; at = at.parent()) {
        if (const pugi::xml_attribute declared = at.attribute("xmlns")) {
            return declared.value() == file_namespace;
        }
    }
    return true;
}

} // namespace busbar::controller::detail
