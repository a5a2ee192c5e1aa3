#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <busbar/controller/mapping_extensions.hpp>
#include <busbar/controller/mapping_table.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/ids.hpp>

namespace mapping_fuzz {

using namespace busbar;
using namespace busbar::controller;

namespace {

void require(bool is_so)
{
    if (!is_so) {
        std::abort();
    }
}

const NodeId variable_id{1, "V"};
const NodeId method_id{1, "M"};

/// A Variable and a Method.
const model::AddressSpace& world()
{
    static const model::AddressSpace space = [] {
        model::AddressSpace made;
        require(made.add_namespace("urn:t").has_value());
        const auto objects = made.find(id::ObjectsFolder);
        const auto node = [&](const NodeId& id, const char* name) {
            model::NewNode result;
            result.id = id;
            result.browse_name = {1, name};
            result.parent = objects;
            return result;
        };
        require(made.add_variable(node(variable_id, "V"), {}).has_value());
        require(made.add_method(node(method_id, "M")).has_value());
        return made;
    }();
    return space;
}

Mapping without_signs(Mapping mapping)
{
    for (auto& each : mapping.variables) {
        each.second.sign.clear();
    }
    for (auto& each : mapping.methods) {
        each.second.sign.clear();
    }
    drop_unmapped(mapping);
    return mapping;
}

model::NodeSetExtras extras_of(std::string_view elements)
{
    model::NodeSetExtras extras;
    extras.nodes[variable_id].elements = elements;
    extras.nodes[method_id].elements = elements;
    return extras;
}

/// What was read is written so that it is read as the same, with Signs that fit.
void read_extensions(std::string_view text)
{
    model::NodeSetExtras extras = extras_of(text);
    const ReadMapping first = read_mapping(world(), extras, "fuzz.xml");
    const Mapping expected = without_signs(first.mapping);
    const std::uint16_t own[] = {1};
    model::NodeSetExtras written;
    write_mapping(first.mapping, own, written);
    const ReadMapping again = read_mapping(world(), written);
    require(again.reports.is_empty());
    require(without_signs(again.mapping) == expected);
    // In place of what was there, beside extensions of others.
    write_mapping(first.mapping, own, extras);
    static_cast<void>(read_mapping(world(), extras));
}

void read_table(std::string_view text)
{
    MappingTableLimits limits;
    limits.max_elements = 1'000;
    const ReadMappingTable first = read_mapping_table(text, world(), limits);
    const Mapping expected = without_signs(first.mapping);
    const std::string written = write_mapping_table(world(), expected);
    const ReadMappingTable again = read_mapping_table(written, world(), limits);
    require(again.reports.is_empty());
    require(without_signs(again.mapping) == expected);
}

} // namespace

/// A text as the <Extensions> of nodes if it begins with a bracket, else as a table.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    if (text.starts_with('<')) {
        read_extensions(text);
    } else {
        read_table(text);
    }
    return 0;
}

} // namespace mapping_fuzz
