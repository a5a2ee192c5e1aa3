#include "server/engine/service_table.hpp"

#include <array>

#include <catch2/catch.hpp>

#include <busbar/types/attribute.hpp>
#include <busbar/types/subscription.hpp>

namespace service_table_test {

using namespace busbar;
using namespace busbar::server::detail;

namespace {

void serve(Core& /*core*/, ServiceContext& /*context*/, Incoming& /*incoming*/) {}

constexpr std::uint32_t last_known = DeleteSubscriptionsRequest::binary_encoding_id;

} // namespace

TEST_CASE("service table: a request that is not of Part 4 takes no other's place")
{
    const std::uint32_t id = GENERATE(std::uint32_t{1}, // before all, between them, after them
                                      ReadRequest::binary_encoding_id + 1, last_known + 10'000);
    ServiceTable table;
    const std::array own{Service{id, Need::Nothing, Lasts::ToTheEnd, &serve}};
    CHECK(table.find(NodeId{0, id}) == nullptr);
    table.add(own);
    REQUIRE(table.find(NodeId{0, id}) != nullptr);
    CHECK(table.find(NodeId{0, id})->run == &serve);
    for (const std::uint32_t known : {ReadRequest::binary_encoding_id, last_known}) {
        REQUIRE(table.find(NodeId{0, known}) != nullptr);
        CHECK(table.find(NodeId{0, known})->run == nullptr);
    }
}

TEST_CASE("service table: a service takes the place of what was known of its request")
{
    ServiceTable table;
    const std::array own{
        Service{ReadRequest::binary_encoding_id, Need::Activated, Lasts::WhileRunning, &serve}};
    table.add(own);
    REQUIRE(table.find(NodeId{0, ReadRequest::binary_encoding_id}) != nullptr);
    CHECK(table.find(NodeId{0, ReadRequest::binary_encoding_id})->run == &serve);
    CHECK(table.find(NodeId{1, ReadRequest::binary_encoding_id}) == nullptr);
}

} // namespace service_table_test
