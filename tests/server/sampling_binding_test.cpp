#include <catch2/catch.hpp>

#include <optional>

#include <busbar/server/process_image.hpp>

#include "server/rights/node_rights.hpp"
#include "subscription_fixture.hpp"
#include "support/slow_server.hpp"

namespace sampling_binding_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration sample = 50ms;
constexpr std::uint32_t variable_count = 20;

/// Counts how often it is looked where a value of the tests' own namespace comes from.
class CountsLooks final : public server::AccessControl {
public:
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId&) const override
    {
        return true;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId& node,
                                                 std::uint8_t level) const override
    {
        looks += node.namespace_index() == 1 ? 1 : 0;
        return level;
    }

    mutable int looks{0};
};

struct BindingParts {
    BindingParts()
    {
        server::ImageLayout layout;
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            static_cast<void>(layout.add({BuiltInType::Int32, {}}));
        }
        image = server::ProcessImage::create(std::move(layout));
        image_source.emplace(image);
        for (std::uint32_t i = 0; i < 2 * variable_count; ++i) {
            static_cast<void>(memory.add(Variant{static_cast<std::int32_t>(i)}));
        }
    }
    void scan()
    {
        image->begin_scan();
        image->publish(today);
    }

    CountsLooks control;
    CountingWaker waker_of_source;
    FixedWallClock source_clock;
    server::MemorySource memory{source_clock};
    std::shared_ptr<server::ProcessImage> image;
    std::optional<server::ImageSource> image_source;
};

/// Items of twenty variables that a memory or an image has.
struct BindingFixture : BindingParts, ServerFixture {
    BindingFixture() : ServerFixture{waker_of_source, insecure_config(), &control}
    {
        sources[0] = server.add_source(memory);
        sources[1] = server.add_source(*image_source);
        subscription = client
                           .call<CreateSubscriptionResponse>(
                               SubscriptionFixture::subscription_request(3'600'000))
                           .value()
                           .subscription_id;
    }
    void add(std::uint32_t number)
    {
        model::NewNode node;
        node.id = NodeId{1, number};
        node.browse_name = QualifiedName{1, String{std::to_string(number)}};
        node.parent = space().find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.source = sources[kind];
        variable.handle = number;
        REQUIRE(space().add_variable(node, variable));
    }
    void monitor_all(double interval)
    {
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            add(i);
            auto item = SubscriptionFixture::item_request(NodeId{1, i}, i);
            item.requested_parameters.sampling_interval = interval;
            REQUIRE(SubscriptionFixture::monitor(client, subscription, item).status_code ==
                    status::Good);
        }
        static_cast<void>(looks_at_next_sample());
    }
    int looks_at_next_sample()
    {
        control.looks = 0;
        scan();
        server.handle_completions(now);
        advance(sample);
        return control.looks;
    }
    [[nodiscard]] model::AddressSpace& space() { return server.address_space(); }
    [[nodiscard]] model::NodeIndex node(std::uint32_t number) { return space().find({1, number}); }

    int kind{0};
    std::uint32_t sources[2]{};
    TestClient client{log_in()};
    std::uint32_t subscription{0};
};

} // namespace

TEST_CASE_METHOD(BindingFixture, "whoever connects has nobody's items bound anew")
{
    kind = GENERATE(0, 1);
    monitor_all(GENERATE(50.0, 0.0));
    CHECK(looks_at_next_sample() == 0);
    for (int i = 0; i < 3; ++i) {
        TestClient other = log_in();
        CHECK(looks_at_next_sample() == 0);
        CHECK(other.close_session() == status::Good);
        CHECK(looks_at_next_sample() == 0);
    }
    const auto folder = space().find(id::ObjectsFolder);
    REQUIRE(space().add_reference(folder, NodeId{0, id::HasEventSource}, node(1)));
    CHECK(looks_at_next_sample() == 0);
}

TEST_CASE_METHOD(BindingFixture, "only the items of a node that changed are bound anew")
{
    kind = GENERATE(0, 1);
    monitor_all(GENERATE(50.0, 0.0));
    space().bind(node(3), sources[0], variable_count);
    CHECK(looks_at_next_sample() == 1);
    space().bind(node(3), sources[1], 3);
    CHECK(looks_at_next_sample() == 1);
    space().set_access_level(node(4), model::Access::ReadWrite);
    space().set_access_level(node(4), model::Access::Read);
    CHECK(looks_at_next_sample() == 1);
    space().set_node_access(node(5), {});
    CHECK(looks_at_next_sample() == 1);
    CHECK(looks_at_next_sample() == 0);
    // AccessRestrictions of a namespace are those of all its nodes.
    space().set_namespace_restrictions(1, 0);
    CHECK(looks_at_next_sample() == variable_count);
    CHECK(looks_at_next_sample() == 0);
}

TEST_CASE_METHOD(BindingFixture, "an item finds the node that comes in place of its own")
{
    kind = GENERATE(0, 1);
    monitor_all(GENERATE(50.0, 0.0));
    REQUIRE(space().remove(node(3)));
    CHECK(looks_at_next_sample() == 0); // there is nothing to look at
    add(3);
    CHECK(looks_at_next_sample() >= 1);
    static_cast<void>(looks_at_next_sample());
    CHECK(looks_at_next_sample() == 0);
    space().bind(node(3), sources[0], variable_count);
    CHECK(looks_at_next_sample() == 1);
}

TEST_CASE_METHOD(BindingFixture, "who loses a role with its node loses what it let him monitor")
{
    kind = GENERATE(0, 1);
    users.everybody.roles = {"Fitter"};
    client = log_in();
    subscription =
        client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
            .value()
            .subscription_id;
    model::NewNode role;
    role.id = NodeId{1, "role"};
    role.browse_name = QualifiedName{1, "Fitter"};
    role.parent = space().find(id::ObjectsFolder);
    REQUIRE(space().add_object(role));
    add(3);
    model::NodeAccess access;
    RolePermissionType permission;
    permission.role_id = role.id;
    permission.permissions = PermissionType{server::detail::all_permissions};
    access.role_permissions.push_back(permission);
    space().set_node_access(node(3), access);
    scan();
    const auto item = SubscriptionFixture::item_request(NodeId{1, 3U});
    REQUIRE(SubscriptionFixture::monitor(client, subscription, item).status_code == status::Good);
    const auto published = [&] {
        const std::uint32_t request = SubscriptionFixture::publish(client);
        static_cast<void>(looks_at_next_sample());
        advance(sample);
        const auto response = SubscriptionFixture::take(client, request);
        const auto data = SubscriptionFixture::data(response ? response->notification_message
                                                             : NotificationMessage{});
        return data.empty() ? StatusCode{status::Bad_NoData} : data.back().value.status;
    };
    CHECK_FALSE(published().is_bad());
    CHECK(looks_at_next_sample() == 0);
    REQUIRE(space().remove(space().find(role.id)));
    CHECK(published() == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(BindingFixture, "items that are gone watch nothing")
{
    kind = GENERATE(0, 1);
    monitor_all(50);
    REQUIRE(SubscriptionFixture::remove(client, subscription) == status::Good);
    for (std::uint32_t i = 0; i < variable_count; ++i) {
        space().bind(node(i), sources[0], 0);
        REQUIRE(space().remove(node(i)));
    }
    CHECK(looks_at_next_sample() == 0);
}

} // namespace sampling_binding_test
