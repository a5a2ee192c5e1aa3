#include <algorithm>
#include <iterator>

#include <busbar/controller/mapping_extensions.hpp>

#include "extension_attributes.hpp"
#include "extension_xml.hpp"

namespace busbar::controller {

namespace {

using detail::ExtensionAttribute;
using detail::ExtensionElement;

constexpr std::string_view nodeset_namespace = "http://opcfoundation.org/UA/2011/03/UANodeSet.xsd";

void put(pugi::xml_node xml, ExtensionAttribute attribute, const std::string& value)
{
    const std::string name{detail::name_of(attribute)};
    xml.append_attribute(name.c_str()).set_value(value.c_str());
}

pugi::xml_node append(pugi::xml_node to, ExtensionElement element)
{
    return to.append_child(std::string{detail::name_of(element)}.c_str());
}

void put_specification(pugi::xml_node xml, const ArraySpecification& specification)
{
    if (specification.rank == ArraySpecification::none) {
        return;
    }
    put(xml, ExtensionAttribute::Rank, std::to_string(specification.rank));
    constexpr std::array names{ExtensionAttribute::Dim1, ExtensionAttribute::Dim2,
                               ExtensionAttribute::Dim3};
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (specification.dimensions[i] != 0) {
            put(xml, names[i], std::to_string(specification.dimensions[i]));
        }
    }
}

/// Writes the attributes and parts of a value.
void put_value(pugi::xml_node xml, const MappedPart& part)
{
    if (!part.label.empty()) {
        put(xml, ExtensionAttribute::Data, part.label);
    }
    if (part.is_array) {
        put(xml, ExtensionAttribute::IsArray, "true");
    }
    if (part.is_structure) {
        put(xml, ExtensionAttribute::IsStructure, "true");
    }
    put_specification(xml, part.specification);
    for (const MappedPart& inner : part.parts) {
        if (inner.kind == MappedPart::Kind::Element) {
            const pugi::xml_node child = append(xml, ExtensionElement::Element);
            put(child, ExtensionAttribute::Num, std::to_string(inner.number));
            put_value(child, inner);
        } else {
            const pugi::xml_node child = append(xml, ExtensionElement::Field);
            put(child, ExtensionAttribute::Name, inner.name);
            put_value(child, inner);
        }
    }
}

pugi::xml_node append_mapping(pugi::xml_node to, ExtensionElement element, const std::string& sign)
{
    const pugi::xml_node xml = append(to, element);
    pugi::xml_node{xml}.append_attribute("xmlns").set_value(std::string{mapping_namespace}.c_str());
    put(xml, ExtensionAttribute::Sign, sign);
    return xml;
}

void put_data(pugi::xml_node to, const DataMapping& mapping)
{
    put_value(append_mapping(to, ExtensionElement::DataMapping, sign_of(mapping)), mapping.value);
}

void put_arguments(pugi::xml_node to, const std::vector<MappedPart>& arguments)
{
    for (const MappedPart& argument : arguments) {
        const pugi::xml_node child = append(to, ExtensionElement::Argument);
        put(child, ExtensionAttribute::Num, std::to_string(argument.number));
        put_value(child, argument);
    }
}

void put_method(pugi::xml_node to, const MethodMapping& mapping)
{
    pugi::xml_node xml = append_mapping(to, ExtensionElement::MethodMapping, sign_of(mapping));
    if (!mapping.handle.empty()) {
        put(append(xml, ExtensionElement::Handle), ExtensionAttribute::Data, mapping.handle);
    }
    if (!mapping.arguments.empty()) {
        put_arguments(append(xml, ExtensionElement::Input), mapping.arguments);
    }
}

bool has_addition(const DataMapping& mapping)
{
    return !mapping.quality.empty() || mapping.scaling.is_set();
}

bool has_addition(const MethodMapping& mapping)
{
    return !mapping.done.empty() || !mapping.outputs.empty();
}

/// Appends an element <Addition>; `to` is an <Extension> of its own.
pugi::xml_node append_addition(pugi::xml_node to)
{
    const pugi::xml_node xml = to.append_child("Addition");
    pugi::xml_node{xml}.append_attribute("xmlns").set_value(
        std::string{addition_namespace}.c_str());
    return xml;
}

void put_text(pugi::xml_node xml, const char* attribute, const std::string& value)
{
    if (!value.empty()) {
        xml.append_attribute(attribute).set_value(value.c_str());
    }
}

void put_addition(pugi::xml_node to, const DataMapping& mapping)
{
    const pugi::xml_node xml = append_addition(to);
    put_text(xml, "Quality", mapping.quality);
    put_text(xml, "Scaling", to_text(mapping.scaling));
}

void put_addition(pugi::xml_node to, const MethodMapping& mapping)
{
    pugi::xml_node xml = append_addition(to);
    put_text(xml, "Done", mapping.done);
    if (!mapping.outputs.empty()) {
        put_arguments(xml.append_child("Output"), mapping.outputs);
    }
}

bool is_extensions(const pugi::xml_node& xml)
{
    const pugi::xml_attribute declared = xml.attribute("xmlns");
    return detail::local_name(xml) == "Extensions" &&
           (!declared || declared.value() == nodeset_namespace);
}

/// Removes the mappings from an <Extensions>, and every <Extension> that becomes empty.
void take_mappings(pugi::xml_node extensions)
{
    for (pugi::xml_node extension = extensions.first_child(); extension;) {
        const pugi::xml_node next = extension.next_sibling();
        bool has_changed = false;
        for (pugi::xml_node child = extension.first_child(); child;) {
            const pugi::xml_node after = child.next_sibling();
            if (detail::local_name(extension) == "Extension" &&
                (detail::is_in_mapping_namespace(child) || detail::is_addition(child))) {
                extension.remove_child(child);
                has_changed = true;
            }
            child = after;
        }
        if (has_changed && !extension.first_child()) {
            extensions.remove_child(extension);
        }
        extension = next;
    }
}

class TextWriter : public pugi::xml_writer {
public:
    void write(const void* data, std::size_t size) override
    {
        text.append(static_cast<const char*>(data), size);
    }

