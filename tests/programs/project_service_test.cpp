#include "product/model/project_service.hpp"

#include <catch2/catch.hpp>

#include <memory>
#include <span>
#include <string>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <busbar/types/ids.hpp>

namespace project_service_test {

using namespace busbar;
using namespace busbar::product;

// 9.13 and 9.14: what a tool does with the project of a server, without the server.

namespace {

const NodeId first_tool{1, "first"};
const NodeId second_tool{1, "second"};

std::string document_of_host(const std::string& host)
{
    controller::Project project;
    project.network.host_name = host;
    return *controller::document_of(project);
}

struct ServiceFixture {
    ServiceFixture() { REQUIRE(store.recover()); }

    [[nodiscard]] std::string send(const char* wish, const std::string& file,
                                   const NodeId& session = first_tool)
    {
        const Variant options{wish};
        const administration::TransferRequest request{options, user, session};
        const StatusCode may = service->may_take(request);
        if (may.is_bad()) {
            return std::string{name(may)};
        }
        const auto bytes = std::as_bytes(std::span{file});
        if (const auto prepare = service->preparation(request, bytes)) {
            prepare();
        }
        return std::string{name(service->take(request, bytes))};
    }
    [[nodiscard]] std::string fetch(const Variant& options, const NodeId& session = first_tool,
                                    std::size_t max_size = 1U << 20U)
    {
        const auto bytes = service->generate({options, user, session}, max_size);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : std::string{name(bytes.error())};
    }

    /// As a server says that begins with what is in the store.
    static std::string status_of(controller::ProjectStore& store)
    {
        NullLog log;
        ProjectService next{{.store = store, .log = log, .status = status, .update = {}}};
        const Variant options{"status"};
        const server::UserIdentity user;
        const auto bytes = next.generate({options, user, first_tool}, 1'000);
        return std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    }
    static ProjectService::ModuleStatus status() { return {"model mode", "Running", "1.2.3"}; }

    NullLog log;
    storage::MemoryStorage storage;
    server::UserIdentity user;
    int updates{0};
    bool can_update{true};
    controller::ProjectStore store{storage, "project", {}};
    std::unique_ptr<ProjectService> service = std::make_unique<ProjectService>(
        ProjectService::Needs{.store = store, .log = log, .status = status, .update = [this] {
                                  ++updates;
                                  return can_update
                                             ? Configured<void>{}
                                             : misconfigured("port", "is in use",
                                                             status::Bad_ResourceUnavailable);
                              }});
};

} // namespace

TEST_CASE("9.13 Project service: write, read and update", "[9.13]")
{
    ServiceFixture server;
    CHECK(server.fetch(Variant{}) == "Bad_NotFound");
    CHECK(server.send("update", "") == "Bad_NotFound");
    CHECK(server.send("verify", document_of_host("A")) == "Bad_NotFound");

    CHECK(server.send("write", document_of_host("A")) == "Good");
    CHECK(server.fetch(Variant{"report"}) == R"({"written":true})");
    CHECK(server.fetch(Variant{}) == document_of_host("A"));
    CHECK(server.fetch(Variant{}, first_tool, 100) == "Bad_EncodingLimitsExceeded");
    CHECK(server.updates == 0);
    CHECK(server.send("update", "") == "Good");
    CHECK(server.fetch(Variant{"report"}) == R"({"updated":true})");
    CHECK(server.updates == 1);
    CHECK(server.send("update", "x") == "Bad_InvalidArgument");
    server.can_update = false;
    CHECK(server.send("update", "") == "Bad_ResourceUnavailable");
    CHECK(server.fetch(Variant{"report"}).find("is in use") != std::string::npos);
}

TEST_CASE("9.13 Project service: a wrong project changes nothing, and the report says why",
          "[9.13]")
{
    ServiceFixture server;
    REQUIRE(server.send("write", document_of_host("A")) == "Good");
    CHECK(server.send("write", document_of_host("a b")) == "Bad_ConfigurationError");
    CHECK(server.fetch(Variant{"report"}).find(R"([network] host_name: found \"a b\")") !=
          std::string::npos);
    CHECK(server.fetch(Variant{}) == document_of_host("A"));
    // What somebody else did is nobody's business.
    CHECK(server.fetch(Variant{"report"}, second_tool) == "Bad_NotFound");
    CHECK(server.send("delete", "") == "Bad_InvalidArgument");
    CHECK(server.fetch(Variant{"backup"}) == "Bad_InvalidArgument");
    CHECK(server.fetch(Variant{7}) == "Bad_InvalidArgument");
}

TEST_CASE("9.13 Project service: a verification lists each difference", "[9.13]")
{
    ServiceFixture server;
    REQUIRE(server.send("write", document_of_host("A")) == "Good");
    CHECK(server.send("verify", document_of_host("A")) == "Good");
    CHECK(server.fetch(Variant{"report"}) == R"({"differences":[]})");
    CHECK(server.send("verify", document_of_host("B")) == "Good");
    CHECK(server.fetch(Variant{"report"}) ==
          R"({"differences":[{"where":"network.host_name","file":"\"B\"","server":"\"A\""}]})");
    CHECK(server.fetch(Variant{}) == document_of_host("A"));
    CHECK(server.send("verify", "no project") == "Bad_ConfigurationError");
}

