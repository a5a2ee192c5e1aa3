#include "extension_reader.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

namespace {

bool is_white(std::string_view text)
{
    return text.find_first_not_of(" \t\r\n") == std::string_view::npos;
}

} // namespace

void ExtensionReader::read(const NodeId& node, NodeClass node_class, const std::string& xml,
                           Mapping& to)
{
    // Most nodes have no mapping; the text is as pugixml writes it, without entities in a URI.
    if (xml.find(mapping_namespace) == std::string::npos &&
        xml.find(addition_namespace) == std::string::npos &&
        xml.find("Mapping") == std::string::npos) {
        return;
    }
    node_ = &node;
    node_class_ = node_class;
    pugi::xml_document document;
    if (!document.load_buffer(xml.data(), xml.size(), pugi::parse_default | pugi::parse_fragment,
                              pugi::encoding_utf8)) {
        report(ModelCode::FormatInvalid, {}, "not well-formed XML");
        return;
    }
    for (const pugi::xml_node& kept : document.children()) {
        if (local_name(kept) == "Extensions") {
            read_extensions(kept, to);
        }
    }
    // Additions come last, since the mapping that they belong to may follow them.
    for (const pugi::xml_node& kept : document.children()) {
        for (const pugi::xml_node& extension : kept.children()) {
            if (local_name(kept) == "Extensions" && local_name(extension) == "Extension") {
                read_additions(extension, to);
            }
        }
    }
    check_sign(to);
}

void ExtensionReader::read_extensions(const pugi::xml_node& extensions, Mapping& to)
{
    for (const pugi::xml_node& extension : extensions.children()) {
        if (local_name(extension) == "Extension") {
            read_extension(extension, to);
        } else if (has_mapping_name(extension) && is_elsewhere_in_mapping_namespace(extension)) {
            report(ModelCode::FormatInvalid, {}, "it is not in an <Extension>");
        }
    }
}

void ExtensionReader::check_sign(const Mapping& mapping)
{
    const auto check = [&](const auto& all) {
        const auto found = all.find(*node_);
        if (found != all.end() && is_own_sign(found->second.sign) &&
            found->second.sign != sign_of(found->second)) {
            report(ModelCode::ChangedElsewhere, {}, found->second.sign);
        }
    };
    check(mapping.variables);
    check(mapping.methods);
}

void ExtensionReader::read_additions(const pugi::xml_node& extension, Mapping& to)
{
    for (const pugi::xml_node& child : extension.children()) {
        if (!is_addition(child)) {
            continue;
        }
        const auto variable = to.variables.find(*node_);
        const auto method = to.methods.find(*node_);
        if (variable != to.variables.end()) {
            read_addition(child, variable->second);
        } else if (method != to.methods.end()) {
            read_addition(child, method->second);
        } else {
            report(ModelCode::FormatInvalid, {}, "an <Addition> without a mapping");
        }
    }
}

/// Takes a label's name; reports one that is too long, and gives false.
bool ExtensionReader::take_label(const pugi::xml_attribute& xml, std::string& to)
{
    const std::string_view label = xml.value();
    if (label.empty() || character_count(label) > limits_.max_label_length) {
        report(ModelCode::AttributeInvalid, {},
               std::string{xml.name()} + "=\"" + printable(label, 80) + '"');
        return false;
    }
    to = label;
    return true;
}

void ExtensionReader::read_addition(const pugi::xml_node& xml, DataMapping& to)
{
    for (const pugi::xml_attribute& attribute : xml.attributes()) {
        const std::string_view name = attribute.name();
        if (name == "Quality") {
            static_cast<void>(take_label(attribute, to.quality));
        } else if (name == "Scaling") {
            if (const auto scaling = parse_scaling(attribute.value())) {
                to.scaling = *scaling;
            } else {
                report(ModelCode::AttributeInvalid, {},
                       "Scaling=\"" + printable(attribute.value(), 80) +
                           "\", expected \"0..27648=0..100\" or \"0..27648\"");
            }
        } else if (name != "xmlns") {
            report(ModelCode::AttributeUnknown, {}, name);
        }
    }
}

