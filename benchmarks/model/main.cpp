// What the information model costs: start, memory, and the View services with ever more nodes.

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/nodes/nodes.hpp>
#include <busbar/types/ids.hpp>
#include <model_bench/embedded/nodes.hpp>
#include <model_bench/micro/nodes.hpp>
#include <model_bench/standard/nodes.hpp>

#include "command_line/program_options.hpp"
#include "figures.hpp"
#include "loads.hpp"
#include "project.hpp"
#include "services.hpp"
#include "spaces.hpp"

using namespace busbar;
using namespace busbar::bench;

namespace {

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

/// A folder with very many nodes for Browse. Of four, two are variables that are components and
/// properties, two are objects that are components and organized.
NodeId add_wide_folder(model::AddressSpace& space)
{
    model::NewNode folder;
    folder.id = NodeId{1, "Wide"};
    folder.browse_name = QualifiedName{1, "Wide"};
    folder.parent = space.find(id::ObjectsFolder);
    const model::NodeIndex parent = space.add_folder(folder).value();
    model::NewVariable attributes;
    attributes.data_type = NodeId{0, id::Int32};
    constexpr std::uint32_t types[] = {id::HasComponent, id::HasProperty, id::HasComponent,
                                       id::Organizes};
    for (std::uint32_t i = 0; i < wide_folder; ++i) {
        const std::string name = "Tag" + std::to_string(i);
        model::NewNode node;
        node.id = NodeId{1, String::borrow(name)};
        node.browse_name = QualifiedName{1, String::borrow(name)};
        node.parent = parent;
        node.reference_type = NodeId{0, types[i % 4]};
        if (i % 4 == 1) {
            static_cast<void>(space.add_property(node, attributes).value());
        } else if (i % 4 == 0) {
            static_cast<void>(space.add_variable(node, attributes).value());
        } else {
            static_cast<void>(space.add_object(node).value());
        }
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

void expect(std::size_t found, std::size_t wanted)
{
    if (found != wanted) {
        std::fprintf(stderr, "a service found %zu of %zu\n", found, wanted);
        std::exit(1);
    }
}

/// The View services of a server with `space`.
void add_services(GrowthTable& table, model::AddressSpace space, std::uint32_t variables)
{
    const NodeId wide = add_wide_folder(space);
    Services services{std::move(space)};
    table.add("find a node, ns", find_cost(services.space(), variables));
    Services::Wish wish;
    wish.node = wide;
    const auto browsed = services.browse(wish);
    expect(browsed.results, wide_folder);
    table.add("Browse 10,000 references, us", browsed.microseconds);
    wish.page = 1'000;
    const auto paged = services.browse(wish);
    expect(paged.results, wide_folder);
    table.add("the same, 1,000 at a time, us", paged.microseconds);
    wish.page = 0;
    wish.type = NodeId{0, id::Aggregates};
    wish.node_class_mask = static_cast<std::uint32_t>(NodeClass::Variable);
    const auto filtered = services.browse(wish);
    expect(filtered.results, wide_folder / 2);
    table.add("only Variables by Aggregates, us", filtered.microseconds);
    wish.type = NodeId{0, id::HasComponent};
    wish.include_subtypes = false;
    wish.node_class_mask = 0;
    const auto exact = services.browse(wish);
    expect(exact.results, wide_folder / 2);
    table.add("only by HasComponent itself, us", exact.microseconds);
    const auto paths = services.translate(1'000, variables);
    expect(paths.results, 1'000);
    table.add("translate 1,000 paths of 3, us", paths.microseconds);
}

void print_growth(const std::vector<std::uint32_t>& sizes)
{
    GrowthTable table;
    for (const std::uint32_t variables : sizes) {
        const std::size_t heap = heap_in_use();
        const auto begin = Clock::now();
        model::AddressSpace space;
        add_machine(space, variables);
        table.begin_size(variables);
        table.add("build, ns a variable", elapsed_us(begin) * 1e3 / variables);
        table.add("held, bytes a variable", static_cast<double>(heap_in_use() - heap) / variables);
        add_services(table, std::move(space), variables);
    }
    table.print("variables");
}

/// What the information model costs, and files of the user's.
void print_models(const std::vector<std::string>& files, const std::vector<std::uint32_t>& sizes)
{
    std::printf("growth: a figure over that of the size before. For one of a node or variable 1.00 "
                "is linear,\nthe ratio of the sizes quadratic.\n\n");
    print_starts();
    print_growth(sizes);
    print_load_growth(sizes);
    std::printf("\n");
    static_cast<void>(subtype_cost(model::AddressSpace{}));
    static_cast<void>(std::fflush(stdout));
    if (!files.empty()) {
        print_load(files);
    }
}

int print_projects(const ProjectOptions& options, bool json)
{
    const auto points = measure_projects(options);
    if (!points) {
        std::fprintf(stderr, "busbar-model-bench: project: %s\n", text(points.error()).c_str());
        return 1;
    }
    print(*points, json);
    return 0;
}

} // namespace

/// Of PackML the files are Opc.Ua.PackML.NodeSet2.xml, Opc.Ua.Di.NodeSet2.xml, and
/// Opc.Ua.NodeSet2.xml for the type dictionaries that both refer to.
int main(int argc, char** argv)
{
    std::vector<std::string> files;
    std::vector<std::uint32_t> sizes{25'000, 250'000, 1'000'000};
    ProjectOptions options;
    bool json = false;
    CLI::App app{"Measures the information model: start, memory, and the View services with ever "
                 "more nodes."};
    app.add_option("files", files, "NodeSet2 files, which are loaded together");
    app.add_option("--variables", sizes, "of the models that grow, ascending")
        ->delimiter(',')
        ->check(CLI::Range(1'000, 10'000'000))
        ->capture_default_str();
    CLI::App* const project = app.add_subcommand(
        "project", "What a project of model mode costs for each node: import, check, export, write "
                   "and verify, with the limits of RD81OPC96 and ten times as large without.");
    project->add_option("--objects", options.limited.objects, "of 100 mapped Variables each")
        ->check(CLI::Range(1, 250))
        ->capture_default_str();
    project->add_flag("--json", json, "print JSON");
    command_line::add_program_options(app, "busbar-model-bench");
    CLI11_PARSE(app, argc, argv);
    if (project->parsed()) {
        options.open.objects = 10 * options.limited.objects;
        return print_projects(options, json);
    }
    print_models(files, sizes);
    return 0;
}
