#include <catch2/catch.hpp>

#include <array>
#include <atomic>
#include <cstdio>
#include <limits>
#include <string>
#include <sys/wait.h>
#include <thread>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/harness_net/real_world.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

namespace check_rules_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

/// `busbar check` with --json, on a thread.
class Check {
public:
    explicit Check(const std::string& url)
        : thread_{[this, url] {
              const std::string command = "XDG_DATA_HOME=/dev/null/none " BUSBAR
                                          " --json --insecure --timeout 10 check " +
                                          url + " --rule-timeout 2 2>/dev/null";
              std::FILE* const output = popen(command.c_str(), "r");
              std::array<char, 4'096> part;
              while (const std::size_t size = std::fread(part.data(), 1, part.size(), output)) {
                  text.append(part.data(), size);
              }
              code = WEXITSTATUS(pclose(output));
              is_done = true;
          }}
    {
    }
    ~Check() { thread_.join(); }

    /// The outcome of a rule.
    [[nodiscard]] std::string outcome(const std::string& id) const
    {
        const std::size_t begin = text.find("{\"id\":\"" + id + "\"");
        const std::string key = "\"outcome\":\"";
        const std::size_t at = text.find(key, begin);
        if (begin == std::string::npos || at == std::string::npos) {
            return "no such rule";
        }
        return text.substr(at + key.size(), text.find('"', at + key.size()) - at - key.size());
    }

    std::atomic<bool> is_done{false};
    std::string text;
    int code{-1};

private:
    std::thread thread_;
};

/// A server that answers every Read of its few nodes and looks at nothing else in the request.
Result<ReadResponse> careless_read(const ReadRequest& request, DateTime now)
{
    ReadResponse response;
    response.results.resize(request.nodes_to_read.size());
    for (std::size_t i = 0; i < response.results.size(); ++i) {
        const NodeId& node = request.nodes_to_read[i].node_id;
        DataValue& value = response.results[i];
        if (node.is(id::Server_NamespaceArray)) {
            value = DataValue{Variant{Array<String>{"http://opcfoundation.org/UA/", "urn:x"}}};
        } else if (node.is(id::Server_ServerStatus_CurrentTime) || node.is(id::Server)) {
            value = DataValue{Variant{now}};
        } else {
            value = DataValue{status::Bad_NodeIdInvalid};
        }
        value.source_timestamp = now;
        value.server_timestamp = now;
    }
    return response;
}

/// Returns the same two references whatever is asked.
BrowseResponse careless_browse(const BrowseRequest& request)
{
    BrowseResponse response;
    for (std::size_t i = 0; i < request.nodes_to_browse.size(); ++i) {
        BrowseResult& result = response.results.emplace_back();
        for (const char* const name : {"One", "Two"}) {
            ReferenceDescription& reference = result.references.emplace_back();
            reference.browse_name = QualifiedName{0, String{name}};
            reference.is_forward = true;
            reference.node_class = NodeClass::Object;
        }
    }
    return response;
}

/// Grants every item, with a sampling interval that never ends.
CreateMonitoredItemsResponse careless_items(const CreateMonitoredItemsRequest& request)
{
    CreateMonitoredItemsResponse response;
    for (const MonitoredItemCreateRequest& item : request.items_to_create) {
        MonitoredItemCreateResult& result = response.results.emplace_back();
        result.monitored_item_id = 1;
        result.revised_sampling_interval = std::numeric_limits<double>::infinity();
        result.revised_queue_size = item.requested_parameters.queue_size;
    }
    return response;
}

EndpointDescription endpoint_of(const std::string& url)
{
    EndpointDescription endpoint;
    endpoint.endpoint_url = String{url};
    endpoint.security_mode = MessageSecurityMode::None;
    endpoint.security_policy_uri = String{crypto::policy_none().uri};
    endpoint.transport_profile_uri =
        "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
    UserTokenPolicy& policy = endpoint.user_identity_tokens.emplace_back();
    policy.policy_id = "anonymous";
    policy.token_type = UserTokenType::Anonymous;
    return endpoint;
}

