#include "view_services.hpp"

#include "core.hpp"
#include "session_rights.hpp"
#include "view_context.hpp"

namespace busbar::server::detail {

namespace {

ViewContext view_context(const ServiceContext& context)
{
    const Core& core = context.core;
    return {core.address_space, rights_of(context), core.limits(), *core.environment.random,
            *context.session};
}

} // namespace

StatusCode browse(ServiceContext& context, const BrowseRequest& request, BrowseResponse& response)
{
    ViewContext view = view_context(context);
    return browse(view, request, response);
}

StatusCode browse_next(ServiceContext& context, const BrowseNextRequest& request,
                       BrowseNextResponse& response)
{
    ViewContext view = view_context(context);
    return browse_next(view, request, response);
}

StatusCode translate_browse_paths(ServiceContext& context,
                                  const TranslateBrowsePathsToNodeIdsRequest& request,
                                  TranslateBrowsePathsToNodeIdsResponse& response)
{
    ViewContext view = view_context(context);
    return translate_browse_paths(view, request, response);
}

StatusCode register_nodes(ServiceContext& context, const RegisterNodesRequest& request,
                          RegisterNodesResponse& response)
{
    ViewContext view = view_context(context);
    return register_nodes(view, request, response);
}

StatusCode unregister_nodes(ServiceContext& context, const UnregisterNodesRequest& request,
                            UnregisterNodesResponse&)
{
    ViewContext view = view_context(context);
    return unregister_nodes(view, request);
}

} // namespace busbar::server::detail
