#include <memory>

#include <busbar/types/discovery.hpp>

#include "commands.hpp"
#include "tool/connection/discovery.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool {

namespace {

std::string_view type_name(ApplicationType type)
{
    switch (type) {
    case ApplicationType::Server:
        return "Server";
    case ApplicationType::Client:
        return "Client";
    case ApplicationType::ClientAndServer:
        return "ClientAndServer";
    case ApplicationType::DiscoveryServer:
        return "DiscoveryServer";
    }
    return "?";
}

std::string json_of(const Array<ApplicationDescription>& servers)
{
    JsonLine json;
    json.open_array();
    for (const ApplicationDescription& server : servers) {
        json.open_object();
        json.member("name", server.application_name.text.view());
        json.member("uri", server.application_uri.view());
        json.member("productUri", server.product_uri.view());
        json.member("type", type_name(server.application_type));
        json.key("discoveryUrls").open_array();
        for (const String& url : server.discovery_urls) {
            json.text(url.view());
        }
        json.close_array().close_object();
    }
    return json.close_array().document();
}

void print(Output& out, const Array<ApplicationDescription>& servers)
{
    Table table{{{"NAME"}, {"TYPE"}, {"APPLICATION URI", 12}, {"URL", 24}}};
    for (const ApplicationDescription& server : servers) {
        const std::size_t rows = std::max<std::size_t>(1, server.discovery_urls.size());
        for (std::size_t i = 0; i < rows; ++i) {
            const std::string url =
                i < server.discovery_urls.size() ? safe(server.discovery_urls[i].view()) : "-";
            if (i == 0) {
                table.add({{safe(server.application_name.text.view())},
                           {std::string{type_name(server.application_type)}},
                           {safe(server.application_uri.view())},
                           {url}});
            } else {
                table.add({{}, {}, {}, {url}});
            }
        }
    }
    table.print(out);
}

/// FindServersOnNetwork (Part 4, 5.5.3).
Exit discover_network(Context& context)
{
    DiscoveryConnection connection{context};
    const auto response =
        connection.call<FindServersOnNetworkResponse>(FindServersOnNetworkRequest{});
    if (context.options.is_json) {
        JsonLine json;
        json.open_array();
        for (const ServerOnNetwork& server : response.servers) {
            json.open_object();
            json.member("record", std::int64_t{server.record_id});
            json.member("name", server.server_name.view());
            json.member("url", server.discovery_url.view());
            json.key("capabilities").open_array();
            for (const String& capability : server.server_capabilities) {
                json.text(capability.view());
            }
            json.close_array().close_object();
        }
        context.out.line(json.close_array().document());
        return Exit::Good;
    }
    Table table{{{"RECORD", 6, true}, {"NAME"}, {"CAPABILITIES"}, {"URL", 24}}};
    for (const ServerOnNetwork& server : response.servers) {
        std::string capabilities;
        for (const String& capability : server.server_capabilities) {
            capabilities += (capabilities.empty() ? "" : ",") + safe(capability.view());
        }
        table.add({{std::to_string(server.record_id)},
                   {safe(server.server_name.view())},
                   {capabilities.empty() ? "-" : capabilities},
                   {safe(server.discovery_url.view())}});
    }
    table.print(context.out);
    return Exit::Good;
}

Exit discover(Context& context)
{
    DiscoveryConnection connection{context};
    FindServersRequest request;
    request.endpoint_url = connection.url();
    const auto response = connection.call<FindServersResponse>(std::move(request));
    if (context.options.is_json) {
        context.out.line(json_of(response.servers));
    } else {
        print(context.out, response.servers);
    }
    return Exit::Good;
}

} // namespace

void add_discover(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("discover", "Lists the servers that a server knows of.");
    auto arguments = std::make_shared<std::vector<std::string>>();
    command->add_option("URL", *arguments, "server, mostly a discovery server");
    auto is_of_network = std::make_shared<bool>(false);
    command->add_flag("--network", *is_of_network,
                      "those that a discovery server knows from the network");
    when_chosen(*command, run, [arguments, is_of_network](Context& context) {
        take_only_url(*arguments, context.options);
        return *is_of_network ? discover_network(context) : discover(context);
    });
}

} // namespace busbar::tool
