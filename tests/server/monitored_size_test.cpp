#include <catch2/catch.hpp>

#include "subscription_fixture.hpp"

namespace monitored_size_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Values that count as their handles; there is none with handle 0.
class SizedSource final : public server::DataSource {
public:
    server::DataSourceOptions options() const override
    {
        server::DataSourceOptions options;
        options.max_monitored_size = 100;
        return options;
    }
    Result<std::size_t> monitored_size(std::uint64_t handle) const override
    {
        if (handle == 0) {
            return fail(status::Bad_NotSupported);
        }
        return static_cast<std::size_t>(handle);
    }
    void read(server::ReadBatch batch) override
    {
        ++(batch.is_sample() ? samples : reads);
        for (auto& slot : batch.results()) {
            slot = DataValue{Variant{1}};
        }
        batch.complete();
    }

    int samples{0};
    int reads{0};
};

struct SizeParts {
    SizedSource sized;
};

struct SizeFixture : SizeParts, SubscriptionFixture {
    NodeId add(const char* name, std::uint64_t size)
    {
        model::NewVariable variable;
        variable.source = index;
        variable.handle = size;
        variable.data_type = NodeId{0, id::Int32};
        return SubscriptionFixture::add_variable(name, variable);
    }
    MonitoredItemCreateResult monitor(const NodeId& node)
    {
        return SubscriptionFixture::monitor(client, id, item_request(node));
    }
    StatusCode remove_item(std::uint32_t item)
    {
        DeleteMonitoredItemsRequest request;
        request.subscription_id = id;
        request.monitored_item_ids = {item};
        return client.call<DeleteMonitoredItemsResponse>(request)->results[0];
    }

    std::uint32_t index{server.add_source(sized)};
    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
};

} // namespace

TEST_CASE_METHOD(SizeFixture, "items of a source count as it says, up to its limit")
{
    const NodeId half = add("half", 50);
    const NodeId more = add("more", 51);
    const auto first = monitor(half);
    CHECK(first.status_code == status::Good);
    CHECK(monitor(more).status_code == status::Bad_TooManyMonitoredItems);
    CHECK(monitor(half).status_code == status::Good);
    CHECK(monitor(add("one", 1)).status_code == status::Bad_TooManyMonitoredItems);
    REQUIRE(remove_item(first.monitored_item_id) == status::Good);
    CHECK(monitor(more).status_code == status::Bad_TooManyMonitoredItems);
    CHECK(monitor(half).status_code == status::Good);
    REQUIRE(remove(client, id) == status::Good);
    id = subscribe(client);
    CHECK(monitor(more).status_code == status::Good);
}

TEST_CASE_METHOD(SizeFixture, "a source refuses items with a status of its own")
{
    CHECK(monitor(add("none", 0)).status_code == status::Bad_NotSupported);
    CHECK(monitor(add("most", 100)).status_code == status::Good);
}

TEST_CASE_METHOD(SizeFixture, "a source can tell samples from Reads")
{
    const NodeId node = add("value", 1);
    REQUIRE(monitor(node).status_code == status::Good);
    CHECK(sized.samples == 1);
    CHECK(sized.reads == 0);
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.nodes_to_read = {{node, 13, {}, {}}};
    REQUIRE(client.call<ReadResponse>(request));
    CHECK(sized.samples == 1);
    CHECK(sized.reads == 1);
}

} // namespace monitored_size_test
