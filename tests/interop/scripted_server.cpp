// A server that is wrong on purpose, for clients of other stacks.
// usage: scripted-server SCENARIO [secured]
// Prints "ready URL"; ends with its standard input, or when it has nothing more to do, and prints
// then what did not go by its script.
#include <poll.h>
#include <unistd.h>

#include <functional>
#include <iostream>
#include <map>

#include <busbar/crypto/security_policy.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/report.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/harness_net/real_world.hpp>
#include <busbar/types/subscription.hpp>

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

const NodeId level{1, "Level"};

ReadResponse read_response(double value)
{
    ReadResponse response;
    response.results.push_back(DataValue{Variant{value}});
    return response;
}

using Scenario = std::function<void(ScriptedServer&)>;

Scenario wrong(const Wrong& how)
{
    return [how](ScriptedServer& server) {
        server.expect<ReadRequest>(reads(level)).reply(read_response(1.5)).wrong(how);
        server.allow<ReadRequest>(reads(level)).reply(read_response(2.5));
    };
}

const std::map<std::string, Scenario>& scenarios()
{
    static const std::map<std::string, Scenario> known{
        {"right", wrong({})},
        {"late",
         [](ScriptedServer& server) {
             server.expect<ReadRequest>(reads(level)).reply(read_response(1.5), after(3s));
             server.allow<ReadRequest>(reads(level)).reply(read_response(2.5));
         }},
        {"cut",
         [](ScriptedServer& server) {
             server.expect<ReadRequest>(reads(level)).cut();
             server.allow<ReadRequest>(reads(level)).reply(read_response(2.5));
         }},
        {"sequence", wrong({.sequence = Wrong::Sequence::Again})},
        {"signature", wrong({.signature = true})},
        {"handle", wrong({.request_handle = 4711})},
        {"abort", wrong({.abort = status::Bad_ResponseTooLarge})},
        {"twice", wrong({.copies = 2})},
        {"publish", [](ScriptedServer& server) {
             CreateSubscriptionResponse created;
             created.subscription_id = 7;
             created.revised_publishing_interval = 100;
             created.revised_lifetime_count = 100;
             created.revised_max_keep_alive_count = 10;
             server.allow<CreateSubscriptionRequest>().reply(created);
             server.allow<PublishRequest>(); // no answer
             server.allow<ReadRequest>(reads(level)).reply(read_response(2.5));
             DeleteSubscriptionsResponse deleted;
             deleted.results.push_back({});
             server.allow<DeleteSubscriptionsRequest>().reply(deleted);
         }}};
    return known;
}

bool input_has_ended()
{
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char byte = 0;
    return ::poll(&input, 1, 0) > 0 && ::read(STDIN_FILENO, &byte, 1) == 0;
}

} // namespace

int main(int argc, char** argv)
{
    const auto found = argc > 1 ? scenarios().find(argv[1]) : scenarios().end();
    if (found == scenarios().end()) {
        std::cerr << "usage: scripted-server SCENARIO [secured]\n";
        return 2;
    }
    RealWorld world;
    const std::string url = need(world.open("127.0.0.1"));
    ScriptedServerParts parts;
    IdentityOptions options;
    options.host_names = {"127.0.0.1"};
    options.valid_from = DateTime{world.clock().now().ticks - 3'600 * DateTime::ticks_per_second};
    const auto identity = need(make_identity(options));
    if (argc > 2) {
        parts.allowed = {
            {}, // for discovery
            {crypto::find_policy_by_name("Basic256Sha256"), MessageSecurityMode::SignAndEncrypt}};
        parts.identity = &identity;
    }
    ScriptedServer server{world, url, parts};
    server.accept_clients();
    found->second(server);
    std::cout << "ready " << url << std::endl;
    while (!input_has_ended()) {
        world.run_for(20ms);
    }
    std::cout << server.report() << std::flush;
    return 0;
}