/// Grants one session to everybody, for ever, and creates Subscriptions that cannot be.
void add_careless_services(ScriptedServer& server, const std::string& url, const RealWorld& world)
{
    server.forgive_report(); // rules ask more than it knows
    server.allow<GetEndpointsRequest>().reply([=](const GetEndpointsRequest&) {
        GetEndpointsResponse response;
        response.endpoints = {endpoint_of(url)};
        return response;
    });
    server.allow<CreateSessionRequest>().reply([=](const CreateSessionRequest& request) {
        CreateSessionResponse response;
        response.session_id = NodeId{1, 1U};
        response.authentication_token = NodeId{1, 2U};
        response.revised_session_timeout = request.requested_session_timeout;
        response.server_endpoints = {endpoint_of(url)};
        return response;
    });
    server.allow<ActivateSessionRequest>().reply(ActivateSessionResponse{});
    server.allow<CloseSessionRequest>().reply(CloseSessionResponse{});
    server.allow<ReadRequest>().reply([&world](const ReadRequest& request) {
        return careless_read(request, world.clock().now());
    });
    server.allow<BrowseRequest>().reply(careless_browse);
    server.allow<CreateSubscriptionRequest>().reply([](const CreateSubscriptionRequest& request) {
        CreateSubscriptionResponse response;
        response.revised_publishing_interval = request.requested_publishing_interval;
        response.revised_lifetime_count = request.requested_lifetime_count;
        response.revised_max_keep_alive_count = request.requested_max_keep_alive_count;
        return response;
    });
    server.allow<CreateMonitoredItemsRequest>().reply(careless_items);
    server.allow<DeleteSubscriptionsRequest>().reply(DeleteSubscriptionsResponse{});
}

} // namespace

TEST_CASE("busbar check finds what a careless server does", "[check]")
{
    RealWorld world;
    const std::string url = need(world.open("127.0.0.1"));
    ScriptedServer server{world, url};
    add_careless_services(server, url, world);

    Check check{url};
    REQUIRE(world.run_until([&] { return check.is_done.load(); }, 120s));
    INFO(check.text);
    CHECK(check.code == 1);
    for (const char* const id : {"read-nothing",
                                 "read-max-age-negative",
                                 "read-timestamps-invalid",
                                 "read-timestamps-source",
                                 "read-timestamps-neither",
                                 "read-node-unknown",
                                 "read-attribute-zero",
                                 "read-value-of-object",
                                 "read-range-syntax",
                                 "read-range-no-data",
                                 "read-range-element",
                                 "read-node-id",
                                 "browse-nothing",
                                 "browse-node-unknown",
                                 "browse-direction-invalid",
                                 "browse-reference-type-unknown",
                                 "browse-max-references",
                                 "browse-node-classes",
                                 "browse-result-mask",
                                 "browse-inverse",
                                 "browse-view-unknown",
                                 "session-timeout-zero",
                                 "session-tokens",
                                 "session-not-activated",
                                 "session-token-unknown",
                                 "close-then-use",
                                 "activate-policy-unknown",
                                 "subscription-interval-zero",
                                 "subscription-lifetime",
                                 "subscription-keep-alive-zero",
                                 "subscription-id"}) {
        INFO(id);
        CHECK(check.outcome(id) == "failed");
    }
    for (const char* const id : {"read-twice", "read-encoding-of-scalar", "read-timestamps-both",
                                 "read-node-unknown-has-no-value", "session-endpoints",
                                 "header-handle", "header-time", "encoding-node-four-bytes"}) {
        INFO(id);
        CHECK(check.outcome(id) == "passed");
    }
    // Of services that it does not have, and of what the session does not have.
    for (const char* const id :
         {"register-nothing", "transfer-nothing", "write-nothing", "write-value",
          "session-nonce-short", "activate-signature", "item-overflow-oldest"}) {
        INFO(id);
        CHECK(check.outcome(id) == "not applicable");
    }
    CHECK(check.text.find("a sampling interval that is short enough") != std::string::npos);
}

TEST_CASE("a server that goes away is one finding", "[check]")
{
    RealWorld world;
    const std::string url = need(world.open("127.0.0.1"));
    auto server = std::make_unique<ScriptedServer>(world, url);
    add_careless_services(*server, url, world);
    Check check{url};
    // Its end comes with the first Browse.
    REQUIRE(world.run_until(
        [&] {
            const auto& requests = server->came();
            return std::find(requests.begin(), requests.end(), "BrowseRequest") != requests.end();
        },
        60s));
    server.reset();
    REQUIRE(world.run_until([&] { return check.is_done.load(); }, 120s));
    CHECK(check.code == 1);
    CHECK(check.outcome("register-readable") == "not applicable");
    CHECK(check.outcome("item-first-value") == "not applicable");
}

} // namespace check_rules_test
