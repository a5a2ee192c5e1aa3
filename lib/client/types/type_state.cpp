#include "type_state.hpp"

#include <algorithm>
#include <utility>

namespace busbar::client {

TypeCache::State::State(Requester& r, const TypeCacheLimits& l, DictionaryParser p)
    : requester{r}, limits{l}, parser{p}
{
    begin();
}

void TypeCache::State::begin()
{
    entries.clear();
    dictionaries.reset();
    dictionary_errors.clear();
    undescribed.clear();
    unknown_encodings.clear();
    traced_encodings.clear();
    for (binary::DataTypeEntry& entry : binary::namespace0_data_types()) {
        add(std::move(entry));
    }
    built_in = entries.size();
}

void TypeCache::State::check_revision()
{
    if (revision != requester.server().revision) {
        begin();
        revision = requester.server().revision; // last: repeated if something above throws
    }
}

void TypeCache::State::add(binary::DataTypeEntry entry)
{
    is_compiled = false;
    NodeId id = entry.id;
    entries.emplace(std::move(id), std::move(entry));
}

std::shared_ptr<const binary::DynamicTypes> TypeCache::State::compiled()
{
    if (!is_compiled) {
        std::vector<binary::DataTypeEntry> all;
        all.reserve(entries.size());
        for (const auto& [id, entry] : entries) {
            all.push_back(entry);
        }
        types = std::make_shared<const binary::DynamicTypes>(
            binary::DynamicTypes::compile(std::move(all), limits.definitions));
        is_compiled = true;
    }
    return types;
}

bool TypeCache::State::take_encoding(const NodeId& type, const ExtensionObject& value)
{
    const auto found = entries.find(type);
    if (found == entries.end() ||
        !std::holds_alternative<StructureDefinition>(found->second.definition)) {
        return false;
    }
    const NodeId before = std::exchange(found->second.encoding_id, value.encoding_id());
    is_compiled = false;
    if (binary::decode_dynamic(value, *compiled())) {
        return true;
    }
    found->second.encoding_id = before;
    is_compiled = false;
    return false;
}

namespace detail {

const ExtensionObject* first_structure(const Variant& value)
{
    const auto is_some = [](const ExtensionObject& object) {
        return !object.is_null() && object.body() != ExtensionObject::Body::Xml;
    };
    if (const auto* const object = value.get_if<ExtensionObject>()) {
        return is_some(*object) ? object : nullptr;
    }
    const auto* const objects = value.array_if<ExtensionObject>();
    if (objects == nullptr) {
        return nullptr;
    }
    const auto all = objects->span();
    const auto found = std::find_if(all.begin(), all.end(), is_some);
    return found != all.end() ? &*found : nullptr;
}

void EncodingSearch::look_at(const Variant& value)
{
    if (depth_ == max_depth) {
        return;
    }
    ++depth_;
    if (const auto* const object = value.get_if<ExtensionObject>()) {
        look_at(*object);
    } else if (const auto* const objects = value.array_if<ExtensionObject>()) {
        for (const ExtensionObject& element : *objects) {
            look_at(element);
        }
    } else if (const auto* const variants = value.array_if<Variant>()) {
        for (const Variant& element : *variants) {
            look_at(element);
        }
    } else if (const auto* const data = value.get_if<DataValue>()) {
        look_at(data->value);
    } else if (const auto* const list = value.array_if<DataValue>()) {
        for (const DataValue& element : *list) {
            look_at(element.value);
        }
    }
    --depth_;
}

void EncodingSearch::look_at(const ExtensionObject& object)
{
    if (object.is_null() || object.body() == ExtensionObject::Body::Xml || left_ == 0) {
        return;
    }
    --left_;
    if (types_.find_encoding(object.encoding_id()) == nullptr) {
        unknown_.insert(object.encoding_id());
    } else if (const auto value = binary::decode_dynamic(object, types_)) {
        look_at(*value);
    }
}

void EncodingSearch::look_at(const binary::DynamicValue& value)
{
    if (depth_ == max_depth) {
        return;
    }
    ++depth_;
    for (std::size_t i = 0; i < value.type().fields.size(); ++i) {
        if (const Variant* const simple = value.value(i)) {
            look_at(*simple);
        } else if (const auto* const part = value.structure(i)) {
            look_at(*part);
        } else if (const auto* const parts = value.structures(i)) {
            for (const binary::DynamicValue& element : parts->values) {
                look_at(element);
            }
        }
    }
    --depth_;
}

} // namespace detail

} // namespace busbar::client
