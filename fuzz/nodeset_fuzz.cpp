#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <busbar/model/nodeset.hpp>
#include <model/space_hash.hpp>

#include "target.hpp"

namespace nodeset_fuzz {

using namespace busbar;

namespace {

model::NodeSetLimits limits()
{
    model::NodeSetLimits small;
    small.max_nodes = 200;
    small.max_references = 2'000;
    small.max_value_elements = 5'000;
    small.max_kept_xml = 100'000;
    return small;
}

model::NodeSetSource source(const std::uint8_t* data, std::size_t size)
{
    return {"fuzz.xml", std::string{reinterpret_cast<const char*>(data), size}};
}

/// To look at all nodes takes longer than all else: among the many inputs of libFuzzer some are
/// looked at so closely, and one that is tried by itself always is.
bool is_looked_at()
{
    static unsigned inputs = 0;
    return !fuzz::is_searching() || inputs++ % 64 == 0;
}

} // namespace

/// Any text as a NodeSet2 file: a file that is refused changes nothing, one that is loaded can be
/// written, and what was written loads as the same nodes.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    model::AddressSpace space;
    static const std::uint64_t untouched = model::detail::space_hash(space);
    static const std::size_t node_count = space.node_count();
    const auto loaded = model::load_nodesets(space, std::array{source(data, size)}, limits());
    if (!loaded) {
        if (loaded.error().empty() || space.namespace_count() != 1 ||
            space.node_count() != node_count ||
            (is_looked_at() && model::detail::space_hash(space) != untouched)) {
            std::abort();
        }
        return 0;
    }
    const auto text = model::write_nodeset(space, loaded->namespaces, loaded->extras);
    if (!text) {
        std::abort();
    }
    model::AddressSpace again;
    for (std::uint16_t i = 1; i < space.namespace_count(); ++i) {
        static_cast<void>(again.add_namespace(space.namespace_uri(i)));
    }
    if (!model::load_nodesets(again, std::array{model::NodeSetSource{"again.xml", *text}})) {
        std::abort();
    }
    for (const std::uint16_t index : loaded->namespaces) {
        if (model::detail::space_hash(again, index) != model::detail::space_hash(space, index)) {
            std::abort();
        }
    }
    return 0;
}

} // namespace nodeset_fuzz