void ExtensionReader::read_addition(const pugi::xml_node& xml, MethodMapping& to)
{
    for (const pugi::xml_attribute& attribute : xml.attributes()) {
        const std::string_view name = attribute.name();
        if (name == "Done") {
            static_cast<void>(take_label(attribute, to.done));
        } else if (name != "xmlns") {
            report(ModelCode::AttributeUnknown, {}, name);
        }
    }
    keeps_format_ = true;
    for (const pugi::xml_node& child : xml.children()) {
        if (child.type() == pugi::node_element && std::string_view{child.name()} == "Output") {
            read_arguments(child, to.outputs);
        } else if (child.type() == pugi::node_element) {
            report(ModelCode::ElementUnknown, {}, child.name());
        }
    }
    if (!keeps_format_) {
        to.outputs.clear();
    }
}

void ExtensionReader::read_extension(const pugi::xml_node& xml, Mapping& to)
{
    for (const pugi::xml_node& child : xml.children()) {
        if (child.type() != pugi::node_element) {
            continue;
        }
        if (is_addition(child)) {
            continue; // read only once the mapping exists
        }
        if (is_in_mapping_namespace(child)) {
            read_mapping(child, to);
        } else if (has_mapping_name(child) &&
                   (is_elsewhere_in_mapping_namespace(child) || has_no_namespace(child))) {
            report(ModelCode::NamespaceMisplaced, {}, child.name());
        }
    }
}

void ExtensionReader::read_mapping(const pugi::xml_node& xml, Mapping& to)
{
    const std::string_view name = xml.name();
    const bool is_data = name == name_of(ExtensionElement::DataMapping);
    const bool is_method = name == name_of(ExtensionElement::MethodMapping);
    if (!is_data && !is_method) {
        report(ModelCode::ElementUnknown, {}, name);
    } else if (node_class_ != (is_data ? NodeClass::Variable : NodeClass::Method)) {
        report(ModelCode::WrongNodeClass, {}, name);
    } else if (to.variables.count(*node_) + to.methods.count(*node_) != 0) {
        report(ModelCode::MappingRepeated, {}, name);
    } else if (is_data) {
        read_data(xml, to);
    } else {
        read_method(xml, to);
    }
}

void ExtensionReader::read_data(const pugi::xml_node& xml, Mapping& to)
{
    keeps_format_ = true;
    PartAttributes attributes;
    if (!read_attributes(xml, ExtensionElement::DataMapping, {}, attributes)) {
        return;
    }
    DataMapping mapping{.value = std::move(attributes.part), .sign = std::move(attributes.sign)};
    read_value(xml, 1, {}, mapping.value);
    if (!keeps_format_) {
        return;
    }
    to.variables.emplace(*node_, std::move(mapping));
}

void ExtensionReader::read_method(const pugi::xml_node& xml, Mapping& to)
{
    keeps_format_ = true;
    PartAttributes attributes;
    if (!read_attributes(xml, ExtensionElement::MethodMapping, {}, attributes) ||
        !has_only_elements(xml)) {
        return;
    }
    MethodMapping mapping;
    mapping.sign = std::move(attributes.sign);
    for (const pugi::xml_node& child : xml.children()) {
        read_method_part(child, mapping);
    }
    if (!keeps_format_) {
        return;
    }
    std::stable_sort(mapping.arguments.begin(), mapping.arguments.end(),
                     [](const auto& a, const auto& b) { return a.number < b.number; });
    to.methods.emplace(*node_, std::move(mapping));
}

void ExtensionReader::read_method_part(const pugi::xml_node& xml, MethodMapping& to)
{
    if (xml.type() != pugi::node_element) {
        return;
    }
    const std::string_view name = xml.name();
    if (name == name_of(ExtensionElement::Handle)) {
        read_handle(xml, to);
    } else if (name == name_of(ExtensionElement::Input)) {
        read_input(xml, to);
    } else {
        break_format(ModelCode::ElementUnknown, {}, name);
    }
}

void ExtensionReader::read_handle(const pugi::xml_node& xml, MethodMapping& to)
{
    PartAttributes attributes;
    if (!to.handle.empty()) {
        break_format(ModelCode::FormatInvalid, {}, "a second <Handle>");
    } else if (xml.first_child()) {
        break_format(ModelCode::FormatInvalid, {}, "something in <Handle>");
    } else if (read_attributes(xml, ExtensionElement::Handle, {}, attributes)) {
        to.handle = std::move(attributes.part.label);
    }
}

void ExtensionReader::read_input(const pugi::xml_node& xml, MethodMapping& to)
{
    PartAttributes attributes;
    if (read_attributes(xml, ExtensionElement::Input, {}, attributes)) {
        read_arguments(xml, to.arguments);
    }
}

