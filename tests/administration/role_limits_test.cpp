#include <busbar/administration/role_list.hpp>

#include <span>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include <busbar/core/status_codes.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace role_limits_test {

// What a RoleList refuses: rules and files beyond its limits, or that make no sense.

using namespace busbar;
using administration::RoleList;

namespace {

using Criteria = IdentityCriteriaType;

IdentityMappingRuleType rule(Criteria type, const char* criteria)
{
    return {type, String{criteria}};
}

template <typename T>
std::string_view status_of(const Checked<T>& result)
{
    return result ? "Good" : name(result.error().status);
}

struct Limited {
    Limited() { REQUIRE(list.load()); }

    storage::MemoryStorage storage;
    RoleList list{storage, "roles.json", {.max_roles = 10, .max_rules = 2, .max_text = 16}};
};

} // namespace

TEST_CASE_METHOD(Limited, "roles: a file beyond the limits is refused with its place")
{
    const auto problem = [&](const std::string& document) {
        REQUIRE(
            storage.replace("roles.json", std::as_bytes(std::span{document}), FileAccess::Owner));
        const auto loaded = list.load();
        CHECK(list.roles().size() == 9);
        return loaded ? "Good" : busbar::text(loaded.error());
    };
    const auto in_role = [&](const std::string& members, const char* name = "a") {
        return problem(R"({"version":1,"roles":[{"name":")" + std::string{name} +
                       R"(","namespace_uri":"","applications_exclude":true,)" + members + "}]}");
    };
    const std::string place = "memory:roles.json: roles[0].";
    const std::string open = R"("endpoints_exclude":true,"identities":[],)";
    const std::string endpoint = R"({"endpoint_url":"","security_mode":1,"security_policy_uri":"",)"
                                 R"("transport_profile_uri":""})";
    CHECK(problem(R"({"version":1,"roles":7})") ==
          "memory:roles.json: roles: found 7, expected a list");
    CHECK(problem(R"({"version":1,"roles":[{"name":"","namespace_uri":""}]})") ==
          place + "name: found \"\", expected a text");
    CHECK(problem(R"({"version":1,"roles":[{"name":"a"}]})") ==
          place + "namespace_uri: found nothing, expected a text");
    CHECK(in_role(R"("endpoints_exclude":7)") ==
          place + "endpoints_exclude: found 7, expected true or false");
    CHECK(in_role(R"("endpoints_exclude":true)") ==
          place + "identities: found nothing, expected a list within the limit");
    CHECK(in_role(R"("endpoints_exclude":true,"identities":[{"criteria_type":1}])") ==
          place + "identities: found a list, expected a list of rules");
    CHECK(in_role(open + R"("applications":"urn:a")") ==
          place + "applications: found \"urn:a\", expected a list within the limit");
    CHECK(in_role(open + R"("applications":["a","b","c"])") ==
          place + "applications: found a list, expected a list within the limit");
    CHECK(in_role(open + R"("applications":["a",7])") ==
          place + "applications: found a list, expected a list of ApplicationUris");
    const std::string none = open + R"("applications":[],"endpoints":[)";
    CHECK(in_role(none + endpoint + "," + endpoint + "," + endpoint + "]") ==
          place + "endpoints: found a list, expected a list within the limit");
    for (const std::string& wrong :
         {std::string{"7"}, std::string{R"({"endpoint_url":""})"},
          std::string{R"({"endpoint_url":"","security_mode":4,"security_policy_uri":"",)"
                      R"("transport_profile_uri":""})"},
          std::string{R"({"endpoint_url":"","security_mode":1})"},
          std::string{R"({"endpoint_url":"","security_mode":1,"security_policy_uri":""})"}}) {
        CHECK(in_role(none + wrong + "]") ==
              place + "endpoints: found a list, expected a list of endpoints");
    }
    const std::string whole = R"("namespace_uri":"","applications_exclude":true,)" + none + "]}";
    CHECK(problem(R"({"version":1,"roles":[{"name":"a",)" + whole + R"(,{"name":"b",)" + whole +
                  "]}") ==
          "memory:roles.json: roles[1].name: found \"b\", expected no more roles than the limit");
    REQUIRE(storage.remove("roles.json"));
    REQUIRE(storage.make_folder("roles.json", FileAccess::Owner));
    CHECK_FALSE(list.load());
}

