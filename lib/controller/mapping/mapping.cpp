#include <busbar/controller/mapping.hpp>

#include <algorithm>

#include "controller/conversion/shape_node.hpp"

namespace busbar::controller {

namespace {

bool is_before(const MappedPart& a, const MappedPart& b)
{
    return a.number < b.number;
}

/// Tells whether the part or its elements have fields.
bool has_fields(const MappedPart& part)
{
    return std::any_of(part.parts.begin(), part.parts.end(), [](const MappedPart& inner) {
        return inner.kind == MappedPart::Kind::Field ||
               (inner.kind == MappedPart::Kind::Element && has_fields(inner));
    });
}

void drop_from(std::vector<MappedPart>& parts)
{
    for (MappedPart& part : parts) {
        drop_unmapped(part);
    }
    parts.erase(std::remove_if(parts.begin(), parts.end(),
                               [](const MappedPart& part) {
                                   return part.label.empty() && part.parts.empty();
                               }),
                parts.end());
    // Fields have no number and keep their order.
    std::stable_sort(parts.begin(), parts.end(), is_before);
}

} // namespace

std::size_t count_labels(const MappedPart& part)
{
    std::size_t count = part.label.empty() ? 0 : 1;
    for (const MappedPart& inner : part.parts) {
        count += count_labels(inner);
    }
    return count;
}

std::size_t count_labels(const DataMapping& variable)
{
    return count_labels(variable.value) + (variable.quality.empty() ? 0 : 1);
}

std::size_t count_labels(const MethodMapping& method)
{
    std::size_t count = (method.handle.empty() ? 0U : 1U) + (method.done.empty() ? 0U : 1U);
    for (const MappedPart& output : method.outputs) {
        count += count_labels(output);
    }
    for (const MappedPart& argument : method.arguments) {
        count += count_labels(argument);
    }
    return count;
}

std::vector<NodeId> mapped_nodes(const Mapping& mapping)
{
    std::vector<NodeId> nodes;
    nodes.reserve(mapping.variables.size() + mapping.methods.size());
    for (const auto& each : mapping.variables) {
        nodes.push_back(each.first);
    }
    for (const auto& each : mapping.methods) {
        nodes.push_back(each.first);
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

std::size_t count_labels(const Mapping& mapping)
{
    std::size_t count = 0;
    for (const auto& [id, variable] : mapping.variables) {
        count += count_labels(variable);
    }
    for (const auto& [id, method] : mapping.methods) {
        count += count_labels(method);
    }
    return count;
}

void drop_unmapped(MappedPart& part)
{
    const bool had_parts = !part.parts.empty();
    drop_from(part.parts);
    if (part.label.empty() && part.parts.empty()) {
        part.specification = {};
    } else if (!had_parts) {
        return;
    }
    // Derive the kind from the parts; elements belong to the array around them.
    if (part.kind != MappedPart::Kind::Element) {
        const bool has_elements =
            !part.parts.empty() && part.parts.front().kind == MappedPart::Kind::Element;
        part.is_array = has_elements || part.specification.rank > 0;
        part.is_structure = has_fields(part);
    }
}

void drop_unmapped(Mapping& mapping)
{
    for (auto each = mapping.variables.begin(); each != mapping.variables.end();) {
        drop_unmapped(each->second.value);
        each =
            count_labels(each->second.value) == 0 ? mapping.variables.erase(each) : std::next(each);
    }
    for (auto each = mapping.methods.begin(); each != mapping.methods.end();) {
        drop_from(each->second.arguments);
        drop_from(each->second.outputs);
        each = count_labels(each->second) == 0 ? mapping.methods.erase(each) : std::next(each);
    }
}

std::string part_path(std::string_view parent, const MappedPart& part)
{
    std::string path{parent};
    if (part.kind == MappedPart::Kind::Element) {
        path += '[' + std::to_string(part.number) + ']';
    } else if (part.kind == MappedPart::Kind::Field) {
        path += detail::field_step(part.name);
    }
    return path;
}

} // namespace busbar::controller
