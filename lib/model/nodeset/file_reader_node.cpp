#include "file_reader.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "xml_text.hpp"

namespace busbar::nodeset {

void FileReader::read_names(const pugi::xml_node& xml, Node& node)
{
    const std::string_view browse_name = xml.attribute("BrowseName").value();
    if (browse_name.empty()) {
        fail(xml, "found a node without BrowseName");
    }
    const auto split = split_qualified_name(browse_name);
    node.browse_namespace = namespace_of(xml, split.namespace_index);
    node.browse_name = split.name;
    node.symbolic_name = xml.attribute("SymbolicName").value();
    read_text(xml, "DisplayName", node.display_name);
    read_text(xml, "Description", node.description);
    read_text(xml, "InverseName", node.inverse_name);
    read_further_texts(xml, node);
    if (node.display_name.text.empty()) {
        node.display_name.text = node.browse_name;
    }
}

/// Reads the first text with this name; others are in further locales.
void FileReader::read_text(const pugi::xml_node& xml, const char* element, LocalizedText& text)
{
    const pugi::xml_node found = child(xml, element);
    text.locale = found.attribute("Locale").value();
    text.text = found.text().get();
}

void FileReader::read_further_texts(const pugi::xml_node& xml, Node& node)
{
    struct Localized {
        std::string_view element;
        AttributeId attribute;
        std::size_t count{0};
    };
    Localized kinds[] = {{"DisplayName", AttributeId::DisplayName},
                         {"Description", AttributeId::Description},
                         {"InverseName", AttributeId::InverseName}};
    for (const pugi::xml_node& entry : xml.children()) {
        auto* const kind =
            std::find_if(std::begin(kinds), std::end(kinds),
                         [&](const Localized& each) { return each.element == local_name(entry); });
        if (kind == std::end(kinds) || kind->count++ == 0) {
            continue;
        }
        if (kind->count > limits_.max_locales) {
            fail(entry, "there are more than " + std::to_string(limits_.max_locales) +
                            " of the texts " + std::string{kind->element});
            return;
        }
        const std::string_view text = entry.text().get();
        if (!text.empty()) {
            node.further_texts.push_back({kind->attribute,
                                          {entry.attribute("Locale").value(), std::string{text}},
                                          line_of(entry)});
        }
    }
}

void FileReader::read_attributes(const pugi::xml_node& xml, Node& node)
{
    node.parent = node_id_attribute(xml, "ParentNodeId", {});
    node.data_type = node_id_attribute(xml, "DataType", node.data_type);
    number_attribute(xml, "ValueRank", node.value_rank);
    number_attribute(xml, "AccessLevel", node.access_level);
    number_attribute(xml, "MinimumSamplingInterval", node.minimum_sampling_interval);
    number_attribute(xml, "EventNotifier", node.event_notifier);
    dimensions_attribute(xml, node.array_dimensions);
    bool_attribute(xml, "Historizing", node.historizing);
    bool_attribute(xml, "IsAbstract", node.is_abstract);
    bool_attribute(xml, "Symmetric", node.symmetric);
    bool_attribute(xml, "ContainsNoLoops", node.contains_no_loops);
    bool_attribute(xml, "Executable", node.executable);
    number_attribute(xml, "WriteMask", node.write_mask);
    if (xml.attribute("AccessRestrictions")) {
        number_attribute(xml, "AccessRestrictions", node.access_restrictions.emplace());
    }
    bool has_no_permissions = false;
    bool_attribute(xml, "HasNoPermissions", has_no_permissions);
    auto permissions = read_permissions(xml);
    if (has_no_permissions) {
        node.role_permissions.emplace();
    } else if (!permissions.empty()) {
        node.role_permissions = std::move(permissions);
    }
}

void FileReader::read_references(const pugi::xml_node& xml, Node& node)
{
    for (const pugi::xml_node& entry : child(xml, "References").children()) {
        if (local_name(entry) != "Reference") {
            continue;
        }
        if (!count(entry, references_, limits_.max_references, "references")) {
            return;
        }
        Reference reference;
        reference.line = line_of(entry);
        reference.type = node_id_attribute(entry, "ReferenceType", {});
        reference.target = node_id(entry, trimmed(entry.text().get()));
        bool_attribute(entry, "IsForward", reference.is_forward);
        if (reference.type.is_null()) {
            fail(entry, "found a reference without ReferenceType");
            continue;
        }
        node.references.push_back(std::move(reference));
    }
}

void FileReader::read_definition(const pugi::xml_node& xml, Node& node)
{
    const pugi::xml_node found = child(xml, "Definition");
    if (!found) {
        return;
    }
    Definition& definition = node.definition.emplace();
    definition.name = found.attribute("Name").value();
    definition.symbolic_name = found.attribute("SymbolicName").value();
    bool_attribute(found, "IsUnion", definition.is_union);
    bool_attribute(found, "IsOptionSet", definition.is_option_set);
    std::size_t counter = 0;
    for (const pugi::xml_node& entry : found.children()) {
        if (local_name(entry) != "Field") {
            continue;
        }
        if (!count(entry, counter, limits_.max_fields, "fields in a definition")) {
            return;
        }
        definition.fields.push_back(read_field(entry));
    }
}

Field FileReader::read_field(const pugi::xml_node& xml)
{
    Field field;
    field.line = line_of(xml);
    field.name = xml.attribute("Name").value();
    field.symbolic_name = xml.attribute("SymbolicName").value();
    field.data_type = node_id_attribute(xml, "DataType", field.data_type);
    number_attribute(xml, "ValueRank", field.value_rank);
    dimensions_attribute(xml, field.array_dimensions);
    number_attribute(xml, "MaxStringLength", field.max_string_length);
    number_attribute(xml, "Value", field.value);
    bool_attribute(xml, "IsOptional", field.is_optional);
    bool_attribute(xml, "AllowSubTypes", field.allow_sub_types);
    read_text(xml, "DisplayName", field.display_name);
    read_text(xml, "Description", field.description);
    if (field.name.empty()) {
        fail(xml, "found a field without Name");
    }
    return field;
}

void FileReader::read_value(const pugi::xml_node& xml, Node& node)
{
    for (const pugi::xml_node& entry : child(xml, "Value").children()) {
        if (entry.type() == pugi::node_element) {
            read_element(entry, node.value.emplace(), 0);
            return;
        }
    }
}

void FileReader::read_element(const pugi::xml_node& xml, Element& element, std::size_t depth)
{
    if (depth >= limits_.max_value_depth) {
        fail(xml, "a <Value> is more than " + std::to_string(limits_.max_value_depth) +
                      " elements deep");
        return;
    }
    element.name = local_name(xml);
    element.line = line_of(xml);
    static_cast<void>(to_bool(nil_attribute(xml), element.says_nil));
    element.is_nil = !xml.first_child() || element.says_nil;
    for (const pugi::xml_node& entry : xml.children()) {
        if (entry.type() == pugi::node_pcdata || entry.type() == pugi::node_cdata) {
            element.text += entry.value();
        } else if (entry.type() == pugi::node_element) {
            if (!count(entry, value_elements_, limits_.max_value_elements, "value elements")) {
                return;
            }
            read_element(entry, element.children.emplace_back(), depth + 1);
        }
    }
    const bool is_empty = element.children.empty() && element.text.empty();
    if (!is_empty && (element.name == "Body" || element.name == "XmlElement")) {
        keep_xml(xml, false, element.raw);
    }
}

} // namespace busbar::nodeset
