#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <busbar/client/attributes.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/node_address.hpp>
#include <busbar/client/view.hpp>

#include "client.hpp"

namespace busbar::c {

namespace {

using Nodes = std::vector<client::NodeAddress>;
using Found = std::vector<Result<NodeId>>;

/// Returns the addresses; those that are malformed keep their status in `refused`.
Nodes addresses_of(std::span<const char* const> texts, std::vector<StatusCode>& refused)
{
    Nodes nodes;
    for (const char* const text : texts) {
        auto address =
            text != nullptr ? client::NodeAddress::parse(text) : fail(status::Bad_NodeIdInvalid);
        refused.push_back(address ? StatusCode{} : address.error());
        nodes.push_back(address ? *std::move(address) : client::NodeAddress{});
    }
    return nodes;
}

/// Resolves the nodes, in one or more requests if paths are among them.
Result<Found> resolved(busbar_client& client, std::span<const char* const> texts)
{
    std::vector<StatusCode> refused;
    Nodes nodes = addresses_of(texts, refused);
    auto found = client.client->wait_for<Found>([&](auto done) {
        return client::resolve(client.client->client(), std::move(nodes), std::move(done));
    });
    for (std::size_t i = 0; found && i < refused.size(); ++i) {
        if (refused[i].is_bad()) {
            (*found)[i] = fail(refused[i]);
        }
    }
    return found;
}

StatusCode read(busbar_client& client, std::span<const char* const> texts,
                busbar_data_value* results)
{
    std::vector<StatusCode> refused;
    Nodes nodes = addresses_of(texts, refused);
    auto values = client.client->wait_for<std::vector<DataValue>>([&](auto done) {
        return client::read(client.client->client(), std::move(nodes), std::move(done));
    });
    if (!values) {
        return values.error();
    }
    client.values = *std::move(values);
    client.scratch.clear();
    for (std::size_t i = 0; i < texts.size(); ++i) {
        if (refused[i].is_bad()) {
            client.values[i] = DataValue{refused[i]};
        }
        static_cast<void>(to_c(client.values[i], client.scratch, results[i]));
    }
    return status::Good;
}

StatusCode write(busbar_client& client, std::span<const char* const> texts,
                 const busbar_value* values, busbar_status* results)
{
    const auto found = resolved(client, texts);
    if (!found) {
        return found.error();
    }
    std::vector<WriteValue> items;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        auto value = to_variant(values[i]);
        results[i] = (*found)[i] ? (value ? BUSBAR_GOOD : value.error().value())
                                 : (*found)[i].error().value();
        if (results[i] == BUSBAR_GOOD) {
            items.push_back(client::value_for(*(*found)[i], DataValue{*std::move(value)}));
            places.push_back(i);
        }
    }
    const auto written = client.client->wait_for<std::vector<StatusCode>>([&](auto done) {
        return client::write(client.client->client(), std::move(items), std::move(done));
    });
    if (!written) {
        return written.error();
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        results[places[i]] = (*written)[i].value();
    }
    return status::Good;
}

StatusCode call(busbar_client& client, std::span<const char* const> object_and_method,
                std::span<const busbar_value> inputs)
{
    CallMethodRequest request;
    for (const busbar_value& input : inputs) {
        auto value = to_variant(input);
        if (!value) {
            return value.error();
        }
        request.input_arguments.push_back(*std::move(value));
    }
    const auto found = resolved(client, object_and_method);
    if (!found) {
        return found.error();
    }
    if (!(*found)[0] || !(*found)[1]) {
        return (*found)[0] ? (*found)[1].error() : (*found)[0].error();
    }
    request.object_id = *(*found)[0];
    request.method_id = *(*found)[1];
    std::vector<CallMethodRequest> requests;
    requests.push_back(std::move(request));
    auto results = client.client->wait_for<std::vector<CallMethodResult>>([&](auto done) {
        return client::call(client.client->client(), std::move(requests), std::move(done));
    });
    if (!results) {
        return results.error();
    }
    CallMethodResult& result = results->front();
    client.outputs = std::move(result.output_arguments);
    client.outputs_in_c.clear();
    client.scratch.clear();
    for (const Variant& output : client.outputs) {
        busbar_value in_c;
        if (const StatusCode converted = to_c(output, client.scratch, in_c); converted.is_bad()) {
            return converted;
        }
        client.outputs_in_c.push_back(in_c);
    }
    return result.status_code;
}

busbar_reference reference_of(const ReferenceDescription& from, Scratch& scratch)
{
    busbar_reference to{};
    to.node = scratch.keep(to_string(from.node_id)).data;
    to.reference_type = scratch.keep(to_string(from.reference_type_id)).data;
    to.browse_name.namespace_index = from.browse_name.namespace_index;
    to.browse_name.name = scratch.keep(from.browse_name.name.view());
    to.display_name.locale = scratch.keep(from.display_name.locale.view());
    to.display_name.text = scratch.keep(from.display_name.text.view());
    to.node_class = static_cast<std::int32_t>(from.node_class);
    return to;
}

StatusCode browse(busbar_client& client, const char* node)
{
    const auto found = resolved(client, {&node, 1});
    if (!found || !found->front()) {
        return found ? found->front().error() : found.error();
    }
    std::vector<BrowseDescription> nodes;
    nodes.push_back(client::children_of(*found->front()));
    const auto results = client.client->wait_for<std::vector<BrowseResult>>([&](auto done) {
        return client::browse(client.client->client(), std::move(nodes), std::move(done));
    });
    if (!results) {
        return results.error();
    }
    client.references.clear();
    client.scratch.clear();
    for (const ReferenceDescription& reference : results->front().references) {
        client.references.push_back(reference_of(reference, client.scratch));
    }
    return results->front().status_code;
}

bool is_count(std::size_t count)
{
    return count >= 1 && count <= max_elements;
}

} // namespace

} // namespace busbar::c

