#include <busbar/administration/role_list.hpp>

#include <catch2/catch.hpp>

#include <busbar/administration/configured_users.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/storage_gate.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace role_list_test {

using namespace busbar;
using administration::RoleList;
using administration::RoleRules;
using server::RoleQuestion;
using server::UserIdentity;

namespace {

using Names = std::vector<std::string>;
using Criteria = IdentityCriteriaType;

IdentityMappingRuleType rule(Criteria type, const char* criteria = "")
{
    return {type, String{criteria}};
}

template <typename T>
std::string_view status_of(const Checked<T>& result)
{
    return result ? "Good" : name(result.error().status);
}

UserIdentity pat()
{
    return {UserTokenType::UserName, "pat"};
}

UserIdentity certified(const char* subject)
{
    UserIdentity user{UserTokenType::Certificate, subject};
    user.thumbprint = "0123456789ABCDEF0123456789ABCDEF01234567";
    return user;
}

struct Fixture {
    Fixture() { REQUIRE(list.load()); }

    [[nodiscard]] Names roles(const UserIdentity& user, bool is_trusted = false,
                              const char* uri = "urn:client")
    {
        return list
            .roles_of({.user = user,
                       .application_uri = uri,
                       .is_trusted = is_trusted,
                       .endpoint_url = "opc.tcp://plc:4840",
                       .security_mode =
                           is_trusted ? MessageSecurityMode::Sign : MessageSecurityMode::None,
                       .security_policy_uri =
                           is_trusted ? "http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256"
                                      : "http://opcfoundation.org/UA/SecurityPolicy#None"})
            .roles;
    }
    [[nodiscard]] Names stored(std::string_view role)
    {
        RoleList again{storage, "roles.json"};
        REQUIRE(again.load());
        const RoleRules* const found = again.find(role);
        Names criteria;
        for (const auto& one :
             found != nullptr ? found->identities : std::vector<IdentityMappingRuleType>{}) {
            criteria.push_back(one.criteria.str());
        }
        return criteria;
    }

    storage::MemoryStorage storage;
    administration::ConfiguredUsers configured;
    RoleList list{storage, "roles.json", {}, &configured};
};

} // namespace

TEST_CASE_METHOD(Fixture, "roles: the well-known ones are there, without rules of their own",
                 "[unit:Security Role Well Known]")
{
    CHECK(list.roles().size() == 9);
    CHECK(roles(pat()).empty());
    CHECK(roles(pat(), true) == Names{"TrustedApplication"});
    CHECK(list.roles_of({.user = pat()}).access_level_mask == 0);
}

TEST_CASE_METHOD(Fixture, "roles: each kind of rule (Part 18, 4.4.3 and 4.4.4)",
                 "[unit:Security Role Server Base][unit:Security Role Server Base 2]")
{
    const auto gives = [&](const IdentityMappingRuleType& wanted, const UserIdentity& user,
                           bool is_trusted = false) {
        REQUIRE(list.add_identity("Observer", wanted));
        const Names found = roles(user, is_trusted);
        const bool is_given = std::find(found.begin(), found.end(), "Observer") != found.end();
        REQUIRE(list.remove_identity("Observer", wanted));
        return is_given;
    };
    const UserIdentity anonymous;
    UserIdentity issued{UserTokenType::IssuedToken, "pat"};
    issued.claimed_roles = {"line 3"};
    CHECK(gives(rule(Criteria::UserName, "pat"), pat()));
    CHECK_FALSE(gives(rule(Criteria::UserName, "sam"), pat()));
    CHECK_FALSE(gives(rule(Criteria::UserName, "pat"), issued));
    CHECK_FALSE(gives(rule(Criteria::UserName, "pat"), certified("pat")));
    const char* const thumbprint = "0123456789ABCDEF0123456789ABCDEF01234567";
    CHECK(gives(rule(Criteria::Thumbprint, thumbprint), certified("CN=Pat")));
    CHECK_FALSE(gives(rule(Criteria::Thumbprint, "00000000000000000000ABCDEF0123456789ABCD"),
                      certified("CN=Pat")));
    CHECK(gives(rule(Criteria::Role, "line 3"), issued));
    CHECK_FALSE(gives(rule(Criteria::Role, "line 4"), issued));
    CHECK(gives(rule(Criteria::Anonymous), anonymous));
    CHECK_FALSE(gives(rule(Criteria::Anonymous), pat()));
    CHECK(gives(rule(Criteria::AuthenticatedUser), pat()));
    CHECK_FALSE(gives(rule(Criteria::AuthenticatedUser), anonymous));
    CHECK(gives(rule(Criteria::Application, "urn:client"), anonymous, true));
    CHECK_FALSE(gives(rule(Criteria::Application, "urn:client"), anonymous, false)); // unproven
    CHECK_FALSE(gives(rule(Criteria::Application, "urn:other"), anonymous, true));
    CHECK(gives(rule(Criteria::TrustedApplication), anonymous, true));
    CHECK_FALSE(gives(rule(Criteria::TrustedApplication), pat(), false));
    const UserIdentity user = certified(R"(C=DE, O="Works, Ltd", CN=Pat)");
    CHECK(gives(rule(Criteria::X509Subject, "CN=Pat"), user));
    CHECK(gives(rule(Criteria::X509Subject, R"(CN=Pat/O="Works, Ltd")"), user));
    CHECK(gives(rule(Criteria::X509Subject, R"(C="DE"/CN=Pat)"), user));
    CHECK_FALSE(gives(rule(Criteria::X509Subject, "CN=Pat/O=Other"), user));
    CHECK_FALSE(gives(rule(Criteria::X509Subject, "CN=Pa"), user));
    // What a name says in quotes is not a pair.
    CHECK_FALSE(gives(rule(Criteria::X509Subject, "O=Admins"), certified(R"(CN="Pat, O=Admins")")));
}

