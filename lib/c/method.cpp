#include <optional>
#include <utility>
#include <vector>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>

#include "server.hpp"

/// A call with its arguments in C.
struct busbar_call {
    explicit busbar_call(busbar::server::MethodCall&& of) : call{std::move(of)} {}

    busbar::server::MethodCall call;
    std::vector<busbar_value> inputs;
    std::vector<busbar_value> outputs;
    busbar::c::Scratch scratch;
};

namespace busbar::c {

namespace {

/// The callback of one Method.
struct MethodRoutine {
    busbar_method_callback callback;
    void* context;
    /// Null values of the outputs' types.
    std::vector<busbar_value> outputs;
};

StatusCode answer(server::MethodCall& call, StatusCode status,
                  std::span<const busbar_value> outputs)
{
    if (status.is_bad()) {
        call.fail(status);
        return status::Good;
    }
    Array<Variant> values;
    values.reserve(outputs.size());
    for (const busbar_value& output : outputs) {
        auto value = to_variant(output);
        if (!value) {
            call.fail(status::Bad_InternalError);
            return value.error();
        }
        values.push_back(*std::move(value));
    }
    call.succeed(std::move(values));
    return status::Good;
}

/// Carries out one call; without memory MethodTable answers for it.
void carry_out(const MethodRoutine& routine, server::MethodCall&& call)
{
    auto made = std::make_unique<busbar_call>(std::move(call));
    for (const Variant& input : made->call.inputs()) {
        busbar_value in_c;
        if (to_c(input, made->scratch, in_c).is_bad()) {
            return made->call.fail(status::Bad_NotSupported);
        }
        made->inputs.push_back(in_c);
    }
    made->outputs = routine.outputs;
    busbar_call* const in_c = made.release();
    const busbar_status status =
        routine.callback(routine.context, in_c, in_c->inputs.data(), in_c->inputs.size(),
                         in_c->outputs.data(), in_c->outputs.size());
    if (status != BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY) {
        const std::unique_ptr<busbar_call> owned{in_c};
        static_cast<void>(answer(owned->call, StatusCode{status}, owned->outputs));
    }
}

/// Returns nothing for an argument without a name or with a type that busbar_value lacks.
std::optional<Array<Argument>> arguments_of(const busbar_argument* from, std::size_t count)
{
    Array<Argument> arguments;
    for (std::size_t i = 0; i < count; ++i) {
        Argument argument;
        argument.name = string_of(from[i].name);
        argument.data_type = built_in_type_id(from[i].type);
        argument.value_rank = from[i].is_array ? 1 : -1;
        argument.description.text = string_of(from[i].description);
        if (argument.name.empty() || argument.data_type.is_null()) {
            return std::nullopt;
        }
        arguments.push_back(std::move(argument));
    }
    return arguments;
}

} // namespace

} // namespace busbar::c

using namespace busbar;

busbar_status busbar_server_add_method(busbar_server* server, const busbar_node* node,
                                       const busbar_argument* inputs, size_t input_count,
                                       const busbar_argument* outputs, size_t output_count,
                                       busbar_method_callback callback, void* context)
{
    return c::change(server, [&]() -> StatusCode {
        if (node == nullptr || callback == nullptr || !c::has_all(inputs, input_count) ||
            !c::has_all(outputs, output_count) || input_count > c::max_elements ||
            output_count > c::max_elements) {
            return status::Bad_InvalidArgument;
        }
        auto in = c::arguments_of(inputs, input_count);
        auto out = c::arguments_of(outputs, output_count);
        if (!in || !out) {
            return status::Bad_InvalidArgument;
        }
        model::AddressSpace& space = server->server->address_space();
        const auto made = c::new_node_of(space, *node, id::ObjectsFolder);
        if (!made) {
            return made.error();
        }
        c::MethodRoutine routine{callback, context, {}};
        for (std::size_t i = 0; i < output_count; ++i) {
            busbar_value& output = routine.outputs.emplace_back();
            output.type = outputs[i].type;
            output.is_array = outputs[i].is_array;
        }
        model::NewMethod method;
        method.input_arguments = *std::move(in);
        method.output_arguments = *std::move(out);
        method.source = server->methods->index();
        method.handle =
            server->methods->add([routine = std::move(routine)](server::MethodCall call) {
                c::carry_out(routine, std::move(call));
            });
        busbar::detail::Undo undo{[&] { server->methods->remove(method.handle); }};
        const auto added = space.add_method(*made, method);
        if (!added) {
            return added.error();
        }
        undo.keep();
        return status::Good;
    });
}

busbar_status busbar_call_finish(busbar_call* call, busbar_status status,
                                 const busbar_value* outputs, size_t output_count)
{
    if (call == nullptr) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    const std::unique_ptr<busbar_call> owned{call};
    return c::run_guarded(nullptr, [&]() -> StatusCode {
        if (StatusCode{status}.is_bad()) {
            output_count = 0; // a failure has none
        }
        if (!c::has_all(outputs, output_count) || output_count > c::max_elements) {
            owned->call.fail(status::Bad_InternalError);
            return status::Bad_InvalidArgument;
        }
        return c::answer(owned->call, StatusCode{status}, {outputs, output_count});
    });
}
