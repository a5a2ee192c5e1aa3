#include "type_compiler.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>

#include "core/visit_built_in.hpp"

namespace busbar::binary::detail {

using Kind = DynamicType::Kind;

namespace {

std::size_t element_size(const DynamicField& field)
{
    if (field.is_structure) {
        return field.type->min_wire_size;
    }
    return busbar::detail::visit_built_in(field.built_in, [](auto tag) {
        return busbar::detail::min_wire_size<typename decltype(tag)::type>();
    });
}

constexpr std::size_t count_size = 4;

} // namespace

/// Leaves out all types that need a type which is left out.
void TypeCompiler::refuse_users_of_wrong_types()
{
    std::vector<std::vector<std::size_t>> users(entries_.size());
    std::vector<std::size_t> wrong;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        for (const DynamicField& field : entries_[i].type->fields) {
            if (needs_type(field)) {
                users[index_of(field.data_type)].push_back(i);
            }
        }
        if (entries_[i].is_wrong) {
            wrong.push_back(i);
        }
    }
    while (!wrong.empty()) {
        const std::size_t at = wrong.back();
        wrong.pop_back();
        for (const std::size_t user : users[at]) {
            if (!entries_[user].is_wrong) {
                refuse(entries_[user], status::Bad_DataTypeIdUnknown, "",
                       "it needs " + entries_[at].type->name + ", which cannot be used");
                wrong.push_back(user);
            }
        }
    }
}

/// Measures each type after those that are directly within it. The remaining ones are part of a
/// cycle, which would make a value infinite, or need such a type.
void TypeCompiler::measure_all()
{
    std::vector<std::vector<std::size_t>> users(entries_.size());
    std::vector<std::size_t> waits_for(entries_.size());
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const DynamicType& type = *entries_[i].type;
        for (const DynamicField& field : type.fields) {
            if (is_directly_within(type, field)) {
                users[index_of(field.data_type)].push_back(i);
                ++waits_for[i];
            }
        }
        if (waits_for[i] == 0) {
            ready.push_back(i);
        }
    }
    while (!ready.empty()) {
        const std::size_t at = ready.back();
        ready.pop_back();
        measure(entries_[at]);
        for (const std::size_t user : users[at]) {
            if (--waits_for[user] == 0) {
                ready.push_back(user);
            }
        }
    }
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        if (waits_for[i] != 0) {
            refuse_cycle(entries_[i]);
        }
    }
}

/// Sums stop growing past the limits, so that they cannot overflow.
void TypeCompiler::measure(Entry& entry)
{
    DynamicType& type = *entry.type;
    const bool has_prefix = type.kind == Kind::Union || type.has_optional_fields;
    type.min_wire_size = has_prefix ? count_size : 0;
    entry.nested_fields = type.fields.size();
    entry.is_measured = true;
    for (const DynamicField& field : type.fields) {
        if (type.kind == Kind::Union || field.is_optional) {
            continue;
        }
        type.min_wire_size += field.is_scalar() ? element_size(field) : count_size;
        if (is_directly_within(type, field)) {
            const Entry& part = entries_[index_of(field.data_type)];
            entry.nested_fields += part.nested_fields;
            entry.depth = std::max(entry.depth, part.depth + 1);
        }
    }
    const bool is_large = entry.nested_fields > limits_.max_nested_fields;
    if (is_large || entry.depth >= limits_.max_depth) {
        entry.nested_fields = limits_.max_nested_fields;
        type.min_wire_size = 0;
        refuse(entry, status::Bad_EncodingLimitsExceeded, "",
               is_large ? "it has too many fields within its fields" : "it is nested too deep");
    }
}

void TypeCompiler::refuse_cycle(Entry& entry)
{
    const DynamicType& type = *entry.type;
    for (const DynamicField& field : type.fields) {
        if (is_directly_within(type, field) && !entries_[index_of(field.data_type)].is_measured) {
            return refuse(entry, status::Bad_NodeAttributesInvalid, field.name,
                          "each value would contain another without end");
        }
    }
}

} // namespace busbar::binary::detail