void ExtensionReader::read_arguments(const pugi::xml_node& xml, std::vector<MappedPart>& to)
{
    if (!has_only_elements(xml)) {
        return;
    }
    for (const pugi::xml_node& child : xml.children()) {
        if (child.type() != pugi::node_element) {
            continue;
        }
        if (child.name() != name_of(ExtensionElement::Argument)) {
            break_format(ModelCode::ElementUnknown, {}, child.name());
            return;
        }
        read_argument(child, to);
    }
}

void ExtensionReader::read_argument(const pugi::xml_node& xml, std::vector<MappedPart>& to)
{
    PartAttributes attributes;
    if (!read_attributes(xml, ExtensionElement::Argument, {}, attributes)) {
        return;
    }
    MappedPart shown = attributes.part;
    shown.kind = MappedPart::Kind::Element;
    read_value(xml, 1, PartPlace{nullptr, &shown}, attributes.part);
    if (keeps_format_) {
        to.push_back(std::move(attributes.part));
    }
}

void ExtensionReader::read_value(const pugi::xml_node& xml, std::size_t level,
                                 const PartPlace& place, MappedPart& value)
{
    const Inside inside{level, 0, value.is_array, value.is_structure && !value.is_array};
    drop_misplaced_label(place, value);
    read_parts(xml, inside, place, value);
}

/// Removes the label of an array or structure: only elements and fields have labels (note 5).
void ExtensionReader::drop_misplaced_label(const PartPlace& place, MappedPart& part)
{
    if (!part.label.empty() && (part.is_array || part.is_structure)) {
        report(ModelCode::LabelMisplaced, place, part.label);
        part.label.clear();
    }
}

void ExtensionReader::read_parts(const pugi::xml_node& xml, const Inside& inside,
                                 const PartPlace& place, MappedPart& to)
{
    if (!has_only_elements(xml)) {
        return;
    }
    for (const pugi::xml_node& child : xml.children()) {
        if (child.type() != pugi::node_element || !keeps_format_) {
            continue;
        }
        if (inside.level > limits_.max_part_levels || ++part_count_ > limits_.max_parts) {
            break_format(ModelCode::TooManyParts, place, {});
            return;
        }
        read_part(child, inside, place, to);
    }
}

void ExtensionReader::read_part(const pugi::xml_node& xml, const Inside& inside,
                                const PartPlace& above, MappedPart& to)
{
    const std::string_view name = xml.name();
    const bool is_element = name == name_of(ExtensionElement::Element) && inside.allows_elements;
    const bool is_field = name == name_of(ExtensionElement::Field) && inside.allows_fields;
    if (!is_element && !is_field) {
        break_format(ModelCode::ElementUnknown, above, name);
        return;
    }
    const auto kind = is_element ? MappedPart::Kind::Element : MappedPart::Kind::Field;
    if (!to.parts.empty() && to.parts.back().kind != kind) {
        break_format(ModelCode::FormatInvalid, above, "elements and fields side by side");
        return;
    }
    PartAttributes attributes;
    if (!read_attributes(xml, is_element ? ExtensionElement::Element : ExtensionElement::Field,
                         above, attributes)) {
        return;
    }
    MappedPart part = std::move(attributes.part);
    part.kind = kind;
    const MappedPart shown{.kind = kind, .number = part.number, .name = part.name};
    const PartPlace place{&above, &shown};
    if (is_field) {
        read_value(xml, inside.level + 1, place, part);
    } else {
        constexpr std::size_t max_dimensions = 3;
        Inside next = inside;
        ++next.level;
        ++next.dimension;
        next.allows_elements = next.dimension < max_dimensions;
        next.allows_fields = to.is_structure || inside.allows_fields;
        read_parts(xml, next, place, part);
        if (!part.label.empty() && !part.parts.empty()) {
            report(ModelCode::LabelMisplaced, place, part.label);
            part.label.clear();
        }
    }
    to.parts.push_back(std::move(part));
}

bool ExtensionReader::has_only_elements(const pugi::xml_node& xml)
{
    for (const pugi::xml_node& child : xml.children()) {
        const bool is_text = child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata;
        if (is_text && !is_white(child.value())) {
            break_format(ModelCode::FormatInvalid, {}, "a text in it");
            return false;
        }
    }
    return true;
}

