#include "spaces.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>

#include <malloc.h>

#include <busbar/types/ids.hpp>

namespace busbar::bench {

namespace {

/// "Line" and 7 are "Line007".
std::string numbered(const char* name, std::uint32_t number)
{
    char digits[16];
    std::snprintf(digits, sizeof digits, "%03u", number);
    return std::string{name} + digits;
}

std::string cell_name(std::uint32_t cell)
{
    return numbered("Line", cell / cells_per_line) + numbered(".Cell", cell % cells_per_line);
}

model::NodeIndex add_object(model::AddressSpace& space, model::NodeIndex parent,
                            const std::string& id, const std::string& name)
{
    model::NewNode node;
    node.id = NodeId{1, String::borrow(id)};
    node.browse_name = QualifiedName{1, String::borrow(name)};
    node.parent = parent;
    return space.add_object(node).value();
}

} // namespace

std::size_t heap_in_use()
{
    const auto info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
}

NodeId machine_variable(std::uint32_t number)
{
    return NodeId{1, String{cell_name(number / values_per_cell) +
                            numbered(".Value", number % values_per_cell)}};
}

void add_machine(model::AddressSpace& space, std::uint32_t variables)
{
    static_cast<void>(space.add_namespace("urn:busbar:bench").value());
    const model::NodeIndex objects = space.find(id::ObjectsFolder);
    model::NodeIndex line = model::no_node;
    model::NodeIndex cell = model::no_node;
    model::NewVariable attributes;
    attributes.data_type = NodeId{0, id::Int32};
    attributes.access_level = model::Access::ReadWrite;
    attributes.source = 0;
    for (std::uint32_t i = 0; i < variables; ++i) {
        const std::uint32_t cell_number = i / values_per_cell;
        if (i % (values_per_cell * cells_per_line) == 0) {
            const std::string name = numbered("Line", cell_number / cells_per_line);
            line = add_object(space, objects, name, name);
        }
        if (i % values_per_cell == 0) {
            cell = add_object(space, line, cell_name(cell_number),
                              numbered("Cell", cell_number % cells_per_line));
        }
        const std::string name = numbered("Value", i % values_per_cell);
        const std::string id = cell_name(cell_number) + '.' + name;
        model::NewNode node;
        node.id = NodeId{1, String::borrow(id)};
        node.browse_name = QualifiedName{1, String::borrow(name)};
        node.parent = cell;
        attributes.handle = i;
        static_cast<void>(space.add_variable(node, attributes).value());
    }
}

Start measure_start(const model::StaticNodes& nodes)
{
    constexpr int rounds = 20;
    Start result;
    result.microseconds = std::numeric_limits<double>::max();
    for (int i = 0; i < rounds; ++i) {
        const auto begin = Clock::now();
        const model::AddressSpace space{nodes};
        result.microseconds = std::min(result.microseconds, elapsed_us(begin));
        result.nodes = space.node_count();
    }
    return result;
}

std::size_t constant_bytes(const model::StaticNodes& nodes)
{
    return nodes.namespaces.size_bytes() + nodes.nodes.size_bytes() + nodes.types.size_bytes() +
           nodes.variables.size_bytes() + nodes.references.size_bytes() +
           nodes.reference_types.size_bytes() + nodes.externals.size_bytes() +
           nodes.texts.size_bytes() + nodes.extras.size_bytes() + nodes.dimensions.size_bytes() +
           nodes.text.size() + nodes.values.size() + nodes.slots.size_bytes();
}

} // namespace busbar::bench
