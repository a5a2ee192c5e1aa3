#include "file_reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace busbar::nodeset {

namespace {

/// Attributes of nodes that become attributes and references of the AddressSpace; UserAccessLevel
/// and similar ones depend on the user and are obsolete in files (Part 6, F.9).
constexpr std::array<std::string_view, 20> known_attributes = {
    "NodeId",
    "BrowseName",
    "ParentNodeId",
    "DataType",
    "ValueRank",
    "ArrayDimensions",
    "AccessLevel",
    "MinimumSamplingInterval",
    "Historizing",
    "EventNotifier",
    "IsAbstract",
    "Symmetric",
    "ContainsNoLoops",
    "Executable",
    "UserAccessLevel",
    "UserExecutable",
    "MethodDeclarationId",
    "WriteMask",
    "AccessRestrictions",
    "HasNoPermissions",
};
constexpr std::array<std::string_view, 8> known_elements = {
    "DisplayName", "Description", "InverseName",     "References",
    "Value",       "Definition",  "RolePermissions", "UserRolePermissions",
};
constexpr const char* node_set_namespace = "http://opcfoundation.org/UA/2011/03/UANodeSet.xsd";

/// Collects printed XML up to a limit.
class KeptXml : public pugi::xml_writer {
public:
    explicit KeptXml(std::size_t limit) : limit_{limit} {}

    void write(const void* data, std::size_t size) override
    {
        is_full_ = is_full_ || text_.size() + size > limit_;
        if (!is_full_) {
            text_.append(static_cast<const char*>(data), size);
        }
    }
    [[nodiscard]] const std::string& text() const { return text_; }
    [[nodiscard]] bool is_full() const { return is_full_; }

private:
    std::size_t limit_;
    std::string text_;
    bool is_full_{false};
};

bool is_namespace_declaration(std::string_view attribute)
{
    return attribute == "xmlns" || attribute.starts_with("xmlns:");
}

/// Adds the declarations of the enclosing elements to `xml`, so that it is valid in any NodeSet2
/// file, whose own namespace is the default there.
void declare_namespaces(pugi::xml_node xml)
{
    for (pugi::xml_node above = xml.parent(); above; above = above.parent()) {
        for (const pugi::xml_attribute& attribute : above.attributes()) {
            const bool is_default = attribute.value() == std::string_view{node_set_namespace};
            if (is_namespace_declaration(attribute.name()) && !is_default &&
                !xml.attribute(attribute.name())) {
                xml.append_copy(attribute);
            }
        }
    }
}

} // namespace

void FileReader::keep_xml(const pugi::xml_node& xml, bool with_tag, std::string& to)
{
    const std::size_t room = limits_.max_kept_xml - document_.kept_xml_;
    KeptXml kept{room};
    if (with_tag) {
        declare_namespaces(xml);
        xml.print(kept, "", pugi::format_raw);
    } else {
        for (const pugi::xml_node& entry : xml.children()) {
            if (entry.type() == pugi::node_element) {
                declare_namespaces(entry);
            }
            entry.print(kept, "", pugi::format_raw);
        }
    }
    if (kept.is_full()) {
        fail(xml, "there are more than " + std::to_string(limits_.max_kept_xml) +
                      " bytes of extensions and XML values");
        return;
    }
    document_.kept_xml_ += kept.text().size();
    to += kept.text();
}

void FileReader::read_file_extensions(const pugi::xml_node& root)
{
    if (const pugi::xml_node extensions = child(root, "Extensions")) {
        keep_xml(extensions, false, document_.files_[file_].extensions);
    }
}

void FileReader::read_extras(const pugi::xml_node& xml, Node& node)
{
    model::NodeSetNodeExtras extras;
    read_kept_attributes(xml, extras);
    read_kept_elements(xml, extras);
    extras.method_declaration = node_id_attribute(xml, "MethodDeclarationId", {});
    if (node.definition) {
        extras.definition_name = node.definition->name;
        extras.definition_symbolic_name = node.definition->symbolic_name;
        const auto& fields = node.definition->fields;
        const bool has_names = std::any_of(fields.begin(), fields.end(), [](const Field& field) {
            return !field.symbolic_name.empty();
        });
        for (std::size_t i = 0; has_names && i < fields.size(); ++i) {
            extras.field_symbolic_names.push_back(fields[i].symbolic_name);
        }
    }
    if (!(extras == model::NodeSetNodeExtras{})) {
        node.extras = std::make_unique<model::NodeSetNodeExtras>(std::move(extras));
    }
}

void FileReader::read_kept_attributes(const pugi::xml_node& xml, model::NodeSetNodeExtras& extras)
{
    for (const pugi::xml_attribute& attribute : xml.attributes()) {
        const std::string_view name = attribute.name();
        const bool is_known = std::find(known_attributes.begin(), known_attributes.end(), name) !=
                              known_attributes.end();
        if (!is_known && !is_namespace_declaration(name)) {
            extras.attributes.push_back({std::string{name}, attribute.value()});
        }
    }
}

void FileReader::read_kept_elements(const pugi::xml_node& xml, model::NodeSetNodeExtras& extras)
{
    for (const pugi::xml_node& entry : xml.children()) {
        if (entry.type() != pugi::node_element) {
            continue;
        }
        const auto* const known =
            std::find(known_elements.begin(), known_elements.end(), local_name(entry));
        if (known == known_elements.end()) {
            keep_xml(entry, true, extras.elements);
        }
    }
}

std::vector<model::NodeSetPermission> FileReader::read_permissions(const pugi::xml_node& xml)
{
    std::vector<model::NodeSetPermission> permissions;
    for (const pugi::xml_node& entry : child(xml, "RolePermissions").children()) {
        if (local_name(entry) != "RolePermission") {
            continue;
        }
        if (!count(entry, references_, limits_.max_references, "references")) {
            break;
        }
        model::NodeSetPermission& permission = permissions.emplace_back();
        number_attribute(entry, "Permissions", permission.permissions);
        permission.role = node_id(entry, trimmed(entry.text().get()));
    }
    return permissions;
}

} // namespace busbar::nodeset
