#include "type_questions.hpp"

#include <algorithm>
#include <array>

#include <busbar/client/attributes.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "binary/dynamic/data_type_root.hpp"

namespace busbar::client::detail {

namespace {

/// Returns the first target on this server, with this BrowseName of namespace 0 if there is one.
NodeId target_of(const BrowseResult& answer, std::string_view name = {})
{
    for (const ReferenceDescription& reference : answer.references) {
        const bool is_named =
            reference.browse_name.namespace_index == 0 && reference.browse_name.name.view() == name;
        if (reference.node_id.is_local() && (name.empty() || is_named)) {
            return reference.node_id.node_id;
        }
    }
    return {};
}

} // namespace

BrowseDescription references_of(const NodeId& node, std::uint32_t type, BrowseDirection direction)
{
    BrowseDescription description = children_of(node);
    description.reference_type_id = NodeId{0, type};
    description.browse_direction = direction;
    return description;
}

bool is_answer(StatusCode status)
{
    constexpr std::array answers{status::Bad_AttributeIdInvalid, status::Bad_NodeIdUnknown,
                                 status::Bad_NodeIdInvalid,      status::Bad_NotReadable,
                                 status::Bad_UserAccessDenied,   status::Bad_NotSupported};
    return !status.is_bad() ||
           std::find(answers.begin(), answers.end(), status.code()) != answers.end();
}

void ask_attributes(const NodeId& type, std::vector<ReadValueId>& items)
{
    items.push_back(attribute_of(type, AttributeId::DataTypeDefinition));
    items.push_back(attribute_of(type, AttributeId::BrowseName));
    items.push_back(attribute_of(type, AttributeId::IsAbstract));
}

void ask_references(const NodeId& type, std::vector<BrowseDescription>& items)
{
    items.push_back(references_of(type, id::HasSubtype, BrowseDirection::Inverse));
    items.push_back(references_of(type, id::HasEncoding, BrowseDirection::Forward));
    items.push_back(references_of(type, id::HasProperty, BrowseDirection::Forward));
}

BrowseDescription ask_type_of(const NodeId& encoding)
{
    return references_of(encoding, id::HasEncoding, BrowseDirection::Inverse);
}

std::optional<NodeId> type_of(const BrowseResult& answer)
{
    NodeId type = target_of(answer);
    return is_answer(answer.status_code) ? std::optional{std::move(type)} : std::nullopt;
}

TypeAnswers read_answers(const NodeId& type, std::span<DataValue> values,
                         std::span<const BrowseResult> references)
{
    TypeAnswers answers;
    binary::DataTypeEntry& entry = answers.entry;
    entry.id = type;
    answers.has_failed = !is_answer(values[0].status) || !is_answer(values[1].status) ||
                         !is_answer(references[0].status_code);
    if (const auto* const name = values[1].value.get_if<QualifiedName>()) {
        entry.name = name->name;
    }
    entry.is_abstract = values[2].value.value_or(false);
    entry.base = target_of(references[0]);
    entry.encoding_id = target_of(references[1], "Default Binary");
    const auto* const object = values[0].value.get_if<ExtensionObject>();
    if (object != nullptr && object->get_if<StructureDefinition>() != nullptr) {
        entry.definition = *object->get_if<StructureDefinition>();
    } else if (object != nullptr && object->get_if<EnumDefinition>() != nullptr) {
        entry.definition = *object->get_if<EnumDefinition>();
    } else {
        for (const char* const name : {"EnumValues", "EnumStrings", "OptionSetValues"}) {
            answers.names =
                answers.names.is_null() ? target_of(references[2], name) : answers.names;
        }
    }
    return answers;
}

std::optional<EnumDefinition> definition_of(const Variant& names)
{
    EnumDefinition definition;
    const auto add = [&](std::int64_t value, const LocalizedText& name) {
        EnumField& field = definition.fields.emplace_back();
        field.value = value;
        field.name = name.text;
    };
    if (const auto* const texts = names.array_if<LocalizedText>()) {
        for (std::size_t i = 0; i < texts->size(); ++i) {
            // Bits without a meaning have no name (Part 3, 5.8.2).
            if (!(*texts)[i].text.empty()) {
                add(static_cast<std::int64_t>(i), (*texts)[i]);
            }
        }
    } else if (const auto* const objects = names.array_if<ExtensionObject>()) {
        for (const ExtensionObject& object : *objects) {
            if (const auto* const value = object.get_if<EnumValueType>()) {
                add(value->value, value->display_name);
            }
        }
    }
    return definition.fields.empty() ? std::nullopt : std::optional{std::move(definition)};
}

bool is_known_to_all(const NodeId& type)
{
    return type.is_null() || binary::detail::data_type_root(type).has_value();
}

std::vector<NodeId> needed_by(const binary::DataTypeEntry& entry)
{
    std::vector<NodeId> needed{entry.base};
    if (const auto* const structure = std::get_if<StructureDefinition>(&entry.definition)) {
        needed.push_back(structure->base_data_type);
        for (const StructureField& field : structure->fields) {
            needed.push_back(field.data_type);
        }
    }
    std::erase_if(needed, is_known_to_all);
    return needed;
}

} // namespace busbar::client::detail
