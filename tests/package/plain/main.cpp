#include <cstdio>

#include <busbar/binary/codec.hpp>
#include <busbar/core/log.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace {

struct Noon final : busbar::WallClock {
    [[nodiscard]] busbar::DateTime now() const override { return busbar::DateTime{1}; }
};

} // namespace

/// A build without CMake: classes, virtual functions and constant data come from the libraries.
int main()
{
    const Noon noon;
    busbar::server::MemorySource source{noon};
    const busbar::model::AddressSpace space;
    const auto object = busbar::ExtensionObject::from(busbar::Range{0.0, 1.0});
    const bool is_right = source.add(busbar::Variant{1.5}) == 0 && object.get_if<busbar::Range>() &&
                          space.find(busbar::id::Server) != busbar::model::no_node;
    std::puts(is_right ? "busbar works" : "busbar does not work");
    return is_right ? 0 : 1;
}
