#include "file_reader.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>

#include "xml_text.hpp"

namespace busbar::nodeset {

namespace {

std::string quoted(std::string_view text)
{
    return '"' + printable(text, 80) + '"';
}

struct ClassName {
    std::string_view element;
    NodeClass node_class;
};

constexpr ClassName class_names[] = {
    {"UAObject", NodeClass::Object},
    {"UAVariable", NodeClass::Variable},
    {"UAMethod", NodeClass::Method},
    {"UAObjectType", NodeClass::ObjectType},
    {"UAVariableType", NodeClass::VariableType},
    {"UAReferenceType", NodeClass::ReferenceType},
    {"UADataType", NodeClass::DataType},
    {"UAView", NodeClass::View},
};

} // namespace

FileReader::FileReader(Document& document, std::string name)
    : document_{document}, limits_{document.limits_}, name_{std::move(name)}
{
}

std::vector<Error> FileReader::read(std::string_view text)
{
    for (std::size_t i = text.find('\n'); i != std::string_view::npos; i = text.find('\n', i + 1)) {
        line_ends_.push_back(static_cast<std::ptrdiff_t>(i));
    }
    const auto parsed = xml_.load_buffer(text.data(), text.size());
    if (!parsed) {
        errors_.push_back({name_, line_at(parsed.offset),
                           std::string{"is no well-formed XML: "} + parsed.description()});
        return std::move(errors_);
    }
    const pugi::xml_node root = xml_.document_element();
    if (local_name(root) != "UANodeSet") {
        fail(root, "found <" + printable(local_name(root), 80) + ">, expected <UANodeSet>");
        return std::move(errors_);
    }
    file_ = static_cast<std::uint32_t>(document_.files_.size());
    document_.files_.push_back(name_);
    read_namespaces(root);
    read_models(child(root, "Models"), document_.models_, 0);
    read_aliases(root);
    read_nodes(root);
    return std::move(errors_);
}

void FileReader::read_namespaces(const pugi::xml_node& root)
{
    for (const pugi::xml_node& xml : child(root, "NamespaceUris").children()) {
        if (local_name(xml) != "Uri") {
            continue;
        }
        const std::string uri{trimmed(xml.text().get())};
        auto index = document_.namespace_index(uri);
        if (!index) {
            if (uri.empty() || document_.namespaces_.size() >= limits_.max_namespaces) {
                fail(xml, uri.empty() ? "found an empty <Uri>" : "there are too many namespaces");
                return;
            }
            index = static_cast<std::uint16_t>(document_.namespaces_.size());
            document_.namespaces_.push_back(uri);
        }
        namespace_map_.push_back(*index);
    }
}

void FileReader::read_models(const pugi::xml_node& parent, std::vector<Model>& models,
                             unsigned depth)
{
    for (const pugi::xml_node& xml : parent.children()) {
        const auto element = local_name(xml);
        if ((element != "Model" && element != "RequiredModel") ||
            models.size() >= limits_.max_namespaces) {
            continue;
        }
        Model model;
        model.uri = xml.attribute("ModelUri").value();
        model.version = xml.attribute("Version").value();
        model.publication_date = xml.attribute("PublicationDate").value();
        if (depth == 0) {
            read_models(xml, model.required, depth + 1);
        }
        models.push_back(std::move(model));
    }
}

void FileReader::read_aliases(const pugi::xml_node& root)
{
    std::size_t counter = 0;
    for (const pugi::xml_node& xml : child(root, "Aliases").children()) {
        if (local_name(xml) != "Alias") {
            continue;
        }
        if (!count(xml, counter, limits_.max_aliases, "aliases")) {
            return;
        }
        const NodeId id = node_id(xml, trimmed(xml.text().get()));
        aliases_.insert_or_assign(xml.attribute("Alias").value(), id);
    }
}

void FileReader::read_nodes(const pugi::xml_node& root)
{
    for (const pugi::xml_node& xml : root.children()) {
        const auto element = local_name(xml);
        if (xml.type() != pugi::node_element || element.substr(0, 2) != "UA") {
            continue; // NamespaceUris, Models, Aliases, Extensions and what later versions add
        }
        const auto* found =
            std::find_if(std::begin(class_names), std::end(class_names),
                         [&](const ClassName& entry) { return entry.element == element; });
        if (found == std::end(class_names)) {
            fail(xml, "found <" + printable(element, 80) +
                          ">, expected <UAObject>, <UAVariable> or another NodeClass");
            continue;
        }
        if (document_.nodes_.size() >= limits_.max_nodes) {
            fail(xml, "there are more than " + std::to_string(limits_.max_nodes) + " nodes");
            return;
        }
        read_node(xml, found->node_class);
    }
}

void FileReader::read_node(const pugi::xml_node& xml, NodeClass node_class)
{
    Node node;
    node.node_class = node_class;
    node.file = file_;
    node.line = line_of(xml);
    node.id = node_id_attribute(xml, "NodeId", {});
    if (node.id.is_null()) {
        fail(xml, "found a node without NodeId");
        return;
    }
    if (const Node* other = document_.find(node.id); other != nullptr) {
        fail(xml, "the node " + to_string(node.id) + " is already at " +
                      document_.files_[other->file] + ":" + std::to_string(other->line));
        return;
    }
    read_names(xml, node);
    read_attributes(xml, node);
    read_references(xml, node);
    if (node_class == NodeClass::DataType) {
        read_definition(xml, node);
    }
    if (node_class == NodeClass::Variable || node_class == NodeClass::VariableType) {
        read_value(xml, node);
    }
    document_.by_id_.emplace(node.id, document_.nodes_.size());
    document_.nodes_.push_back(std::move(node));
}

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
    const auto localized = [&](const char* element, LocalizedText& text) {
        const pugi::xml_node found = child(xml, element);
        text.locale = found.attribute("Locale").value();
        text.text = found.text().get();
    };
    localized("DisplayName", node.display_name);
    localized("Description", node.description);
    localized("InverseName", node.inverse_name);
    if (node.display_name.text.empty()) {
        node.display_name.text = node.browse_name;
    }
}

