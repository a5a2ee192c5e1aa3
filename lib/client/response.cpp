#include <busbar/client/response.hpp>

#include <busbar/types/registry.hpp>

namespace busbar::client {

const binary::TypeRegistry& standard_types()
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    return types;
}

} // namespace busbar::client
