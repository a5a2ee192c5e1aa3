#include <functional>
#include <string_view>
#include <vector>

#include "authority_plant.hpp"

namespace authorities_test {

// W588, 8-1: what five authorities may do, function by function, each by the service that it
// is in OPC UA.

using namespace busbar;
using namespace busbar::test;
namespace {

/// A row of the table, with the least authority that it is for, and how OPC UA has it.
struct Function {
    const char* subject;
    const char* name;
    Authority least;
    std::function<StatusCode(Plant&, TestClient&)> use;
};

constexpr auto shows = Authority::Operator;
constexpr auto administers = Authority::Administrator;

std::vector<Function> functions_of_own()
{
    return {
        {"Server certificate", "Display and update", shows,
         [](Plant& plant, TestClient& client) {
             return plant.value(client, NodeId{1, "ServerConfiguration/OwnCertificate/Thumbprint"});
         }},
        {"Server certificate", "Export", administers,
         [](Plant& plant, TestClient& client) {
             return plant.on_server(client, NodeId{0, 32333}, {Variant{NodeId{}}});
         }},
        {"Server certificate", "Regenerate", administers,
         [](Plant& plant, TestClient& client) { return plant.regenerate(client); }},
    };
}

std::vector<Function> functions_of_clients()
{
    return {
        {"Client authentication", "Display and update", shows,
         [](Plant& plant, TestClient& client) {
             return plant
                 .call(client, NodeId{0, id::ServerConfiguration},
                       NodeId{0, id::ServerConfiguration_GetRejectedList}, {})
                 .status_code;
         }},
        {"Client authentication", "Add certificate", administers,
         [](Plant& plant, TestClient& client) { return plant.add(client, root().certificate); }},
        {"Client authentication", "Delete certificate", administers,
         [](Plant& plant, TestClient& client) {
             return plant.remove(client, root().certificate, true);
         }},
        {"Client authentication", "Move certificate", administers,
         [](Plant& plant, TestClient& client) { return plant.add(client, plant.rejected); }},
        {"Client authentication", "View certificate details", shows,
         [](Plant& plant, TestClient& client) { return plant.sees(client, trusted_certificates); }},
        {"Client authentication", "Add certificate revocation list", administers,
         [](Plant& plant, TestClient& client) {
             return plant.replace_crls(client, trusted_crls, true);
         }},
        {"Client authentication", "Delete Certificate Revocation List", administers,
         [](Plant& plant, TestClient& client) {
             return plant.replace_crls(client, trusted_crls, false);
         }},
        {"Client authentication", "View Certificate Revocation List details", shows,
         [](Plant& plant, TestClient& client) { return plant.sees(client, trusted_crls); }},
    };
}

/// They differ from those of clients in the lists.
std::vector<Function> functions_of_issuers()
{
    return {
        {"Issuer authentication", "Display and update", shows,
         [](Plant& plant, TestClient& client) {
             return plant.value(client, NodeId{0, open_count});
         }},
        {"Issuer authentication", "Add certificate", administers,
         [](Plant& plant, TestClient& client) { return plant.replace_issuers(client, true); }},
        {"Issuer authentication", "Delete certificate", administers,
         [](Plant& plant, TestClient& client) {
             return plant.remove(client, root().certificate, false);
         }},
        {"Issuer authentication", "Move certificate", administers,
         [](Plant& plant, TestClient& client) { return plant.replace_issuers(client, true); }},
        {"Issuer authentication", "View certificate details", shows,
         [](Plant& plant, TestClient& client) { return plant.sees(client, issuer_certificates); }},
        {"Issuer authentication", "Add Certificate Revocation List", administers,
         [](Plant& plant, TestClient& client) {
             return plant.replace_crls(client, issuer_crls, true);
         }},
        {"Issuer authentication", "Delete Certificate Revocation List", administers,
         [](Plant& plant, TestClient& client) {
             return plant.replace_crls(client, issuer_crls, false);
         }},
        {"Issuer authentication", "View Certificate Revocation List details", shows,
         [](Plant& plant, TestClient& client) { return plant.sees(client, issuer_crls); }},
    };
}

std::vector<Function> other_functions()
{
    return {
        {"Security settings", "Display and edit", shows,
         [](Plant& plant, TestClient& client) {
             const StatusCode users = plant.value(client, NodeId{0, id::UserManagement_Users});
             return users == status::Good
                        ? plant.value(client, NodeId{1, "Settings.users.anonymous"})
                        : users;
         }},
        {"Security settings", "Transfer security settings", administers,
         [](Plant& plant, TestClient& client) { return plant.set(client); }},
        {"Service status", "Display and update", shows,
         [](Plant& plant, TestClient& client) {
             constexpr std::uint32_t sessions =
                 id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSessionCount;
             const StatusCode summary = plant.value(client, NodeId{0, sessions});
             return summary == status::Good ? plant.value(client, NodeId{1, "Status/RestartDue"})
                                            : summary;
         }},
        {"Execution Logs", "Display", shows,
         [](Plant& plant, TestClient& client) {
             return plant.value(client, NodeId{1, "Log"});
         }},
        {"Execution Logs", "Clear", Authority::Maintainer,
         [](Plant& plant, TestClient& client) {
             return plant.call(client, NodeId{0, id::ObjectsFolder}, NodeId{1, "Clear"}, {})
                 .status_code;
         }},
        // The last, since nothing is asked for after it.
        {"Service status", "Shut down server", Authority::Designer,
         [](Plant& plant, TestClient& client) { return plant.shut_down(client); }},
    };
}

const std::vector<Function>& functions()
{
    static const std::vector<Function> all = [] {
        std::vector<Function> list = functions_of_own();
        for (const auto& more :
             {functions_of_clients(), functions_of_issuers(), other_functions()}) {
            list.insert(list.end(), more.begin(), more.end());
        }
        return list;
    }();
    return all;
}

bool is_refusal(StatusCode status)
{
    return status == status::Bad_UserAccessDenied || status == status::Bad_NodeIdUnknown;
}

} // namespace

TEST_CASE("authorities: the 125 cells of five authorities and 25 functions")
{
    std::size_t cells = 0;
    for (const Level& level : levels) {
        Plant plant;
        auto client = plant.log_in_as(level);
        for (const Function& function : functions()) {
            INFO(level.name << ": " << function.subject << ", " << function.name);
            const StatusCode answer = function.use(plant, client);
            INFO(name(answer));
            if (level.authority >= function.least) {
                CHECK(answer == status::Good);
            } else {
                CHECK(is_refusal(answer));
            }
            ++cells;
        }
    }
    CHECK(cells == 125);
}

TEST_CASE("authorities: namespace 0 alone lets nobody look")
{
    Plant plant{Authorities::Standard};
    for (const Level& level : levels) {
        auto client = plant.log_in_as(level);
        for (const Function& function : functions()) {
            const std::string_view subject = function.subject;
            const bool is_of_certificates =
                subject.ends_with("authentication") || function.least == Authority::Administrator;
            if (level.authority == Authority::Administrator || !is_of_certificates) {
                continue; // logs and settings have their own, the rest is for everybody
            }
            INFO(level.name << ": " << function.subject << ", " << function.name);
            CHECK(is_refusal(function.use(plant, client)));
        }
    }
}

TEST_CASE("authorities: who only looks keeps no administrator out")
{
    Plant plant;
    auto client = plant.log_in_as(levels[3]);
    CHECK(plant.on_list(client, open_method, {Variant{std::uint8_t{6}}}) ==
          status::Bad_UserAccessDenied);
    auto admin = plant.log_in();
    CHECK(plant.replace_crls(admin, trusted_crls, true) == status::Good);
}

TEST_CASE("authorities: have two names")
{
    CHECK(administration::find_authorities("standard") == Authorities::Standard);
    CHECK(administration::find_authorities("five levels") == Authorities::FiveLevels);
    for (const char* other : {"", "Standard", "five", "five levels "}) {
        CHECK_FALSE(administration::find_authorities(other));
    }
}

} // namespace authorities_test