void FileReader::read_attributes(const pugi::xml_node& xml, Node& node)
{
    node.parent = node_id_attribute(xml, "ParentNodeId", {});
    node.data_type = node_id_attribute(xml, "DataType", node.data_type);
    node.method_declaration = node_id_attribute(xml, "MethodDeclarationId", {});
    number_attribute(xml, "WriteMask", node.write_mask);
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
    element.is_nil = !xml.first_child() || std::string_view{nil_attribute(xml)} == "true";
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
}

NodeId FileReader::node_id(const pugi::xml_node& where, std::string_view text)
{
    if (text.find('=') == std::string_view::npos) {
        const auto alias = aliases_.find(std::string{text});
        if (alias == aliases_.end()) {
            fail(where, "found " + quoted(text) + ", expected a NodeId or one of the <Aliases>");
            return {};
        }
        return alias->second;
    }
    auto id = NodeId::parse(text);
    if (!id) {
        fail(where, "found " + quoted(text) + ", expected a NodeId such as \"ns=1;i=42\"");
        return {};
    }
    id->set_namespace_index(namespace_of(where, id->namespace_index()));
    return std::move(*id);
}

NodeId FileReader::node_id_attribute(const pugi::xml_node& xml, const char* attribute,
                                     const NodeId& otherwise)
{
    const pugi::xml_attribute found = xml.attribute(attribute);
    const auto text = trimmed(found.value());
    return text.empty() ? otherwise : node_id(xml, text);
}

std::uint16_t FileReader::namespace_of(const pugi::xml_node& where, std::size_t local)
{
    if (local >= namespace_map_.size()) {
        fail(where, "found the namespace index " + std::to_string(local) + ", the file lists " +
                        std::to_string(namespace_map_.size() - 1) + " in <NamespaceUris>");
        return 0;
    }
    return namespace_map_[local];
}

template <typename Number>
void FileReader::number_attribute(const pugi::xml_node& xml, const char* attribute, Number& value)
{
    const pugi::xml_attribute found = xml.attribute(attribute);
    if (found && !to_number(trimmed(found.value()), value)) {
        fail(xml, std::string{"found "} + attribute + "=" + quoted(found.value()) +
                      ", expected a number in the range of the attribute");
    }
}

void FileReader::bool_attribute(const pugi::xml_node& xml, const char* attribute, bool& value)
{
    const pugi::xml_attribute found = xml.attribute(attribute);
    if (found && !to_bool(trimmed(found.value()), value)) {
        fail(xml, std::string{"found "} + attribute + "=" + quoted(found.value()) +
                      ", expected true or false");
    }
}

void FileReader::dimensions_attribute(const pugi::xml_node& xml, std::vector<std::uint32_t>& value)
{
    const pugi::xml_attribute found = xml.attribute("ArrayDimensions");
    if (found && !to_numbers(found.value(), value)) {
        fail(xml, "found ArrayDimensions=" + quoted(found.value()) +
                      ", expected numbers separated by commas");
    }
}

void FileReader::fail(const pugi::xml_node& where, std::string message)
{
    if (errors_.size() < limits_.max_errors) {
        errors_.push_back({name_, line_of(where), std::move(message)});
    }
}

bool FileReader::count(const pugi::xml_node& where, std::size_t& counter, std::size_t limit,
                       const char* what)
{
    if (counter >= limit) {
        if (counter == limit) {
            fail(where, "there are more than " + std::to_string(limit) + " " + what);
            ++counter;
        }
        return false;
    }
    ++counter;
    return true;
}

std::uint32_t FileReader::line_at(std::ptrdiff_t offset) const
{
    const auto line = std::lower_bound(line_ends_.begin(), line_ends_.end(), offset);
    return static_cast<std::uint32_t>(line - line_ends_.begin()) + 1;
}

std::uint32_t FileReader::line_of(const pugi::xml_node& node) const
{
    return line_at(node.offset_debug());
}

} // namespace busbar::nodeset
