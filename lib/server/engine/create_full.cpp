#include <busbar/server/server.hpp>

namespace busbar::server {

// In a file of its own: who names a table has no other linked.
Configured<Server> Server::create(ServerConfig config, const ServerEnvironment& environment,
                                  model::AddressSpace address_space)
{
    return create(full_modules(), std::move(config), environment, std::move(address_space));
}

} // namespace busbar::server
