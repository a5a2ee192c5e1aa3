#include <cstdio>

#include <acme/types.hpp>
#include <busbar/binary/codec.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/attribute.hpp>

/// Values go out and come back, a vendor's too, and the server's address space is there.
int main()
{
    busbar::ReadValueId item;
    item.node_id = busbar::NodeId{2, "Motor"};
    const auto bytes = busbar::binary::to_bytes(item);
    const auto again = busbar::binary::from_bytes<busbar::ReadValueId>(*bytes);
    const busbar::model::AddressSpace space;
    const acme::OptStruct own{.mandatory_int32 = 42};
    const auto own_bytes = busbar::binary::to_bytes(own);
    const auto own_again = busbar::binary::from_bytes<acme::OptStruct>(*own_bytes);
    const bool is_right = again && *again == item && own_again && *own_again == own &&
                          space.find(2253) != busbar::model::no_node;
    std::puts(is_right ? "busbar works" : "busbar does not work");
    return is_right ? 0 : 1;
}
