#include <busbar/types/data_types.hpp>
#include <busbar/types/view.hpp>

#include "managed_fixture.hpp"

namespace setting_nodes_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct Settings : ManagedFixture {
    [[nodiscard]] static NodeId node(const std::string& name)
    {
        return NodeId{1, String{"Settings" + (name.empty() ? name : "." + name)}};
    }
    static DataValue get(TestClient& client, const std::string& name)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node(name);
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    /// The results of one Write.
    std::vector<std::string_view> write(TestClient& client,
                                        const std::vector<std::pair<std::string, Variant>>& set)
    {
        WriteRequest request;
        for (const auto& [name, value] : set) {
            WriteValue each;
            each.node_id = node(name);
            each.attribute_id = 13;
            each.value.value = value;
            request.nodes_to_write.push_back(each);
        }
        const auto sent = client.send(request);
        complete();
        const auto response = client.take<WriteResponse>(sent);
        REQUIRE(response);
        std::vector<std::string_view> names;
        for (const StatusCode result : response->results) {
            names.push_back(busbar::name(result));
        }
        return names;
    }
    using Results = std::vector<std::string_view>;
};

} // namespace

TEST_CASE_METHOD(Settings, "settings: are Variables with default, range and unit")
{
    auto admin = log_in();
    CHECK(get(admin, "limits.sessions").value == Variant{std::int64_t{100}});
    CHECK(get(admin, "limits.sessions").source_timestamp == wall_clock.now());
    CHECK(get(admin, "limits.sessions.Default").value == Variant{std::int64_t{100}});
    CHECK(get(admin, "limits.sessions.IsChanged").value == Variant{false});
    CHECK(get(admin, "server.port.WaitsForRestart").value == Variant{false});
    CHECK(get(admin, "server.host_names").value == Variant{Array<String>{"press-4"}});
    const auto range = get(admin, "limits.sessions.InstrumentRange").value;
    REQUIRE(range.get_if<ExtensionObject>() != nullptr);
    const auto decoded = binary::structure_of<Range>(*range.get_if<ExtensionObject>());
    REQUIRE(decoded);
    CHECK(*decoded == Range{1, 1'000});
    const auto unit = get(admin, "limits.login_lock_ms.EngineeringUnits").value;
    REQUIRE(unit.get_if<ExtensionObject>() != nullptr);
    const auto information = binary::structure_of<EUInformation>(*unit.get_if<ExtensionObject>());
    REQUIRE(information);
    CHECK(information->unit_id == 4'403'766); // C26 of UNECE Recommendation 20
    CHECK(get(admin, "limits.login_lock_ms.InstrumentRange").status == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(Settings, "settings: one Write is a set, whole or not at all")
{
    auto admin = log_in();
    CHECK(write(admin, {{"limits.sessions", Variant{std::int64_t{7}}},
                        {"server.port", Variant{std::int64_t{4'841}}}}) == Results{"Good", "Good"});
    CHECK(get(admin, "limits.sessions").value == Variant{std::int64_t{7}});
    CHECK(get(admin, "limits.sessions.IsChanged").value == Variant{true});
    CHECK(get(admin, "limits.sessions.WaitsForRestart").value == Variant{false});
    CHECK(get(admin, "server.port.WaitsForRestart").value == Variant{true});
    CHECK(write(admin, {{"limits.sessions", Variant{std::int64_t{8}}},
                        {"limits.login_lock_ms", Variant{"soon"}}}) ==
          Results{"Good", "Bad_TypeMismatch"}); // what does not fit the Variable is in no set
    CHECK(write(admin, {{"server.port", Variant{std::int64_t{4'842}}},
                        {"limits.sessions", Variant{std::int64_t{0}}}}) ==
          Results{"Bad_OutOfRange", "Bad_OutOfRange"});
    CHECK(get(admin, "server.port").value == Variant{std::int64_t{4'841}});
    CHECK(log.text.find("limits.sessions: found 0, expected 1 to 1000") != std::string::npos);
    CHECK(write(admin, {{"limits.sessions", Variant{std::int64_t{13}}}}) ==
          Results{"Bad_InvalidArgument"});
    administration::SettingList again{
        storage, "settings.json", {settings.settings().begin(), settings.settings().end()}};
    REQUIRE(again.load());
    CHECK(again.changes() == owner.applied);
}

TEST_CASE_METHOD(Settings, "settings: a refusal of the time is told from one of the value")
{
    auto admin = log_in();
    owner.refuses_port = true;
    CHECK(write(admin, {{"server.port", Variant{std::int64_t{4'841}}}}) ==
          Results{"Bad_InvalidState"});
    CHECK(log.text.find("server.port: cannot change now") != std::string::npos);
    CHECK(get(admin, "server.port.IsChanged").value == Variant{false});
    CHECK(owner.applied.empty());
}

TEST_CASE_METHOD(Settings, "settings: the Method Set tells the reason")
{
    auto admin = log_in();
    const auto set = [&](Array<String> names, Array<Variant> values) {
        return call(admin, node(""), node("Set"),
                    {Variant{std::move(names)}, Variant{std::move(values)}});
    };
    auto result = set({"limits.sessions", "server.port"},
                      {Variant{std::int64_t{9}}, Variant{std::int64_t{4'841}}});
    REQUIRE(result.status_code == status::Good);
    CHECK(result.output_arguments[0] == Variant{true});
    CHECK(owner.applied.size() == 2);
    result = set({"limits.sessions", "limits.none"}, {Variant{}, Variant{true}});
    REQUIRE(result.status_code == status::Good);
    CHECK(result.output_arguments[0] == Variant{false});
    CHECK(result.output_arguments[1].get_if<String>()->view().find("limits.none: there is no") ==
          0);
    CHECK(owner.applied.size() == 2);
    result = set({"limits.sessions"}, {Variant{}}); // as without changes
    CHECK(result.output_arguments[0] == Variant{true});
    CHECK(get(admin, "limits.sessions").value == Variant{std::int64_t{100}});
    CHECK(set({"limits.sessions"}, {}).status_code == status::Bad_InvalidArgument);
    CHECK(log.text.find("SettingsChanged by user \"admin\"") != std::string::npos);
}

TEST_CASE_METHOD(Settings, "settings: who may see them, and over which channel")
{
    REQUIRE(user_list.add({"pat", {}, 0, {}, {"Engineer"}}, "patience is all", random));
    REQUIRE(user_list.add({"kim", {}, 0, {}, {"Observer"}}, "kim's pass phrase", random));
    auto pat = log_in("pat", "patience is all");
    CHECK(get(pat, "limits.sessions").value == Variant{std::int64_t{100}});
    CHECK(write(pat, {{"limits.sessions", Variant{std::int64_t{7}}}}) ==
          Results{"Bad_UserAccessDenied"});
    CHECK(call(pat, node(""), node("Set"), {Variant{Array<String>(0)}, Variant{Array<Variant>(0)}})
              .status_code == status::Bad_UserAccessDenied);
    auto kim = log_in("kim", "kim's pass phrase");
    CHECK(get(kim, "limits.sessions").status == status::Bad_NodeIdUnknown);
    auto signed_only = log_in("admin", "admin-secret!", MessageSecurityMode::Sign);
    CHECK(get(signed_only, "limits.sessions").status == status::Bad_SecurityModeInsufficient);
}

TEST_CASE_METHOD(Settings, "settings: lists of names and values that do not match set nothing")
{
    auto admin = log_in();
    const auto set = [&](Variant names, Variant values) {
        return name(
            call(admin, node(""), node("Set"), {std::move(names), std::move(values)}).status_code);
    };
    const Variant two{Array<String>{"limits.sessions", "server.port"}};
    const Variant one_value{Array<Variant>{Variant{std::int64_t{7}}}};
    CHECK(set(two, one_value) == "Bad_InvalidArgument");
    CHECK(set(two, Variant{}) == "Bad_InvalidArgument");
    CHECK(set(Variant{}, one_value) == "Bad_InvalidArgument");
    CHECK(set(Variant{String{"limits.sessions"}}, one_value) == "Bad_InvalidArgument");
    CHECK(settings.changes().empty());
    CHECK(set(Variant{Array<String>{"limits.sessions"}}, one_value) == "Good");
    CHECK(settings.changes().size() == 1);
}

TEST_CASE_METHOD(Settings, "settings: those of security are SecurityAdmin's")
{
    REQUIRE(user_list.add({"config", {}, 0, {}, {"ConfigureAdmin"}}, "patience is all", random));
    REQUIRE(user_list.add({"op", {}, 0, {}, {"Operator"}}, "patience is all", random));
    auto admin = log_in();
    auto config = log_in("config", "patience is all");
    auto op = log_in("op", "patience is all");
    const auto set = [&](TestClient& client, const char* other, Variant value) {
        Array<Variant> values;
        values.push_back(Variant{"read"});
        values.push_back(std::move(value));
        return name(call(client, node(""), node("Set"),
                         {Variant{Array<String>{"users.anonymous", other}}, Variant{values}})
                        .status_code);
    };
    CHECK(get(config, "users.anonymous").value == Variant{"no"});
    CHECK(get(op, "users.anonymous").status == status::Bad_NodeIdUnknown);
    CHECK(get(op, "users.anonymous.Default").status == status::Bad_NodeIdUnknown);
    CHECK(get(op, "server.port").value == Variant{std::int64_t{4'840}});
    CHECK(write(config, {{"users.anonymous", Variant{"read"}},
                         {"server.port", Variant{std::int64_t{4'841}}}}) ==
          Results{"Bad_UserAccessDenied", "Good"});
    CHECK(set(config, "server.port", Variant{std::int64_t{4'842}}) == "Bad_UserAccessDenied");
    CHECK(get(admin, "users.anonymous").value == Variant{"no"});
    CHECK(get(admin, "server.port").value == Variant{std::int64_t{4'841}});
    CHECK(set(admin, "server.port", Variant{std::int64_t{4'842}}) == "Good");
    CHECK(get(admin, "users.anonymous").value == Variant{"read"});
}

} // namespace setting_nodes_test