bool ExtensionReader::read_attributes(const pugi::xml_node& xml, ExtensionElement element,
                                      const PartPlace& place, PartAttributes& to)
{
    bool is_whole = true;
    unsigned seen = 0;
    for (const pugi::xml_attribute& attribute : xml.attributes()) {
        const std::string_view name = attribute.name();
        if (name == "xmlns" || name.starts_with("xmlns:")) {
            continue;
        }
        is_whole = read_attribute(attribute, element, place, to) && is_whole;
        if (const AttributeRule* rule = rule_of_attribute(name)) {
            seen |= 1U << static_cast<unsigned>(rule->attribute);
        }
    }
    for (const auto required :
         {ExtensionAttribute::Num, ExtensionAttribute::Name, ExtensionAttribute::Data}) {
        const AttributeRule& rule = *rule_of_attribute(name_of(required));
        if (rule.uses[static_cast<std::size_t>(element)] == AttributeUse::Required &&
            (seen & (1U << static_cast<unsigned>(required))) == 0) {
            report(ModelCode::AttributeMissing, place,
                   std::string{name_of(required)} + " of <" + xml.name() + '>');
            is_whole = false;
        }
    }
    settle_specification(place, to.part.specification);
    return is_whole;
}

bool ExtensionReader::read_attribute(const pugi::xml_attribute& xml, ExtensionElement element,
                                     const PartPlace& place, PartAttributes& to)
{
    const std::string_view value = xml.value();
    const std::string found = std::string{xml.name()} + "=\"" + printable(value, 80) + '"';
    const AttributeRule* const rule = rule_of_attribute(xml.name());
    if (rule == nullptr) {
        report(ModelCode::AttributeUnknown, place, found);
        return false;
    }
    const AttributeUse use = rule->uses[static_cast<std::size_t>(element)];
    if (use == AttributeUse::Ignored ||
        take_value(rule->attribute, value, limits_.max_elements, limits_.max_label_length, to)) {
        return true;
    }
    if (use == AttributeUse::Required) {
        report(ModelCode::AttributeInvalid, place, found);
        return false;
    }
    if (!is_white(value)) {
        report(ModelCode::ValueOmitted, place, found);
    }
    return true;
}

/// Clears dimensions that have no rank (note 6) or too many elements in total (note 7).
void ExtensionReader::settle_specification(const PartPlace& place,
                                           ArraySpecification& specification)
{
    auto& dimensions = specification.dimensions;
    if (specification.rank == ArraySpecification::none) {
        dimensions = {};
        return;
    }
    std::uint64_t product = 1;
    for (std::int32_t i = 0; i < specification.rank; ++i) {
        const std::uint32_t dimension = dimensions[static_cast<std::size_t>(i)];
        product *= std::max(dimension, 1U);
        if (product > limits_.max_elements) {
            report(ModelCode::ValueOmitted, place, "dimensions of too many elements together");
            dimensions = {};
            return;
        }
    }
}

void ExtensionReader::report(ModelCode code, const PartPlace& place, std::string_view found)
{
    std::string where = file_.empty() ? std::string{} : std::string{file_} + ": ";
    where += to_string(*node_);
    const std::string path = path_of(place);
    where += path.empty() ? path : ": " + path;
    reports_.add({code, *node_, printable(where, 512), printable(found, 256)});
}

} // namespace busbar::controller::detail

namespace busbar::controller {

ReadMapping read_mapping(const model::SpaceReader& space, const model::NodeSetExtras& extras,
                         std::string_view file, const ModelLimits& limits)
{
    ReadMapping result;
    detail::ExtensionReader reader{file, limits, result.reports};
    // Sort by NodeId, so that reports do not depend on a hash.
    std::vector<const std::pair<const NodeId, model::NodeSetNodeExtras>*> nodes;
    for (const auto& each : extras.nodes) {
        if (!each.second.elements.empty()) {
            nodes.push_back(&each);
        }
    }
    std::sort(nodes.begin(), nodes.end(),
              [](const auto* a, const auto* b) { return a->first < b->first; });
    for (const auto* each : nodes) {
        const model::NodeIndex node = space.find(each->first);
        if (node != model::no_node) {
            reader.read(each->first, space.node_class(node), each->second.elements, result.mapping);
        }
    }
    return result;
}

} // namespace busbar::controller