TEST_CASE_METHOD(Fixture, "roles: rules that are refused (Part 18, 4.4.5)")
{
    const auto add = [&](const IdentityMappingRuleType& wanted, const char* role = "Operator") {
        return std::string{status_of(list.add_identity(role, wanted))};
    };
    CHECK(add(rule(Criteria::UserName)) == "Bad_InvalidArgument");
    CHECK(add(rule(Criteria::UserName, std::string(1'025, 'x').c_str())) == "Bad_InvalidArgument");
    CHECK(add(rule(Criteria::Anonymous, "x")) == "Bad_InvalidArgument");
    CHECK(add(rule(Criteria::Thumbprint, "0123456789abcdef0123456789abcdef01234567")) ==
          "Bad_InvalidArgument");
    CHECK(add(rule(Criteria::X509Subject, "Pat")) == "Bad_InvalidArgument");
    CHECK(add(rule(Criteria{0}, "x")) == "Bad_InvalidArgument");
    CHECK(add(rule(Criteria{99}, "x")) == "Bad_InvalidArgument");
    CHECK(add(rule(Criteria::GroupId, "x")) == "Bad_NotSupported");
    for (const char* role : {"Anonymous", "AuthenticatedUser", "TrustedApplication"}) {
        CHECK(add(rule(Criteria::UserName, "pat"), role) == "Bad_RequestNotAllowed");
    }
    CHECK(add(rule(Criteria::UserName, "pat"), "Nobody") == "Bad_NotFound");
    CHECK(add(rule(Criteria::UserName, "pat")) == "Good");
    CHECK(add(rule(Criteria::UserName, "pat")) == "Bad_AlreadyExists");
    CHECK(status_of(list.remove_identity("Operator", rule(Criteria::UserName, "sam"))) ==
          "Bad_NotFound");
    CHECK(stored("Operator") == Names{"pat"});
}

TEST_CASE_METHOD(Fixture,
                 "roles: applications and endpoints are let in or kept out (Part 18, 4.4.1)")
{
    REQUIRE(list.add_identity("Operator", rule(Criteria::UserName, "pat")));
    const auto is_operator = [&](bool is_trusted, const char* uri = "urn:client") {
        const Names found = roles(pat(), is_trusted, uri);
        return std::find(found.begin(), found.end(), "Operator") != found.end();
    };
    CHECK(is_operator(false));
    REQUIRE(list.add_application("Operator", "urn:client"));
    CHECK_FALSE(is_operator(true));
    CHECK(is_operator(true, "urn:other"));
    CHECK_FALSE(is_operator(false, "urn:other")); // who knows who that is
    REQUIRE(list.set_applications_exclude("Operator", false));
    CHECK(is_operator(true));
    CHECK_FALSE(is_operator(true, "urn:other"));
    CHECK_FALSE(is_operator(false));
    REQUIRE(list.remove_application("Operator", "urn:client"));
    CHECK_FALSE(is_operator(true));
    REQUIRE(list.set_applications_exclude("Operator", true));
    CHECK(is_operator(true));

    EndpointType signed_one;
    signed_one.security_mode = MessageSecurityMode::Sign;
    REQUIRE(list.add_endpoint("Operator", signed_one));
    CHECK_FALSE(is_operator(true));
    CHECK(is_operator(false));
    REQUIRE(list.set_endpoints_exclude("Operator", false));
    CHECK(is_operator(true));
    CHECK_FALSE(is_operator(false));
    EndpointType url;
    url.endpoint_url = "opc.tcp://plc:4840";
    REQUIRE(list.add_endpoint("Operator", url));
    CHECK(is_operator(false));
    CHECK(status_of(list.add_endpoint("Operator", url)) == "Bad_AlreadyExists");
    REQUIRE(list.remove_endpoint("Operator", url));
    CHECK(status_of(list.remove_endpoint("Operator", url)) == "Bad_NotFound");
    url.security_mode = MessageSecurityMode{9};
    CHECK(status_of(list.add_endpoint("Operator", url)) == "Bad_InvalidArgument");
    RoleList again{storage, "roles.json"};
    REQUIRE(again.load());
    REQUIRE(again.find("Operator")->endpoints.size() == 1);
    CHECK(again.find("Operator")->endpoints[0].security_mode == MessageSecurityMode::Sign);
    CHECK_FALSE(again.find("Operator")->endpoints_exclude);
}

TEST_CASE_METHOD(Fixture, "roles: own ones come and go (Part 18, 4.2)")
{
    REQUIRE(list.add("Fitter", "urn:works"));
    CHECK(list.find("Fitter")->applications_exclude);
    CHECK(list.find("Fitter")->endpoints_exclude);
    CHECK(status_of(list.add("Fitter", "")) == "Bad_AlreadyExists");
    CHECK(status_of(list.add("SecurityAdmin", "urn:works")) == "Bad_AlreadyExists");
    for (const char* no_name : {"", " ", "Fitter ", "a\nb", "\xff\xfe", "\xe2\x80\xaerettiF"}) {
        CHECK(status_of(list.add(no_name, "")) == "Bad_InvalidArgument");
        CHECK(status_of(list.add_application("Operator", no_name)) == "Bad_InvalidArgument");
        CHECK(status_of(list.add_identity("Operator", rule(Criteria::UserName, no_name))) ==
              "Bad_InvalidArgument");
    }
    CHECK(status_of(list.add("Other", "\xff")) == "Bad_InvalidArgument");
    REQUIRE(list.add_identity("Fitter", rule(Criteria::UserName, "pat")));
    CHECK(roles(pat()) == Names{"Fitter"});
    CHECK(list.roles_of({.user = pat()}).access_level_mask == 0xFF);
    CHECK(stored("Fitter") == Names{"pat"});
    CHECK(status_of(list.remove("Operator")) == "Bad_RequestNotAllowed");
    CHECK(status_of(list.remove("Nobody")) == "Bad_NodeIdUnknown");
    REQUIRE(list.remove("Fitter"));
    CHECK(roles(pat()).empty());
    for (int i = 0; list.roles().size() < 64; ++i) {
        REQUIRE(list.add("role " + std::to_string(i), ""));
    }
    CHECK(status_of(list.add("one more", "")) == "Bad_ResourceUnavailable");
}

TEST_CASE_METHOD(Fixture, "roles: no name and no rule keeps the others from a restart", "[attack]")
{
    using namespace std::string_literals;
    REQUIRE(list.add("Fitter", "urn:works"));
    for (const std::string& text :
         {"\"}], \"roles\": [{"s, "a\\"s, "a\nb\r"s, "a\0b"s, "\x01\x1b[2J\x7f"s, "\xC3"s,
          "\xFF\xFE"s, "\xED\xA0\x80"s, "\xC0\x80"s, "\\u0000"s, "<role/>&amp;"s, "../pat"s,
          std::string(1'000, '\xFF')}) {
        const IdentityMappingRuleType added{Criteria::UserName, String{text}};
        const bool has_rule = bool{list.add_identity("Fitter", added)};
        CHECK(stored("Fitter") == (has_rule ? Names{text} : Names{}));
        const bool has_application = bool{list.add_application("Fitter", text)};
        EndpointType endpoint;
        endpoint.endpoint_url = String{text};
        const bool has_endpoint = bool{list.add_endpoint("Fitter", endpoint)};
        CHECK(stored("Fitter") == (has_rule ? Names{text} : Names{}));
        if (has_application) {
            REQUIRE(list.remove_application("Fitter", text));
        }
        if (has_endpoint) {
            REQUIRE(list.remove_endpoint("Fitter", endpoint));
        }
        const bool has_role = bool{list.add(text, text)};
        CHECK(stored("Fitter") == (has_rule ? Names{text} : Names{}));
        if (has_role) {
            CHECK(stored(text.c_str()).empty());
            REQUIRE(list.remove(text));
        }
        if (has_rule) {
            REQUIRE(list.remove_identity("Fitter", added));
        }
    }
}

TEST_CASE("roles: what waits for a restart is not changed before")
{
    storage::MemoryStorage storage;
    StorageGate gate{storage};
    RoleList list{gate, "roles.json"};
    gate.close();
    CHECK(status_of(list.add("Fitter", "")) == "Bad_InvalidState");
    CHECK(list.find("Fitter") == nullptr);
    CHECK(storage.names().empty());
}

TEST_CASE_METHOD(Fixture, "roles: nobody takes the last rule of SecurityAdmin away")
{
    REQUIRE(list.add_identity("SecurityAdmin", rule(Criteria::UserName, "root")));
    CHECK(list.is_administrator("root"));
    CHECK_FALSE(list.is_administrator("pat"));
    CHECK(status_of(list.remove_identity("SecurityAdmin", rule(Criteria::UserName, "root"))) ==
          "Bad_RequestNotAllowed");
    REQUIRE(list.add_identity("SecurityAdmin", rule(Criteria::UserName, "pat")));
    REQUIRE(list.remove_identity("SecurityAdmin", rule(Criteria::UserName, "root")));
    CHECK_FALSE(list.is_administrator("root"));
}

TEST_CASE_METHOD(Fixture, "roles: the last rule of SecurityAdmin may go where others administer")
{
    configured.replace({{.name = "chief", .roles = {"SecurityAdmin"}}});
    REQUIRE(list.add_identity("SecurityAdmin", rule(Criteria::UserName, "pat")));
    CHECK(list.remove_identity("SecurityAdmin", rule(Criteria::UserName, "pat")));
    CHECK(list.find("SecurityAdmin")->identities.empty());
}

TEST_CASE_METHOD(Fixture, "roles: whom the configuration gives a role to is listed and stays")
{
    configured.replace({{.name = "op", .roles = {"Operator", "Observer"}},
                        {.name = "setup", .roles = {"SecurityAdmin"}, .is_temporary = true}},
                       {"Operator"});
    REQUIRE(list.add_identity("Operator", rule(Criteria::UserName, "pat")));
    const auto of = [&](std::string_view role) { return list.identities_of(role); };
    CHECK(of("Operator") == std::vector{rule(Criteria::UserName, "op"),
                                        rule(Criteria::Role, "Operator"),
                                        rule(Criteria::UserName, "pat")});
    CHECK(of("Observer") == std::vector{rule(Criteria::UserName, "op")});
    CHECK(of("Nobody").empty());
    CHECK(list.find("Operator")->identities.size() == 1); // of which the file is made
    CHECK(status_of(list.add_identity("Operator", rule(Criteria::UserName, "op"))) ==
          "Bad_AlreadyExists");
    CHECK(status_of(list.remove_identity("Operator", rule(Criteria::UserName, "op"))) ==
          "Bad_RequestNotAllowed");
    CHECK(status_of(list.remove_identity("Operator", rule(Criteria::Role, "Operator"))) ==
          "Bad_RequestNotAllowed");
    CHECK(status_of(list.remove_identity("Engineer", rule(Criteria::UserName, "op"))) ==
          "Bad_NotFound");
    // A rule from before the configuration had it goes, and what is configured stays.
    configured.replace({{.name = "pat", .roles = {"Operator"}}});
    REQUIRE(list.remove_identity("Operator", rule(Criteria::UserName, "pat")));
    CHECK(of("Operator") == std::vector{rule(Criteria::UserName, "pat")});
    // Who is there for the setup does not administer for good.
    configured.replace({{.name = "setup", .roles = {"SecurityAdmin"}, .is_temporary = true}});
    REQUIRE(list.add_identity("SecurityAdmin", rule(Criteria::UserName, "root")));
    CHECK(status_of(list.remove_identity("SecurityAdmin", rule(Criteria::UserName, "root"))) ==
          "Bad_RequestNotAllowed");
}

TEST_CASE_METHOD(Fixture, "roles: nobody keeps all administrators out by empty lists")
{
    REQUIRE(list.add_identity("SecurityAdmin", rule(Criteria::UserName, "root")));
    CHECK(status_of(list.set_applications_exclude("SecurityAdmin", false)) ==
          "Bad_RequestNotAllowed");
    CHECK(status_of(list.set_endpoints_exclude("SecurityAdmin", false)) == "Bad_RequestNotAllowed");
    REQUIRE(list.add_application("SecurityAdmin", "urn:client"));
    REQUIRE(list.set_applications_exclude("SecurityAdmin", false));
    CHECK(status_of(list.remove_application("SecurityAdmin", "urn:client")) ==
          "Bad_RequestNotAllowed");
    REQUIRE(list.set_applications_exclude("SecurityAdmin", true));
    REQUIRE(list.remove_application("SecurityAdmin", "urn:client"));
    REQUIRE(list.set_applications_exclude("Operator", false)); // others can be for nobody
}

TEST_CASE_METHOD(Fixture, "roles: their lists bind who has them without rules, too")
{
    REQUIRE(list.add_application("Operator", "urn:client"));
    const UserIdentity configured{UserTokenType::UserName, "op", 0xFF, {"Operator", "Observer"}};
    const auto left = [&](const char* uri) {
        const server::RoleQuestion question{
            .user = configured, .application_uri = uri, .is_trusted = true};
        return list.limited(question, {0xFF, configured.roles}).roles;
    };
    CHECK(left("urn:other") == Names{"Operator", "Observer"});
    CHECK(left("urn:client") == Names{"Observer"});
}

TEST_CASE_METHOD(Fixture, "roles: all but SecurityAdmin can be closed until they are opened again")
{
    const Names given{"Welder", "Operator"};
    const std::string document = RoleList::closed_document(given);
    REQUIRE(storage.replace("roles.json", std::as_bytes(std::span{document}), FileAccess::Owner));
    REQUIRE(list.load());
    const UserIdentity configured{UserTokenType::UserName,
                                  "op",
                                  0xFF,
                                  {"Welder", "Observer", "Operator", "Engineer", "Supervisor",
                                   "ConfigureAdmin", "SecurityAdmin"}};
    const auto left = [&] {
        const server::RoleQuestion question{
            .user = configured, .application_uri = "urn:client", .is_trusted = true};
        return list.limited(question, {0xFF, configured.roles}).roles;
    };
    CHECK(left() == Names{"SecurityAdmin"});
    CHECK(roles(pat(), true) == Names{"TrustedApplication"}); // by what it means
    REQUIRE(list.set_endpoints_exclude("Operator", true));
    REQUIRE(list.set_endpoints_exclude("Welder", true));
    CHECK(left() == Names{"Welder", "Operator", "SecurityAdmin"});
    // As many as there may be.
    Names many;
    for (int i = 0; i < 100; ++i) {
        many.push_back("Role " + std::to_string(i));
    }
    const std::string most = RoleList::closed_document(many);
    REQUIRE(storage.replace("roles.json", std::as_bytes(std::span{most}), FileAccess::Owner));
    REQUIRE(list.load());
    CHECK(list.roles().size() == administration::RoleLimits{}.max_roles);
}

TEST_CASE_METHOD(Fixture,
                 "roles: a file that is wrong is refused with its place, and nothing changes")
{
    REQUIRE(list.add_identity("Operator", rule(Criteria::UserName, "pat")));
    const std::string rest =
        R"("applications_exclude":true,"applications":[],"endpoints_exclude":true,"endpoints":[]})";
    const auto problem = [&](const std::string& roles_text) {
        const std::string document = R"({"version":1,"roles":[)" + roles_text + "]}";
        REQUIRE(
            storage.replace("roles.json", std::as_bytes(std::span{document}), FileAccess::Owner));
        const auto loaded = list.load();
        CHECK(list.find("Operator")->identities.size() == 1);
        return loaded ? "Good" : busbar::text(loaded.error());
    };
    const std::string place = "memory:roles.json: roles[0].";
    CHECK(problem("7") == place + "name: found nothing, expected a text");
    CHECK(problem(R"({"name":"Operator","namespace_uri":"urn:other","identities":[],)" + rest) ==
          place + "namespace_uri: found \"urn:other\", expected each name once");
    CHECK(problem(R"({"name":"a","namespace_uri":"","identities":[7],)" + rest) ==
          place + "identities: found a list, expected a list of rules");
    CHECK(problem(R"({"name":"a","namespace_uri":"","identities":[)"
                  R"({"criteria_type":4,"criteria":"x"}],)" +
                  rest) == place + "identities: found a list, expected rules that can be used");
    CHECK(problem(R"({"name":"a","namespace_uri":"","identities":[],"applications_exclude":1})") ==
          place + "applications_exclude: found 1, expected true or false");
    const std::string document = R"({"version":1,"roles":[]})";
    REQUIRE(storage.replace("roles.json", std::as_bytes(std::span{document}), FileAccess::Owner));
    REQUIRE(list.load());
    CHECK(list.roles().size() == 9);
}

} // namespace role_list_test
