#include "failure_cases.hpp"
#include "support/failing_worlds.hpp"

namespace late_nodes_failure_test {

/// Fields of diagnostics that are added when a client looks for them, when there is no memory
/// for a moment.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

BrowseRequest components_of(const NodeId& node)
{
    BrowseRequest request;
    request.nodes_to_browse.resize(1);
    request.nodes_to_browse[0].node_id = node;
    request.nodes_to_browse[0].reference_type_id = NodeId{0, id::HasComponent};
    request.nodes_to_browse[0].result_mask = 0x3F;
    return request;
}

/// The first component of that name, or the first of all.
NodeId component(TestClient& client, const NodeId& node, const char* name = nullptr)
{
    const auto response = client.call<BrowseResponse>(components_of(node));
    REQUIRE(response);
    for (const ReferenceDescription& reference : response->results[0].references) {
        if (name == nullptr || reference.browse_name.name == name) {
            return reference.node_id.node_id;
        }
    }
    FAIL("nothing below " << to_string(node));
    return {};
}

bool fail_once(std::uint32_t array, std::size_t fields, std::size_t k, std::size_t most)
{
    FailureFixture world;
    world.subscribe();
    const NodeId part = component(world.other, NodeId{0, array});
    const FailureCase asked = asking<BrowseResponse>(components_of(part));
    auto [answer, has_failed] = world.attempt(asked, k, most);
    INFO("allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    const auto again = world.other.call<BrowseResponse>(components_of(part));
    REQUIRE(again);
    CHECK(again->results[0].references.size() == fields);
    return has_failed;
}

} // namespace

TEST_CASE("a Browse that found no memory for fields of diagnostics adds them the next time")
{
    const auto [array, fields] = GENERATE(table<std::uint32_t, std::size_t>({
        {id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionDiagnosticsArray, 43U},
        {id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray, 31U},
    }));
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("Browse", [array = array, fields = fields, most](std::size_t k) {
        return fail_once(array, fields, k, most);
    });
}

} // namespace late_nodes_failure_test
