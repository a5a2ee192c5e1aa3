#include <catch2/catch.hpp>

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include <busbar/controller/machine_error_nodes.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <busbar/types/attribute.hpp>

#include "controller/logs/log_fixture.hpp"
#include "controller/publishing/machine_parts.hpp"
#include "support/server_fixture.hpp"

namespace machine_error_nodes_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;
using busbar::test::Happening;

namespace {

class CountingWaker final : public server::Waker {
public:
    void wake() override { ++calls; }

    std::atomic<int> calls{0};
};

/// Passes on that errors have changed, as a machine does.
class ErrorsListener final : public MachineEventListener {
public:
    explicit ErrorsListener(MachineErrorNodes& nodes) : nodes_{nodes} {}
    void happened(const MachineEvent&) override { ++events; }
    void errors_changed() override
    {
        ++changes;
        nodes_.refresh();
    }

    int events{0};
    int changes{0};

private:
    MachineErrorNodes& nodes_;
};

struct ErrorNodesBase {
    CountingWaker bell;
};

/// A machine's server with its errors, and a client of it.
struct ErrorNodesWorld : ErrorNodesBase, busbar::test::ServerFixture {
    ErrorNodesWorld() : ServerFixture{bell}
    {
        nodes = MachineNodes::create(server.address_space(), published.program,
                                     published.publication, machine_options())
                    .value();
        happen(Happening{RecordKind::ServerHalted,
                         {busbar::test::text("Reason", "Configuration Error")}});
        REQUIRE(errors.publish(server, *nodes, *log));
        client.emplace(log_in_as("operator"));
    }

    void happen(const Happening& happening) { log->record(happening.record()); }
    void lose_log()
    {
        happen(Happening{RecordKind::ExecutionLogLost, {busbar::test::number("Code", 3)}});
    }
    [[nodiscard]] Variant read(const std::string& id)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = NodeId{nodes->namespace_index(), String{id}};
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        return client->call<ReadResponse>(std::move(request)).value().results[0].value;
    }
    /// ErrorState, Level and Code.
    [[nodiscard]] std::vector<Variant> error()
    {
        return {read("Controller/DeviceState/ErrorState"), read("Controller/PLCError/Level"),
                read("Controller/PLCError/Code")};
    }
    [[nodiscard]] std::vector<std::string> current()
    {
        std::vector<std::string> texts;
        const Variant value = read("Controller/PLCError/CurrentErrors");
        REQUIRE(value.array_if<String>() != nullptr);
        for (const String& each : *value.array_if<String>()) {
            texts.push_back(each.str());
        }
        return texts;
    }

    storage::MemoryStorage files;
    busbar::test::FixedWallClock clock;
    NullLog next;
    Published published{machine_program()};
    std::optional<MachineNodes> nodes;
    MachineErrorNodes errors;
    ErrorsListener listener{errors};
    std::unique_ptr<MachineEventLog> log{
        MachineEventLog::create(files, clock, next, &listener).value()};
    std::optional<busbar::test::TestClient> client;
};

using Values = std::vector<Variant>;
using Texts = std::vector<std::string>;

const Values no_error{Variant{"NoError"}, Variant{"NoError"}, Variant{std::uint32_t{0}}};

MachineEvent event_of(EventLevel level)
{
    MachineEvent event;
    event.level = level;
    return event;
}

} // namespace

TEST_CASE_METHOD(ErrorNodesWorld, "A client reads the highest current error (9-1-1, GetPLCError)")
{
    // What stood before there were nodes.
    CHECK(error() == Values{Variant{"ContinuousError"}, Variant{"Minor fault"},
                            Variant{std::uint32_t{0x35D00000}}});
    lose_log();
    server.handle_completions(now);
    CHECK(current() == Texts{"35D00000 OPC UA Server Setting Error",
                             "15000000 Execution Log Save Failed: 0003"});
    CHECK(error()[2] == Variant{std::uint32_t{0x35D00000}}); // the highest code
    happen(Happening{RecordKind::ServerRunning});
    server.handle_completions(now);
    CHECK(error()[2] == Variant{std::uint32_t{0x15000000}});
    CHECK(current() == Texts{"15000000 Execution Log Save Failed: 0003"});
    happen(Happening{RecordKind::ExecutionLogSaved});
    server.handle_completions(now);
    CHECK(error() == no_error);
    CHECK(current().empty());
}

TEST_CASE_METHOD(ErrorNodesWorld, "An observation stands, but is no error of the state (9-1-2)")
{
    happen(Happening{RecordKind::ServerRunning});
    happen(Happening{RecordKind::PublishingLimitExceeded,
                     {busbar::test::text("Limit", "MaxVariables")}});
    server.handle_completions(now);
    CHECK(error() == no_error);
    CHECK(current() == Texts{"35D30000 Too Many Public Variables"});
}

TEST_CASE_METHOD(ErrorNodesWorld, "Nodes change on the server's thread, which is woken (9-1-1)")
{
    const int before = bell.calls;
    const int changes = listener.changes;
    std::thread{[this] { lose_log(); }}.join();
    CHECK(listener.changes == changes + 1);
    CHECK(bell.calls == before + 1);
    CHECK(current().size() == 1); // not yet
    server.handle_completions(now);
    CHECK(current().size() == 2);
    // What changes nothing is not told.
    happen(Happening{RecordKind::ServerStarted});
    lose_log();
    CHECK(listener.changes == changes + 1);
}

TEST_CASE("ErrorState follows the highest level of what stands (6-2-1, 9-1-2)")
{
    using Events = std::vector<MachineEvent>;
    const auto minor = event_of(EventLevel::MinorFault);
    CHECK(error_state_of({}) == ErrorState::NoError);
    CHECK(error_state_of(Events{event_of(EventLevel::Observation)}) == ErrorState::NoError);
    CHECK(error_state_of(Events{event_of(EventLevel::Observation), minor}) ==
          ErrorState::ContinuousError);
    CHECK(error_state_of(Events{event_of(EventLevel::PartialFault)}) ==
          ErrorState::ContinuousError);
    CHECK(error_state_of(Events{minor, event_of(EventLevel::MajorFault)}) ==
          ErrorState::MajorFault);
}

} // namespace machine_error_nodes_test
