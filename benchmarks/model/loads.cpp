#include "loads.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include <unistd.h>

#include <busbar/model/nodeset.hpp>

#include "figures.hpp"
#include "spaces.hpp"

namespace busbar::bench {

namespace {

/// Gone with this object.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& text)
        : path_{std::filesystem::temp_directory_path() /
                ("busbar-model-bench-" + std::to_string(::getpid()) + ".xml")}
    {
        std::ofstream{path_, std::ios::binary} << text;
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile()
    {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    [[nodiscard]] std::string path() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

struct Load {
    double microseconds{0};
    double heap_bytes{0};
    std::size_t nodes{0};
};

Load load(const std::vector<std::string>& files)
{
    std::vector<model::NodeSetSource> sources;
    for (const std::string& file : files) {
        sources.push_back({file});
    }
    const std::size_t heap = heap_in_use();
    model::AddressSpace space;
    const auto begin = Clock::now();
    auto loaded = model::load_nodesets(space, sources, model::limits_for_large_models());
    const double load_us = elapsed_us(begin);
    if (!loaded) {
        std::fprintf(stderr, "%s\n", text(loaded.error().front()).c_str());
        std::exit(1);
    }
    const std::size_t count = loaded->node_count;
    loaded->extras = {}; // what only writing the files back needs
    return {load_us, static_cast<double>(heap_in_use() - heap), count};
}

std::string machine_text(std::uint32_t variables, double& write_us)
{
    model::AddressSpace space;
    add_machine(space, variables);
    const std::uint16_t namespaces[] = {1};
    const auto begin = Clock::now();
    auto text = model::write_nodeset(space, namespaces);
    write_us = elapsed_us(begin);
    if (!text) {
        std::fprintf(stderr, "the model cannot be written\n");
        std::exit(1);
    }
    return *std::move(text);
}

void add_size(GrowthTable& table, std::uint32_t variables)
{
    double write_us = 0;
    std::string text = machine_text(variables, write_us);
    const auto bytes = static_cast<double>(text.size());
    const TemporaryFile file{text};
    text = {};
    text.shrink_to_fit();
    forget_peak();
    const double before = peak_megabytes();
    const Load result = load({file.path()});
    const auto nodes = static_cast<double>(result.nodes);
    table.begin_size(variables);
    table.add("file, bytes a node", bytes / nodes);
    table.add("write, ns a node", write_us * 1e3 / nodes);
    table.add("load, ns a node", result.microseconds * 1e3 / nodes);
    table.add("held, bytes a node", result.heap_bytes / nodes);
    table.add("most while loading, bytes a node",
              (peak_megabytes() - before) * 1'024 * 1'024 / nodes);
}

} // namespace

void print_load(const std::vector<std::string>& files)
{
    constexpr int rounds = 5;
    Load best;
    best.microseconds = std::numeric_limits<double>::max();
    for (int i = 0; i < rounds; ++i) {
        const Load each = load(files);
        best.microseconds = std::min(best.microseconds, each.microseconds);
        best.heap_bytes = each.heap_bytes;
        best.nodes = each.nodes;
    }
    std::printf("\n");
    for (const std::string& file : files) {
        std::printf("%s\n", std::filesystem::path{file}.filename().c_str());
    }
    const auto nodes = static_cast<double>(best.nodes);
    std::printf("%zu nodes loaded in %.1f ms, %.1f us and %.1f bytes each\n", best.nodes,
                best.microseconds / 1e3, best.microseconds / nodes, best.heap_bytes / nodes);
}

void print_load_growth(std::span<const std::uint32_t> sizes)
{
    GrowthTable table;
    for (const std::uint32_t variables : sizes) {
        add_size(table, variables);
    }
    table.print("NodeSet2 file of variables");
}

} // namespace busbar::bench
