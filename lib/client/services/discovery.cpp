#include <busbar/client/discovery.hpp>
#include <busbar/core/detail/guarded.hpp>

namespace busbar::client {

namespace {

template <typename T>
Result<std::vector<T>> moved_out(Array<T>& from)
{
    Result<std::vector<T>> to = fail(status::Bad_OutOfMemory);
    busbar::detail::attempt([&] {
        to = std::vector<T>{std::make_move_iterator(from.begin()),
                            std::make_move_iterator(from.end())};
    });
    return to;
}

} // namespace

RequestId find_servers(Requester& requester, std::string_view url,
                       Requester::Handler<std::vector<ApplicationDescription>> done,
                       const std::vector<std::string>& server_uris, RequestOptions options)
{
    FindServersRequest request;
    request.endpoint_url = String{url};
    for (const std::string& uri : server_uris) {
        request.server_uris.push_back(String{uri});
    }
    return requester.call<FindServersResponse>(
        std::move(request),
        [done = std::move(done)](Result<FindServersResponse> response) {
            if (response) {
                done(moved_out(response->servers));
            } else {
                done(fail(response.error()));
            }
        },
        options);
}

RequestId find_servers_on_network(Requester& requester,
                                  Requester::Handler<FindServersOnNetworkResponse> done,
                                  const std::vector<std::string>& capabilities, std::uint32_t after,
                                  std::uint32_t most, RequestOptions options)
{
    FindServersOnNetworkRequest request;
    request.starting_record_id = after;
    request.max_records_to_return = most;
    for (const std::string& capability : capabilities) {
        request.server_capability_filter.push_back(String{capability});
    }
    return requester.call<FindServersOnNetworkResponse>(std::move(request), std::move(done),
                                                        options);
}

RequestId get_endpoints(Requester& requester, std::string_view url,
                        Requester::Handler<std::vector<EndpointDescription>> done,
                        RequestOptions options)
{
    GetEndpointsRequest request;
    request.endpoint_url = String{url};
    return requester.call<GetEndpointsResponse>(
        std::move(request),
        [done = std::move(done)](Result<GetEndpointsResponse> response) {
            if (response) {
                done(moved_out(response->endpoints));
            } else {
                done(fail(response.error()));
            }
        },
        options);
}

} // namespace busbar::client
