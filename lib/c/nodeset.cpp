#include "server.hpp"

#ifdef BUSBAR_C_HAS_PUGIXML
#include <busbar/model/nodeset.hpp>
#endif

using namespace busbar;

busbar_status busbar_server_add_nodeset(busbar_server* server, const char* name, const char* xml,
                                        size_t size)
{
    return c::change(server, [&]() -> StatusCode {
        if (name == nullptr || xml == nullptr) {
            return status::Bad_InvalidArgument;
        }
#ifdef BUSBAR_C_HAS_PUGIXML
        model::NodeSetSource source;
        source.name = name;
        source.text.emplace(xml, size);
        const auto loaded = model::load_nodesets(server->server->address_space(), {&source, 1});
        return loaded ? status::Good : c::failed(server->failure, loaded.error().front());
#else
        static_cast<void>(size);
        return status::Bad_ServiceUnsupported;
#endif
    });
}