using namespace busbar;

busbar_status busbar_client_read(busbar_client* client, const char* const* nodes, size_t count,
                                 busbar_data_value* results)
{
    const bool has_room = results != nullptr && c::is_count(count);
    const busbar_status read = c::wait(client, [&]() -> StatusCode {
        return nodes != nullptr && has_room ? c::read(*client, {nodes, count}, results)
                                            : status::Bad_InvalidArgument;
    });
    if (read != BUSBAR_GOOD && has_room) {
        busbar_data_value failed{};
        failed.status = read;
        std::fill_n(results, count, failed);
    }
    return read;
}

busbar_status busbar_client_write(busbar_client* client, const char* const* nodes,
                                  const busbar_value* values, size_t count, busbar_status* results)
{
    const bool has_room = results != nullptr && c::is_count(count);
    const busbar_status written = c::wait(client, [&]() -> StatusCode {
        return nodes != nullptr && values != nullptr && has_room
                   ? c::write(*client, {nodes, count}, values, results)
                   : status::Bad_InvalidArgument;
    });
    if (written != BUSBAR_GOOD && has_room) {
        std::fill_n(results, count, written);
    }
    return written;
}

busbar_status busbar_client_call(busbar_client* client, const char* object, const char* method,
                                 const busbar_value* inputs, size_t input_count,
                                 const busbar_value** outputs, size_t* output_count)
{
    return c::wait(client, [&]() -> StatusCode {
        if (!c::has_all(inputs, input_count) || input_count > c::max_elements ||
            (outputs == nullptr) != (output_count == nullptr)) {
            return status::Bad_InvalidArgument;
        }
        const char* const both[] = {object, method};
        client->outputs_in_c.clear();
        const StatusCode called = c::call(*client, both, {inputs, input_count});
        if (outputs != nullptr) {
            *outputs = client->outputs_in_c.data();
            *output_count = client->outputs_in_c.size();
        }
        return called;
    });
}

busbar_status busbar_client_browse(busbar_client* client, const char* node,
                                   const busbar_reference** references, size_t* count)
{
    return c::wait(client, [&]() -> StatusCode {
        if (references == nullptr || count == nullptr) {
            return status::Bad_InvalidArgument;
        }
        client->references.clear();
        const StatusCode browsed = c::browse(*client, node);
        *references = client->references.data();
        *count = client->references.size();
        return browsed;
    });
}
