#include <cstdint>
#include <map>
#include <optional>

#include <busbar/server/process_image.hpp>

#include "failure_cases.hpp"
#include "support/failing_worlds.hpp"

namespace scan_allocation_failure_test {

/// A scan of a process image that finds no memory when items are sampled: no other follows it,
/// and still each item has its value soon after.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t variable_count = 2;
constexpr std::uint32_t longest_text = 150'000;

struct TextParts {
    TextParts()
    {
        server::ImageLayout layout;
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            REQUIRE(layout.add({BuiltInType::String, {}, longest_text}));
        }
        image = server::ProcessImage::create(std::move(layout));
        image_source.emplace(image);
    }
    /// `first` is the first Variable's, unless it is empty.
    void scan(std::string_view text, std::string_view first = {})
    {
        image->begin_scan();
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            REQUIRE(image->memory().set_text(i, i == 0 && !first.empty() ? first : text));
        }
        image->publish(DateTime::from_unix_seconds(1'000));
    }

    std::shared_ptr<server::ProcessImage> image;
    std::optional<server::ImageSource> image_source;
};

/// A client that has had the first values of items, two of each Variable.
class ScanWorld : public TextParts, public FailureFixture {
public:
    explicit ScanWorld(double interval)
    {
        const std::uint32_t source = server.add_source(*image_source);
        CreateMonitoredItemsRequest request;
        request.subscription_id = subscription = subscribe();
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            add(i, source);
            for (int twice = 0; twice < 2; ++twice) {
                MonitoredItemCreateRequest item;
                item.item_to_monitor = failing::value_of(NodeId{1, i});
                item.monitoring_mode = MonitoringMode::Reporting;
                item.requested_parameters.client_handle =
                    static_cast<std::uint32_t>(request.items_to_create.size());
                item.requested_parameters.sampling_interval = interval;
                item.requested_parameters.queue_size = 5;
                request.items_to_create.push_back(item);
            }
        }
        scan("a first text that does not fit into a small string");
        const auto made = client.call<CreateMonitoredItemsResponse>(request);
        REQUIRE(made);
        REQUIRE(worst_of(*made) == status::Good);
        REQUIRE(ask(client, failing::publish_something()) == status::Good);
    }

    /// The last value of each item that the next message has.
    [[nodiscard]] std::map<std::uint32_t, Variant> gather()
    {
        std::map<std::uint32_t, Variant> values;
        FailureCase asked = failing::publish_something();
        asked.take = [&](TestClient& from, std::uint32_t id) -> StatusCode {
            const auto response = from.take<PublishResponse>(id);
            if (!response) {
                return response.error();
            }
            for (const ExtensionObject& part : response->notification_message.notification_data) {
                if (const auto* const data = part.get_if<DataChangeNotification>()) {
                    for (const MonitoredItemNotification& one : data->monitored_items) {
                        values[one.client_handle] = one.value.value;
                    }
                }
            }
            return status::Good;
        };
        for (int i = 0; i < 3; ++i) { // a keep-alive may come first
            CHECK(ask(client, asked) == status::Good);
        }
        return values;
    }

    std::uint32_t subscription{0};

private:
    void add(std::uint32_t handle, std::uint32_t source)
    {
        model::NewNode node;
        node.id = NodeId{1, handle};
        node.browse_name = QualifiedName{1, std::to_string(handle).c_str()};
        node.parent = server.address_space().find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.source = source;
        variable.handle = handle;
        variable.data_type = NodeId{0, id::String};
        REQUIRE(server.address_space().add_variable(node, variable));
    }
};

/// False if nothing failed.
bool fail_once(double interval, std::size_t k, std::size_t most)
{
    ScanWorld world{interval};
    const String last{"a second text that does not fit into a small string"};
    fail_allocation(k, most);
    world.scan(last.view());
    world.pass(100ms, world.client);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    CHECK(world.thrown == 0);
    std::map<std::uint32_t, Variant> values = world.gather();
    INFO("interval " << interval << ", allocation " << k << ", " << most << "\n" << world.log.text);
    for (std::uint32_t handle = 0; handle < 2 * variable_count; ++handle) {
        CHECK(values[handle] == Variant{last});
    }
    return has_failed;
}

/// False if nothing failed when another item was created, whose first value no scan brings.
bool fail_first_sample(std::size_t k, std::size_t most)
{
    constexpr std::uint32_t new_handle = 9;
    ScanWorld world{0};
    CreateMonitoredItemsRequest request = FailureFixture::items_request(world.subscription);
    request.items_to_create.resize(1);
    request.items_to_create[0].item_to_monitor = failing::value_of(NodeId{1, 0U});
    request.items_to_create[0].requested_parameters.client_handle = new_handle;
    request.items_to_create[0].requested_parameters.sampling_interval = 0;
    const auto [answer, has_failed] =
        world.attempt(asking<CreateMonitoredItemsResponse>(request), k, most);
    INFO("allocation " << k << ", " << most << ": " << name(answer) << "\n" << world.log.text);
    if (answer == status::Good) {
        CHECK_FALSE(world.gather()[new_handle].is_null());
    }
    return has_failed;
}

} // namespace

TEST_CASE("the first value comes when a new item has found no memory for it")
{
    const std::size_t most = GENERATE(1U, 1'000'000U);
    check_failing_worlds("CreateMonitoredItems",
                         [&](std::size_t k) { return fail_first_sample(k, most); });
}

TEST_CASE("the last value comes when a scan has found no memory")
{
    const double interval = GENERATE(0.0, 50.0); // each scan, or at times
    const std::size_t most = GENERATE(1U, 1'000'000U);
    check_failing_worlds("a scan", [&](std::size_t k) { return fail_once(interval, k, most); });
}

TEST_CASE("a value that there is no memory for keeps those behind it from nothing")
{
    ScanWorld world{GENERATE(0.0, 50.0)};
    const String last{"a second text that does not fit into a small string"};
    const String large{std::string(longest_text, 'x').c_str()};
    fail_large_allocations(longest_text);
    world.scan(last.view(), large.view());
    world.pass(100ms, world.client);
    std::map<std::uint32_t, Variant> values = world.gather();
    CHECK(values[2] == Variant{last});
    CHECK(values[3] == Variant{last});
    CHECK(values.find(0) == values.end());
    fail_large_allocations(0);
    world.pass(100ms, world.client);
    values = world.gather();
    CHECK(values[0] == Variant{large});
    CHECK(values[1] == Variant{large});
    CHECK(world.thrown == 0);
}

} // namespace scan_allocation_failure_test
