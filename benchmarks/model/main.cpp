// What the information model costs: start, memory, and the View services with ever more nodes.

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <busbar/model/nodeset.hpp>
#include <busbar/nodes/nodes.hpp>
#include <busbar/types/ids.hpp>
#include <model_bench/embedded/nodes.hpp>
#include <model_bench/micro/nodes.hpp>
#include <model_bench/standard/nodes.hpp>

#include "services.hpp"
#include "spaces.hpp"

using namespace busbar;
using namespace busbar::bench;

namespace {

constexpr std::uint32_t sizes[] = {25'000, 250'000, 1'000'000};
constexpr std::uint32_t wide_folder = 10'000;

void print_starts()
{
    const std::pair<const char*, const model::StaticNodes*> all[] = {
        {"micro", &model_bench::micro::nodes()},
        {"embedded", &model_bench::embedded::nodes()},
        {"standard", &model_bench::standard::nodes()},
        {"full", &model::namespace0_nodes()},
    };
    std::printf("%-12s %8s %10s %15s %11s\n", "namespace 0", "nodes", "start ns", "constant bytes",
                "bytes each");
    for (const auto& [name, nodes] : all) {
        const Start start = measure_start(*nodes);
        const std::size_t bytes = constant_bytes(*nodes);
        std::printf("%-12s %8zu %10.0f %15zu %11.1f\n", name, start.nodes, start.microseconds * 1e3,
                    bytes, static_cast<double>(bytes) / static_cast<double>(start.nodes));
    }
}

/// A folder with very many variables, for Browse.
NodeId add_wide_folder(model::AddressSpace& space)
{
    model::NewNode folder;
    folder.id = NodeId{1, "Wide"};
    folder.browse_name = QualifiedName{1, "Wide"};
    folder.parent = space.find(id::ObjectsFolder);
    const model::NodeIndex parent = space.add_folder(folder).value();
    model::NewVariable attributes;
    attributes.data_type = NodeId{0, id::Int32};
    for (std::uint32_t i = 0; i < wide_folder; ++i) {
        const std::string name = "Tag" + std::to_string(i);
        model::NewNode node;
        node.id = NodeId{1, String::borrow(name)};
        node.browse_name = QualifiedName{1, String::borrow(name)};
        node.parent = parent;
        static_cast<void>(space.add_variable(node, attributes).value());
    }
    return folder.id;
}

/// Nanoseconds to find a node by its id.
double find_cost(const model::AddressSpace& space, std::uint32_t variables)
{
    constexpr std::uint32_t count = 10'000;
    std::vector<NodeId> ids;
    for (std::uint32_t i = 0; i < count; ++i) {
        ids.push_back(machine_variable(
            static_cast<std::uint32_t>(std::uint64_t{i} * 7919 * 104'729 % variables)));
    }
    std::size_t missing = 0;
    const auto begin = Clock::now();
    for (const NodeId& id : ids) {
        missing += space.find(id) == model::no_node ? 1U : 0U;
    }
    const double nanoseconds = elapsed_us(begin) * 1e3 / count;
    if (missing != 0) {
        std::fprintf(stderr, "%zu nodes were not found\n", missing);
        std::exit(1);
    }
    return nanoseconds;
}

/// Nanoseconds to tell whether one type is a subtype of another, over all pairs of some.
double subtype_cost(const model::AddressSpace& space)
{
    std::vector<model::NodeIndex> types;
    space.for_each([&](model::NodeIndex node) {
        if (space.node_class(node) == NodeClass::DataType) {
            types.push_back(node);
        }
    });
    std::size_t pairs = 0;
    const auto begin = Clock::now();
    for (const model::NodeIndex type : types) {
        for (const model::NodeIndex other : types) {
            pairs += space.is_subtype_of(type, other) ? 1U : 0U;
        }
    }
    const double nanoseconds =
        elapsed_us(begin) * 1e3 / static_cast<double>(types.size() * types.size());
    std::printf("subtype test: %.1f ns, %zu DataTypes, %zu pairs\n", nanoseconds, types.size(),
                pairs);
    return nanoseconds;
}

void print_growth()
{
    std::printf("\n%10s %10s %10s %12s %9s %11s %11s %11s\n", "variables", "build ms", "bytes each",
                "growth/node", "find ns", "browse us", "pages us", "paths us");
    double first = 0;
    for (const std::uint32_t variables : sizes) {
        const std::size_t heap = heap_in_use();
        const auto begin = Clock::now();
        model::AddressSpace space;
        add_machine(space, variables);
        const double build_us = elapsed_us(begin);
        const auto bytes = static_cast<double>(heap_in_use() - heap) / variables;
        const double each = build_us / variables;
        first = first == 0 ? each : first;
        const NodeId wide = add_wide_folder(space);
        Services services{std::move(space)};
        const double find_ns = find_cost(services.space(), variables);
        const NodeId hierarchical{0, id::HierarchicalReferences};
        const auto browsed = services.browse(wide, hierarchical);
        const auto paged = services.browse_pages(wide, hierarchical, 1'000);
        const auto paths = services.translate(1'000, variables);
        if (browsed.results != wide_folder || paged.results != wide_folder ||
            paths.results != 1'000) {
            std::fprintf(stderr, "a service left something out\n");
            std::exit(1);
        }
        std::printf("%10u %10.1f %10.1f %12.2f %9.1f %11.1f %11.1f %11.1f\n", variables,
                    build_us / 1e3, bytes, each / first, find_ns, browsed.microseconds,
                    paged.microseconds, paths.microseconds);
    }
    std::printf(
        "browse: %u references in one response; pages: 1,000 at a time; paths: 1,000 browse "
        "paths of 3 elements\n",
        wide_folder);
}

/// Loads NodeSet2 files together.
void print_load(const std::vector<std::string>& files)
{
    std::vector<model::NodeSetSource> sources;
    for (const std::string& file : files) {
        sources.push_back({file});
    }
    const std::size_t heap = heap_in_use();
    model::AddressSpace space;
    const auto begin = Clock::now();
    auto loaded = model::load_nodesets(space, sources);
    const double load_us = elapsed_us(begin);
    if (!loaded) {
        std::fprintf(stderr, "%s\n", loaded.error().front().text().c_str());
        std::exit(1);
    }
    const std::size_t count = loaded->node_count;
    loaded->extras = {}; // what only writing the files back needs
    const auto held = static_cast<double>(heap_in_use() - heap);
    std::printf("\n%zu files: %zu nodes loaded in %.1f ms, %.1f us and %.1f bytes each\n",
                files.size(), count, load_us / 1e3, load_us / static_cast<double>(count),
                held / static_cast<double>(count));
}

} // namespace

/// busbar-model-bench [NodeSet2 files, which are loaded together]
int main(int argc, char** argv)
{
    print_starts();
    print_growth();
    static_cast<void>(subtype_cost(model::AddressSpace{}));
    if (argc > 1) {
        print_load({argv + 1, argv + argc});
    }
    return 0;
}