    std::string text;
};

/// The XML kept for one node, whose mapping is replaced or removed.
class KeptElements {
public:
    explicit KeptElements(const std::string& text)
    {
        document_.load_buffer(text.data(), text.size(),
                              pugi::parse_default | pugi::parse_ws_pcdata | pugi::parse_comments |
                                  pugi::parse_pi | pugi::parse_fragment,
                              pugi::encoding_utf8);
        for (pugi::xml_node child = document_.first_child(); child;) {
            const pugi::xml_node next = child.next_sibling();
            if (is_extensions(child)) {
                take_mappings(child);
                if (child.first_child()) {
                    extensions_ = child;
                } else {
                    document_.remove_child(child);
                }
            }
            child = next;
        }
    }

    /// Appends a new <Extension>.
    [[nodiscard]] pugi::xml_node append()
    {
        if (!extensions_) {
            extensions_ = document_.append_child("Extensions");
        }
        return extensions_.append_child("Extension");
    }
    [[nodiscard]] std::string text() const
    {
        TextWriter out;
        for (const pugi::xml_node& child : document_.children()) {
            child.print(out, "", pugi::format_raw);
        }
        return std::move(out.text);
    }

private:
    pugi::xml_document document_;
    pugi::xml_node extensions_;
};

bool has_mapping(const model::NodeSetNodeExtras& extras)
{
    return extras.elements.find(mapping_namespace) != std::string::npos ||
           extras.elements.find(addition_namespace) != std::string::npos;
}

} // namespace

void write_mapping(const Mapping& mapping, std::span<const std::uint16_t> namespaces,
                   model::NodeSetExtras& extras)
{
    const auto is_one_of = [&](const NodeId& id) {
        return std::find(namespaces.begin(), namespaces.end(), id.namespace_index()) !=
               namespaces.end();
    };
    for (auto node = extras.nodes.begin(); node != extras.nodes.end();) {
        if (is_one_of(node->first) && has_mapping(node->second)) {
            node->second.elements = KeptElements{node->second.elements}.text();
        }
        node =
            node->second == model::NodeSetNodeExtras{} ? extras.nodes.erase(node) : std::next(node);
    }
    Mapping kept;
    const auto copy = [&](const auto& from, auto& to) {
        std::copy_if(from.begin(), from.end(), std::inserter(to, to.end()),
                     [&](const auto& each) { return is_one_of(each.first); });
    };
    copy(mapping.variables, kept.variables);
    copy(mapping.methods, kept.methods);
    drop_unmapped(kept);
    const auto write = [&](const NodeId& id, const auto& each, const auto& put_mapping) {
        std::string& elements = extras.nodes[id].elements;
        KeptElements xml{elements};
        put_mapping(xml.append(), each);
        if (has_addition(each)) {
            put_addition(xml.append(), each);
        }
        elements = xml.text();
    };
    for (const auto& [id, each] : kept.variables) {
        write(id, each, put_data);
    }
    for (const auto& [id, each] : kept.methods) {
        write(id, each, put_method);
    }
}

} // namespace busbar::controller