TEST_CASE_METHOD(Limited, "roles: names beyond the limits, or that are no text, are refused")
{
    const std::string longest(16, 'x');
    CHECK(status_of(list.add(longest + "x", "")) == "Bad_InvalidArgument");
    CHECK(status_of(list.add("Fitter", longest + "x")) == "Bad_InvalidArgument");
    CHECK(status_of(list.add("Fitter", "urn:\xFF")) == "Bad_InvalidArgument");
    REQUIRE(list.add(longest, longest));
    CHECK(status_of(list.add("Fitter", "")) == "Bad_ResourceUnavailable");
    CHECK(status_of(list.remove("Fitter")) == "Bad_NodeIdUnknown");
}

TEST_CASE_METHOD(Limited, "roles: applications beyond the limits, or that are none, are refused")
{
    const std::string longest(16, 'x');
    const char* const role = "Operator";
    CHECK(status_of(list.add_application("Fitter", "urn:a")) == "Bad_NotFound");
    CHECK(status_of(list.add_application(role, "")) == "Bad_InvalidArgument");
    CHECK(status_of(list.add_application(role, longest + "x")) == "Bad_InvalidArgument");
    CHECK(status_of(list.add_application(role, "urn:\xFF")) == "Bad_InvalidArgument");
    CHECK(status_of(list.remove_application(role, "urn:a")) == "Bad_NotFound");
    REQUIRE(list.add_application(role, "urn:a"));
    REQUIRE(list.add_application(role, longest));
    CHECK(status_of(list.add_application(role, "urn:b")) == "Bad_ResourceUnavailable");
    CHECK(status_of(list.add_application(role, "urn:a")) == "Bad_AlreadyExists");
}

TEST_CASE_METHOD(Limited, "roles: identities beyond the limits, or that make no sense, are refused")
{
    const char* const role = "Operator";
    for (const char* name : {"a", "b"}) {
        REQUIRE(list.add_identity(role, rule(Criteria::UserName, name)));
    }
    CHECK(status_of(list.add_identity(role, rule(Criteria::UserName, "c"))) ==
          "Bad_ResourceUnavailable");
    CHECK(status_of(list.remove_identity(role, rule(Criteria::UserName, "c"))) == "Bad_NotFound");
    CHECK(status_of(list.remove_identity("Fitter", rule(Criteria::UserName, "a"))) ==
          "Bad_NotFound");
    for (const char* subject : {"", "CN", "=x", "CN=", "CN=a/b"}) {
        CHECK(status_of(list.add_identity("Engineer", rule(Criteria::X509Subject, subject))) ==
              "Bad_InvalidArgument");
    }
}

TEST_CASE_METHOD(Limited, "roles: endpoints beyond the limits, or that make no sense, are refused")
{
    const char* const role = "Operator";
    EndpointType endpoint;
    CHECK(status_of(list.add_endpoint("Fitter", endpoint)) == "Bad_NotFound");
    CHECK(status_of(list.remove_endpoint("Fitter", endpoint)) == "Bad_NotFound");
    CHECK(status_of(list.remove_endpoint(role, endpoint)) == "Bad_NotFound");
    endpoint.endpoint_url = String{std::string(17, 'x')};
    CHECK(status_of(list.add_endpoint(role, endpoint)) == "Bad_InvalidArgument");
    endpoint.endpoint_url = {};
    for (const std::int32_t mode : {-1, 4}) {
        endpoint.security_mode = static_cast<MessageSecurityMode>(mode);
        CHECK(status_of(list.add_endpoint(role, endpoint)) == "Bad_InvalidArgument");
    }
    endpoint.security_mode = MessageSecurityMode::Sign;
    endpoint.security_policy_uri = "\xFF";
    CHECK(status_of(list.add_endpoint(role, endpoint)) == "Bad_InvalidArgument");
    endpoint.security_policy_uri = {};
    endpoint.transport_profile_uri = "\xFF";
    CHECK(status_of(list.add_endpoint(role, endpoint)) == "Bad_InvalidArgument");
    endpoint.transport_profile_uri = {};
    REQUIRE(list.add_endpoint(role, endpoint));
    endpoint.security_mode = MessageSecurityMode::SignAndEncrypt;
    REQUIRE(list.add_endpoint(role, endpoint));
    endpoint.security_mode = MessageSecurityMode::None;
    CHECK(status_of(list.add_endpoint(role, endpoint)) == "Bad_ResourceUnavailable");
    CHECK(status_of(list.set_applications_exclude("Fitter", false)) == "Bad_NotFound");
    CHECK(status_of(list.set_endpoints_exclude("Fitter", false)) == "Bad_NotFound");
    CHECK(status_of(list.set_endpoints_exclude("Anonymous", false)) == "Bad_RequestNotAllowed");
}

} // namespace role_limits_test
