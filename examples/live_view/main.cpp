#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/core/attribute_id.hpp>
#include <busbar/net/client_loop.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "value_text.hpp"

using namespace busbar;

namespace {

volatile std::sig_atomic_t is_interrupted = 0;

struct Options {
    std::string url{"opc.tcp://localhost:4840"};
    int rounds{0};
    int interval_ms{500};
    std::size_t rows{24};
};

struct Variable {
    NodeId node_id;
    std::string name;
};

/// Components of the first Object below Objects that is not one of the specification's.
Result<Array<ReferenceDescription>> browse(net::ClientLoop& loop, const NodeId& node)
{
    BrowseRequest request;
    BrowseDescription& description = request.nodes_to_browse.emplace_back();
    description.node_id = node;
    description.reference_type_id = NodeId{0, id::HierarchicalReferences};
    description.include_subtypes = true;
    description.result_mask = 63;
    const auto event = loop.call(request);
    const auto response = event ? event->response<BrowseResponse>() : fail(event.error());
    if (!response || response->results.size() != 1) {
        return fail(response ? status::Bad_UnexpectedError : response.error());
    }
    return response->results[0].references;
}

Result<std::vector<Variable>> find_variables(net::ClientLoop& loop, std::size_t most)
{
    std::vector<Variable> variables;
    const auto objects = browse(loop, NodeId{0, id::ObjectsFolder});
    if (!objects) {
        return fail(objects.error());
    }
    for (const ReferenceDescription& object : *objects) {
        if (object.node_id.node_id.namespace_index() == 0) {
            continue;
        }
        const auto members = browse(loop, object.node_id.node_id);
        if (!members) {
            return fail(members.error());
        }
        for (const ReferenceDescription& member : *members) {
            if (member.node_class == NodeClass::Variable && variables.size() < most) {
                variables.push_back({member.node_id.node_id, member.browse_name.name.str()});
            }
        }
    }
    return variables;
}

Result<Array<DataValue>> read(net::ClientLoop& loop, const std::vector<Variable>& variables)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Source;
    for (const Variable& variable : variables) {
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = variable.node_id;
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    }
    const auto event = loop.call(request);
    const auto response = event ? event->response<ReadResponse>() : fail(event.error());
    if (!response) {
        return fail(response.error());
    }
    return response->results;
}

void show(const Options& options, const std::vector<Variable>& variables,
          const Array<DataValue>& values, bool is_first)
{
    if (!is_first) {
        std::printf("\x1b[%zuA", variables.size() + 1); // up, over the last picture
    }
    std::printf("\x1b[2K%s, every %d ms (Ctrl+C ends)\n", options.url.c_str(), options.interval_ms);
    for (std::size_t i = 0; i < variables.size(); ++i) {
        const std::string shown = printable(variables[i].name, 24);
        std::printf("\x1b[2K  %-24s %-44s %s\n", shown.c_str(),
                    example::text_of(values[i], 44).c_str(),
                    to_string(values[i].source_timestamp).c_str());
    }
    std::fflush(stdout);
}

Result<void> view(net::ClientLoop& loop, const Options& options)
{
    const auto variables = find_variables(loop, options.rows);
    if (!variables) {
        return fail(variables.error());
    }
    for (int round = 0; is_interrupted == 0 && (options.rounds == 0 || round < options.rounds);
         ++round) {
        const auto values = read(loop, *variables);
        if (!values) {
            return fail(values.error());
        }
        show(options, *variables, *values, round == 0);
        static_cast<void>(loop.wait(std::chrono::milliseconds{options.interval_ms}));
    }
    return {};
}

} // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App app{"Shows the variables of an OPC UA server, live, over a channel without security: "
                 "for the demo configuration."};
    app.add_option("url", options.url, "endpoint")->capture_default_str();
    app.add_option("--rounds", options.rounds, "pictures to show; 0 for no end");
    app.add_option("--interval", options.interval_ms, "milliseconds between two pictures")
        ->capture_default_str();
    app.add_option("--rows", options.rows, "variables to show")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    std::signal(SIGINT, [](int) { is_interrupted = 1; });

    crypto::SystemRandom random;
    net::SystemWallClock wall_clock;
    NullLog log;
    const channel::ChannelEnvironment environment{&random, &wall_clock, &log, nullptr, nullptr};
    client::ConnectionConfig config;
    config.channel.endpoint_url = options.url;
    net::ClientLoop loop;
    auto done = loop.connect(config, environment);
    if (done) {
        done = loop.wait_until_ready();
    }
    if (done) {
        done = view(loop, options);
    }
    loop.close();
    if (!done) {
        std::fprintf(stderr, "%s: %s\n", options.url.c_str(),
                     std::string{name(done.error())}.c_str());
        return 1;
    }
    return 0;
}
