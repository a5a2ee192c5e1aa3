#include <cstdio>

#include <busbar/binary/codec.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/attribute.hpp>

/// A value goes out and comes back, and the server's address space is there.
int main()
{
    busbar::ReadValueId item;
    item.node_id = busbar::NodeId{2, "Motor"};
    const auto bytes = busbar::binary::to_bytes(item);
    const auto again = busbar::binary::from_bytes<busbar::ReadValueId>(*bytes);
    const busbar::model::AddressSpace space;
    const bool is_right = again && *again == item && space.find(2253) != busbar::model::no_node;
    std::puts(is_right ? "busbar works" : "busbar does not work");
    return is_right ? 0 : 1;
}
