#include <busbar/server/server.hpp>

namespace busbar::server {

// In a separate file: a program that names a table links no other.
Configured<Server> Server::create(ServerConfig config, const ServerEnvironment& environment,
                                  model::AddressSpace address_space)
{
    return create(full_modules(), std::move(config), environment, std::move(address_space));
}

} // namespace busbar::server
