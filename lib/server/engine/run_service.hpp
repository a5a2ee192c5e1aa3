#pragma once

#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include <busbar/binary/codec.hpp>

#include "core.hpp"
#include "known_requests.hpp"
#include "peer_link.hpp"
#include "service_table.hpp"

/// Rows of a ServiceTable, made from the functions and operations of the service sets.
namespace busbar::server::detail {

/// The needs of a service set, by a member of Core or a function of it.
template <auto Needs>
using NeedsOf = std::remove_reference_t<std::invoke_result_t<decltype(Needs), Core&>>;
template <typename Request, typename Response, typename Needs>
using ServiceFunction = StatusCode(Needs&, ServiceContext&, const Request&, Response&);

template <typename Request, typename Response, auto Needs,
          ServiceFunction<Request, Response, NeedsOf<Needs>>* Function>
void run_function(Core& core, ServiceContext& context, Incoming& incoming)
{
    binary::Reader reader{std::span{incoming.message}.subspan(incoming.offset),
                          binary::Strings::Borrow, &core.types, core.limits().decode};
    reader.keep_memory_in(&core.kept_memory);
    Request request;
    decode_parameters(reader, request);
    if (reader.ok() && reader.remaining() != 0) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.ok()) {
        return context.peer.fault(incoming.reply, reader.status());
    }
    Response response;
    const StatusCode status = Function(std::invoke(Needs, core), context, request, response);
    if (status.is_bad()) {
        core.counters.count_fault(context.session, Request::binary_encoding_id, status);
        return context.peer.fault(incoming.reply, status);
    }
    response.response_header = context.peer.response_header(incoming.reply, status);
    if (incoming.reply.return_diagnostics != 0) {
        ReturnDiagnostics diagnostics{incoming.reply.return_diagnostics};
        diagnose(diagnostics, request, response);
        response.response_header.string_table = diagnostics.string_table();
    }
    context.peer.respond(incoming.reply, Response::binary_encoding_id,
                         [&](binary::Writer& writer) { encode(writer, response); });
    incoming.link.recycle(std::move(incoming.message));
}

/// Starts the operation, unless the connection has too many that wait.
void run_operation(Core& core, ServiceContext& context, Incoming& incoming,
                   std::uint32_t encoding_id,
                   FunctionRef<std::unique_ptr<ServiceOperation>()> make);

template <typename T, typename Needs>
std::unique_ptr<ServiceOperation> make_operation(Needs& needs)
{
    return std::make_unique<T>(needs);
}

template <typename Request, typename Response, auto Needs,
          ServiceFunction<Request, Response, NeedsOf<Needs>>* Function>
constexpr Service function(Need need, Lasts lasts = Lasts::WhileRunning)
{
    static_assert(KnownRequests::contains<Request>, "add the request to known_requests.hpp");
    return {Request::binary_encoding_id, need, lasts,
            run_function<Request, Response, Needs, Function>};
}

template <typename Request, auto Make, auto Needs>
constexpr Service operation(Need need, Lasts lasts = Lasts::WhileRunning)
{
    static_assert(KnownRequests::contains<Request>, "add the request to known_requests.hpp");
    return {Request::binary_encoding_id, need, lasts,
            [](Core& core, ServiceContext& context, Incoming& incoming) {
                run_operation(core, context, incoming, Request::binary_encoding_id,
                              [&] { return Make(std::invoke(Needs, core)); });
            }};
}

} // namespace busbar::server::detail
