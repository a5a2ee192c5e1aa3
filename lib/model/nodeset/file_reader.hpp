#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <pugixml.hpp>

#include "document.hpp"
#include "xml_text.hpp"

namespace busbar::nodeset {

/// Adds one NodeSet2 file to a Document. Used once.
class FileReader {
public:
    FileReader(Document& document, std::string name, bool is_lenient);

    [[nodiscard]] std::vector<Problem> read(std::string_view text);

private:
    [[nodiscard]] bool parse(std::string_view text);
    void read_namespaces(const pugi::xml_node& root);
    void read_models(const pugi::xml_node& parent, std::vector<Model>& models, unsigned depth);
    static void read_model_attribute(const pugi::xml_attribute& attribute, Model& model);
    void read_file_extensions(const pugi::xml_node& root);
    void read_aliases(const pugi::xml_node& root);
    void read_nodes(const pugi::xml_node& root);
    void read_node(const pugi::xml_node& xml, NodeClass node_class);
    void read_names(const pugi::xml_node& xml, Node& node);
    static void read_text(const pugi::xml_node& xml, const char* element, LocalizedText& text);
    void read_further_texts(const pugi::xml_node& xml, Node& node);
    void read_attributes(const pugi::xml_node& xml, Node& node);
    void read_references(const pugi::xml_node& xml, Node& node);
    void read_definition(const pugi::xml_node& xml, Node& node);
    Field read_field(const pugi::xml_node& xml);
    void read_value(const pugi::xml_node& xml, Node& node);
    void read_element(const pugi::xml_node& xml, Element& element, std::size_t depth);
    // Contents that only the file's writer needs.
    void read_extras(const pugi::xml_node& xml, Node& node);
    static void read_kept_attributes(const pugi::xml_node& xml, model::NodeSetNodeExtras& extras);
    void read_kept_elements(const pugi::xml_node& xml, model::NodeSetNodeExtras& extras);
    [[nodiscard]] std::vector<model::NodeSetPermission> read_permissions(const pugi::xml_node& xml);
    /// Appends the element, or only its content, with declarations of the prefixes that it uses.
    void keep_xml(const pugi::xml_node& xml, bool with_tag, std::string& to);

    [[nodiscard]] NodeId node_id(const pugi::xml_node& where, std::string_view text);
    [[nodiscard]] NodeId named(const pugi::xml_node& where, std::string_view name);
    /// Returns the attribute as a NodeId, `otherwise` if it is missing.
    [[nodiscard]] NodeId node_id_attribute(const pugi::xml_node& xml, const char* attribute,
                                           const NodeId& otherwise);
    [[nodiscard]] std::uint16_t namespace_of(const pugi::xml_node& where, std::size_t local);
    template <typename Number>
    void number_attribute(const pugi::xml_node& xml, const char* attribute, Number& value)
    {
        const pugi::xml_attribute found = xml.attribute(attribute);
        if (found && !to_number(trimmed(found.value()), value)) {
            fail(xml, std::string{"found "} + attribute + "=" + quoted(found.value()) +
                          ", expected a number in the range of the attribute");
        }
    }
    void bool_attribute(const pugi::xml_node& xml, const char* attribute, bool& value);
    void dimensions_attribute(const pugi::xml_node& xml, std::vector<std::uint32_t>& value);

    void fail(const pugi::xml_node& where, std::string message);
    /// Counts one more of `what`; returns false, with one error, beyond the limit.
    [[nodiscard]] bool count(const pugi::xml_node& where, std::size_t& counter, std::size_t limit,
                             const char* what);
    [[nodiscard]] std::uint32_t line_at(std::ptrdiff_t offset) const;
    [[nodiscard]] std::uint32_t line_of(const pugi::xml_node& node) const;

    Document& document_;
    const Limits& limits_;
    std::string name_;
    bool is_lenient_;
    pugi::xml_document xml_;
    std::vector<std::ptrdiff_t> line_ends_;
    std::unordered_map<std::string, NodeId> aliases_;
    std::size_t references_{0};
    std::size_t required_models_{0};
    std::size_t value_elements_{0};
    std::uint32_t file_{0};
    std::string current_node_;
    std::vector<Problem> errors_;
};

} // namespace busbar::nodeset
