#include "file_reader.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>

#include "core/utf8.hpp"
#include "xml_text.hpp"

namespace busbar::nodeset {

namespace {

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

/// Returns whether the XML declaration names Latin-1, the only other encoding of single bytes that
/// the parser converts.
bool is_latin1(std::string_view text)
{
    const std::string_view declaration = text.substr(0, text.substr(0, 200).find("?>"));
    return text.starts_with("<?xml") && (declaration.find("8859-1\"") != std::string_view::npos ||
                                         declaration.find("8859-1'") != std::string_view::npos ||
                                         declaration.find("latin1") != std::string_view::npos);
}

/// Returns the number of the first line that is not UTF-8; 0 if there is none.
std::uint32_t bad_line(std::string_view text)
{
    if (busbar::detail::is_utf8(text) || is_latin1(text)) {
        return 0;
    }
    std::uint32_t number = 1;
    for (;; ++number) { // a sequence never has the byte of a line's end
        const std::size_t end = text.find('\n');
        if (!busbar::detail::is_utf8(text.substr(0, end)) || end == std::string_view::npos) {
            return number;
        }
        text.remove_prefix(end + 1);
    }
}

} // namespace

FileReader::FileReader(Document& document, std::string name, bool is_lenient)
    : document_{document}, limits_{document.limits_}, name_{std::move(name)}, is_lenient_{
                                                                                  is_lenient}
{
}

std::vector<Problem> FileReader::read(std::string_view text)
{
    const std::string utf8 = from_utf16(text);
    if (!parse(utf8.empty() ? text : std::string_view{utf8})) {
        return std::move(errors_);
    }
    const pugi::xml_node root = xml_.document_element();
    if (local_name(root) != "UANodeSet") {
        fail(root, "found <" + printable(local_name(root), 80) + ">, expected <UANodeSet>");
        return std::move(errors_);
    }
    file_ = static_cast<std::uint32_t>(document_.files_.size());
    document_.files_.push_back({name_, {0}, {}, is_lenient_});
    read_namespaces(root);
    read_aliases(root);
    read_models(child(root, "Models"), document_.models_, 0);
    read_file_extensions(root);
    read_nodes(root);
    return std::move(errors_);
}

bool FileReader::parse(std::string_view text)
{
    for (std::size_t i = text.find('\n'); i != std::string_view::npos; i = text.find('\n', i + 1)) {
        line_ends_.push_back(static_cast<std::ptrdiff_t>(i));
    }
    if (const std::uint32_t line = bad_line(text); line != 0) {
        errors_.push_back(problem_at(name_, line,
                                     "found bytes that are not UTF-8 (Part 6, 5.2.2.4); save the "
                                     "file as UTF-8 or name its encoding in the first line"));
        return false;
    }
    // A text of only blanks is a value; a DOCTYPE is parsed in order to refuse it.
    const auto parsed =
        xml_.load_buffer(text.data(), text.size(),
                         pugi::parse_default | pugi::parse_doctype | pugi::parse_ws_pcdata_single);
    if (!parsed) {
        errors_.push_back(
            problem_at(name_, line_at(parsed.offset),
                       std::string{"is not well-formed XML: "} + parsed.description()));
        return false;
    }
    for (const pugi::xml_node& node : xml_.children()) {
        if (node.type() == pugi::node_doctype) {
            errors_.push_back(
                problem_at(name_, 0, "has a DOCTYPE, which a NodeSet2 file must not have"));
            return false;
        }
    }
    return true;
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
        document_.files_[file_].namespaces.push_back(*index);
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
        if (depth != 0 &&
            !count(xml, required_models_, limits_.max_namespaces, "required models")) {
            return;
        }
        Model model;
        for (const pugi::xml_attribute& attribute : xml.attributes()) {
            read_model_attribute(attribute, model);
        }
        if (xml.attribute("AccessRestrictions")) {
            number_attribute(xml, "AccessRestrictions", model.access_restrictions.emplace());
        }
        model.file = file_;
        model.line = line_of(xml);
        model.role_permissions = read_permissions(xml);
        if (depth == 0) {
            read_models(xml, model.required, depth + 1);
        }
        models.push_back(std::move(model));
    }
}

void FileReader::read_model_attribute(const pugi::xml_attribute& attribute, Model& model)
{
    const std::string_view name = attribute.name();
    if (name == "ModelUri") {
        model.uri = attribute.value();
    } else if (name == "Version") {
        model.version = attribute.value();
    } else if (name == "ModelVersion") {
        model.model_version = attribute.value();
    } else if (name == "PublicationDate") {
        model.publication_date = attribute.value();
    } else {
        model.attributes.push_back({std::string{name}, attribute.value()});
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
            continue; // NamespaceUris, Models, Aliases, Extensions and elements of later versions
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
        current_node_.clear();
    }
}

void FileReader::read_node(const pugi::xml_node& xml, NodeClass node_class)
{
    Node node;
    node.node_class = node_class;
    node.file = file_;
    node.line = line_of(xml);
    current_node_ = xml.attribute("NodeId").value();
    node.id = node_id_attribute(xml, "NodeId", {});
    if (node.id.is_null()) {
        fail(xml, "found a node without NodeId");
        return;
    }
    if (const Node* other = document_.find(node.id); other != nullptr) {
        fail(xml, "the node is already at " + document_.files_[other->file].name + ":" +
                      std::to_string(other->line));
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
    read_extras(xml, node);
    document_.by_id_.emplace(node.id, document_.nodes_.size());
    document_.nodes_.push_back(std::move(node));
}

} // namespace busbar::nodeset