TEST_CASE("9.14 Project service: operation mode, server status and version", "[9.14]")
{
    ServiceFixture server;
    const std::string begin =
        R"({"operationMode":"model mode","serverStatus":"Running","version":"1.2.3","project":")";
    CHECK(server.fetch(Variant{"status"}) == begin + "none\"}");
    REQUIRE(server.send("write", document_of_host("A")) == "Good");
    CHECK(server.fetch(Variant{"status"}) == begin + "written, an update or restart is due\"}");
    // It is the one after it that serves the project, or none if that does not work out.
    REQUIRE(server.send("update", "") == "Good");
    CHECK(server.fetch(Variant{"status"}) == begin + "written, an update or restart is due\"}");
    CHECK(ServiceFixture::status_of(server.store) == begin + "in use\"}");
}

TEST_CASE("9.14 Project service: a damaged project is told, and what runs instead", "[9.14]")
{
    storage::MemoryStorage storage;
    REQUIRE(storage.make_folder("project", FileAccess::Owner));
    const std::string damaged = "damaged";
    REQUIRE(storage.replace("project/project.busbar", std::as_bytes(std::span{damaged}),
                            FileAccess::Owner));
    controller::ProjectStore store{storage, "project", {}};
    const auto recovered = store.recover();
    REQUIRE_FALSE(recovered);
    controller::Project last;
    last.network.host_name = "LAST";
    const auto fetch = [&](const controller::Project* served, const Variant& options) {
        NullLog log;
        ProjectService service{{.store = store,
                                .log = log,
                                .status = ServiceFixture::status,
                                .update = {},
                                .damage = text(recovered.error()),
                                .served = served}};
        const server::UserIdentity user;
        const auto bytes = service.generate({options, user, first_tool}, 10'000);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : std::string{name(bytes.error())};
    };
    CHECK(fetch(&last, Variant{"status"})
              .find("damaged, the one that was served last is in use: project:1: ") !=
          std::string::npos);
    CHECK(fetch(nullptr, Variant{"status"}).find("damaged, none is in use: project:1: ") !=
          std::string::npos);
    CHECK(fetch(&last, Variant{}) == document_of_host("LAST"));
    CHECK(fetch(nullptr, Variant{}) == "Bad_NotFound");
}

namespace {

/// A Variable "Int16" that is mapped to the label.
std::string document_with(const std::string& label)
{
    controller::Project project;
    project.models.push_back(
        {"t.xml", "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">"
                  "<NamespaceUris><Uri>urn:t</Uri></NamespaceUris>"
                  "<Models><Model ModelUri=\"urn:t\"/></Models>"
                  "<UAVariable NodeId=\"ns=1;i=5\" BrowseName=\"1:V\" DataType=\"i=4\">"
                  "<References><Reference ReferenceType=\"i=40\">i=63</Reference>"
                  "<Reference ReferenceType=\"i=47\" IsForward=\"false\">i=85</Reference>"
                  "</References><Extensions><Extension><DataMapping "
                  "xmlns=\"https://www.mitsubishielectric.com/fa/OPCUA/extension/\" Data=\"" +
                      label + "\"/></Extension></Extensions></UAVariable></UANodeSet>"});
    return *controller::document_of(project);
}

struct LabelFixture : ServiceFixture {
    explicit LabelFixture(bool isolates_failures = false)
    {
        auto program = controller::read_declarations(
            "{attribute 'publish' := 'publish only'} VAR_GLOBAL Whole : INT; Long : DINT; "
            "Text : STRING[4]; END_VAR",
            "line.st");
        REQUIRE(program);
        auto made = controller::SimulatedLabels::create(*std::move(program));
        REQUIRE(made);
        labels = std::move(*made);
        service = std::make_unique<ProjectService>(
            ProjectService::Needs{.store = store,
                                  .log = log,
                                  .status = status,
                                  .update =
                                      [this] {
                                          ++updates;
                                          return Configured<void>{};
                                      },
                                  .labels = labels,
                                  .isolates_failures = isolates_failures,
                                  .accept_labels =
                                      [this] {
                                          ++accepted;
                                          return Configured<void>{};
                                      }});
    }

    std::shared_ptr<controller::SimulatedLabels> labels;
    int accepted{0};
};

} // namespace

TEST_CASE("8.2 Project service: labels that are not the PLC's refuse an update, and are told",
          "[8.2][9.13]")
{
    LabelFixture server;
    REQUIRE(server.send("write", document_with("Whole")) == "Good");
    CHECK(server.send("labels", "") == "Good");
    CHECK(server.fetch(Variant{"report"}) == R"({"labels":[],"labelCount":0})");
    CHECK(server.send("update", "") == "Good");
    CHECK(server.updates == 1);
    // Converted where it is in range.
    REQUIRE(server.send("write", document_with("Long")) == "Good");
    CHECK(server.send("labels", "") == "Good");
    CHECK(server.fetch(Variant{"report"}).find(R"("found":"DINT","use":"converted"}],)") !=
          std::string::npos);
    CHECK(server.send("update", "") == "Good");
    CHECK(server.updates == 2);
    for (const char* const label : {"Text", "Nothing"}) {
        REQUIRE(server.send("write", document_with(label)) == "Good");
        CHECK(server.send("labels", "") == "Good");
        CHECK(server.fetch(Variant{"report"}).find(R"("use":"refused")") != std::string::npos);
        CHECK(server.send("update", "") == "Bad_ConfigurationError");
        const std::string report = server.fetch(Variant{"report"});
        CHECK(report.find("1 of its labels cannot be used with the PLC's program: " +
                          std::string{label} + " of ns=1;i=5: ") != std::string::npos);
        CHECK(report.find("expected INT") != std::string::npos);
    }
    CHECK(server.updates == 2);
    CHECK(server.accepted == 0);
    CHECK(server.send("update despite labels", "") == "Good");
    CHECK(server.updates == 3);
    CHECK(server.accepted == 1);
    CHECK(server.fetch(Variant{"report"}) == R"({"updated":true})");
}

TEST_CASE("8.2 Project service: where failures are isolated labels are told only", "[8.2][9.13]")
{
    LabelFixture server{true};
    REQUIRE(server.send("write", document_with("Text")) == "Good");
    CHECK(server.send("update", "") == "Good");
    CHECK(server.updates == 1);
    CHECK(server.accepted == 0);
}

TEST_CASE("9.13 Project service: what is prepared elsewhere leaves the service as it is", "[9.13]")
{
    ServiceFixture server;
    REQUIRE(server.send("write", document_of_host("A")) == "Good");
    const Variant options{"write"};
    const administration::TransferRequest request{options, server.user, first_tool};
    const std::string document = document_of_host("B");
    const auto bytes = std::as_bytes(std::span{document});
    const auto prepare = server.service->preparation(request, bytes);
    REQUIRE(prepare);
    prepare();
    CHECK(server.fetch(Variant{}) == document_of_host("A")); // until it is taken
    CHECK(server.service->take(request, bytes) == status::Good);
    CHECK(server.fetch(Variant{}) == document);
    prepare(); // and nobody takes it
    CHECK(server.send("verify", document) == "Good");
    CHECK(server.send("write", document_of_host("E")) == "Good");
    CHECK(server.fetch(Variant{}) == document_of_host("E"));
}

TEST_CASE("9.13 Project service: it is for administrators, and for one writer at a time", "[9.13]")
{
    ServiceFixture server;
    const auto transfer = server.service->transfer();
    // ConfigureAdmin alone could make itself users who may change security.
    const std::vector<NodeId> administrators{NodeId{0, id::WellKnownRole_SecurityAdmin}};
    CHECK(transfer.readers == administrators);
    CHECK(transfer.writers == administrators);
    CHECK(transfer.limits.max_written == 1);
}

} // namespace project_service_test
