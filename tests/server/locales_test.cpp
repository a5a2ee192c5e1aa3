#include <catch2/catch.hpp>

#include <busbar/types/attribute.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/view.hpp>

#include "subscription_fixture.hpp"

namespace locales_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::uint32_t display_name_attribute = 4;
constexpr std::uint32_t value_attribute = 13;

/// Has the client's session, of "operator", read in these locales from now on.
StatusCode activate(TestClient& client, const Array<String>& locales)
{
    ActivateSessionRequest request;
    request.client_signature = client.signature();
    request.user_identity_token = client.user("operator", "operator-secret");
    request.locale_ids = locales;
    return client.take_activate(client.send(std::move(request)));
}

/// A Variable whose DisplayName and value have a German text, and clients of several languages.
struct Locales : SubscriptionFixture {
    Locales()
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::LocalizedText};
        variable.access_level = model::Access::ReadWrite;
        variable.value = Variant{LocalizedText{"en", "on"}};
        state = add_variable("State", variable);
        auto& space = server.address_space();
        REQUIRE(space.set_text(space.find(state), AttributeId::DisplayName,
                               Variant{LocalizedText{"de", "Zustand"}}));
    }
    [[nodiscard]] TestClient in(const Array<String>& locales)
    {
        TestClient client = connect("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
        REQUIRE(client.create_session());
        REQUIRE(activate(client, locales) == status::Good);
        return client;
    }
    [[nodiscard]] LocalizedText read(TestClient& client, std::uint32_t attribute)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = state;
        request.nodes_to_read[0].attribute_id = attribute;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0].value.value_or(LocalizedText{});
    }
    StatusCode write(const char* locale, const char* text)
    {
        auto client = log_in_as("operator");
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = state;
        request.nodes_to_write[0].attribute_id = value_attribute;
        request.nodes_to_write[0].value.value =
            Variant{LocalizedText{String{locale}, String{text}}};
        const auto response = client.call<WriteResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }

    NodeId state;
};

} // namespace

TEST_CASE_METHOD(Locales, "a session reads and browses in its locale (Part 4, 5.4)")
{
    auto german = in({"de-CH", "en"});
    auto other = in({"fr"});
    CHECK(read(german, display_name_attribute) == LocalizedText{"de", "Zustand"});
    CHECK(read(other, display_name_attribute) == LocalizedText{"State"});
    const auto browsed = [&](TestClient& client) {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = NodeId{0, id::ObjectsFolder};
        request.nodes_to_browse[0].result_mask = 63;
        const auto response = client.call<BrowseResponse>(request);
        REQUIRE(response);
        for (const ReferenceDescription& each : response->results[0].references) {
            if (each.node_id.node_id == state) {
                return each.display_name;
            }
        }
        return LocalizedText{};
    };
    CHECK(browsed(german) == LocalizedText{"de", "Zustand"});
    CHECK(browsed(other) == LocalizedText{"State"});
    // A session may change its mind.
    REQUIRE(activate(other, {"de"}) == status::Good);
    CHECK(read(other, display_name_attribute).text == "Zustand");
}

TEST_CASE_METHOD(Locales, "a locale has 32 bytes at most, a longer one is left out")
{
    const std::string longest = "de-CH-1901-" + std::string(21, 'x');
    REQUIRE(longest.size() == 32);
    auto client = in({String{longest}});
    CHECK(read(client, display_name_attribute) == LocalizedText{"de", "Zustand"});
    REQUIRE(activate(client, {String{longest + "x"}, "fr"}) == status::Good);
    CHECK(read(client, display_name_attribute) == LocalizedText{"State"});
}

TEST_CASE_METHOD(Locales, "a Write replaces the text of its locale (Part 4, 5.11.4.1)")
{
    auto english = in({"en"});
    auto german = in({"de"});
    CHECK(write("de", "an") == status::Good);
    CHECK(read(english, value_attribute) == LocalizedText{"en", "on"});
    CHECK(read(german, value_attribute) == LocalizedText{"de", "an"});
    CHECK(write("en", "") == status::Good); // only the German one is left
    CHECK(read(english, value_attribute) == LocalizedText{"de", "an"});
    CHECK(write("", "1") == status::Good);
    CHECK(read(english, value_attribute).text == "an");
    CHECK(write("", "") == status::Good);
    CHECK(read(german, value_attribute).text.empty());
    for (const char* locale : {"xx-ZZ", "e", "mul", "en-"}) {
        CHECK(write(locale, "x") == status::Bad_LocaleNotSupported);
    }
}

TEST_CASE_METHOD(Locales, "LocaleIdArray has the locales of the address space")
{
    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{0, id::Server_ServerCapabilities_LocaleIdArray};
    request.nodes_to_read[0].attribute_id = value_attribute;
    auto client = in({});
    const auto response = client.call<ReadResponse>(request);
    REQUIRE(response);
    const auto* const locales = response->results[0].value.array_if<String>();
    REQUIRE(locales != nullptr);
    CHECK(*locales == Array<String>{"en", "de"});
}

TEST_CASE_METHOD(Locales, "an item tells of its client's locale, with its session or without")
{
    auto german = in({"de"});
    const std::uint32_t subscription = subscribe(german);
    MonitoredItemCreateRequest item = item_request(state);
    item.item_to_monitor.attribute_id = display_name_attribute;
    REQUIRE(monitor(german, subscription, item).status_code == status::Good);
    CHECK(next_data(german, std::chrono::milliseconds{100}).at(0).value.value ==
          Variant{LocalizedText{"de", "Zustand"}});
    // Without its session it goes on in German: nothing has changed for who takes it over.
    CloseSessionRequest close;
    close.delete_subscriptions = false;
    REQUIRE(german.status_of<CloseSessionResponse>(close) == status::Good);
    advance(std::chrono::milliseconds{200});
    auto heir = in({"de"});
    REQUIRE(transfer(heir, subscription).status_code == status::Good);
    CHECK(next_data(heir, std::chrono::milliseconds{100}).empty());
    REQUIRE(activate(heir, {"en"}) == status::Good);
    CHECK(next_data(heir, std::chrono::milliseconds{200}).at(0).value.value ==
          Variant{LocalizedText{"State"}});
}

} // namespace locales_test
