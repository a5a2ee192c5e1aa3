#include <busbar/binary/dynamic_types.hpp>

#include <busbar/core/text.hpp>

#include "type_compiler.hpp"

namespace busbar::binary {

std::string to_string(const DefinitionError& error)
{
    std::string text = to_string(error.type) + " (" + error.type_name + ")";
    if (!error.field.empty()) {
        text += ", field " + error.field;
    }
    return printable(text + ": " + error.reason, 1'024);
}

std::optional<std::size_t> DynamicType::find_field(std::string_view field_name) const
{
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (fields[i].name == field_name) {
            return i;
        }
    }
    return std::nullopt;
}

bool DynamicType::is_subtype_of(const DynamicType& other) const
{
    const DynamicType* at = this;
    while (at != nullptr && at != &other) {
        at = at->base;
    }
    return at != nullptr;
}

DynamicTypes DynamicTypes::compile(std::vector<DataTypeEntry> entries,
                                   const DynamicTypeLimits& limits)
{
    detail::TypeCompiler compiler{std::move(entries), limits};
    compiler.run();
    DynamicTypes result;
    for (detail::TypeCompiler::Entry& entry : compiler.entries()) {
        const DynamicType* const type = entry.type.get();
        // Types that are left out remain as supertypes of others.
        result.types_.push_back(std::move(entry.type));
        if (entry.is_wrong) {
            continue;
        }
        result.by_id_.emplace(type->id, type);
        if (!type->is_structure() || type->is_abstract || type->encoding_id.is_null()) {
            continue;
        }
        if (!result.by_encoding_.emplace(type->encoding_id, type).second) {
            compiler.errors().push_back({status::Bad_NodeAttributesInvalid, type->id, type->name,
                                         "", "another type uses the same encoding id"});
        }
    }
    result.errors_ = std::move(compiler.errors());
    return result;
}

const DynamicType* DynamicTypes::find(const NodeId& data_type) const
{
    const auto found = by_id_.find(data_type);
    return found == by_id_.end() ? nullptr : found->second;
}

const DynamicType* DynamicTypes::find_encoding(const NodeId& encoding_id) const
{
    const auto found = by_encoding_.find(encoding_id);
    return found == by_encoding_.end() ? nullptr : found->second;
}

} // namespace busbar::binary
