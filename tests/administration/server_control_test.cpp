#include <chrono>

#include <busbar/types/enumerations.hpp>

#include "managed_fixture.hpp"

namespace server_control_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct Control : ManagedFixture {
    explicit Control(Restart how = Restart::ByEnding, server::Worker* worker = nullptr)
        : ManagedFixture{worker, administration::Authorities::Standard, how}
    {
    }
    std::string_view request(TestClient& client, ServerState state, std::uint32_t seconds = 10,
                             bool restarts = false, const char* reason = "maintenance")
    {
        const DateTime tomorrow{today.ticks + 86'400 * DateTime::ticks_per_second};
        return name(
            call(client, NodeId{0, id::Server}, NodeId{0, id::Server_RequestServerStateChange},
                 {Variant{static_cast<std::int32_t>(state)}, Variant{tomorrow}, Variant{seconds},
                  Variant{LocalizedText{"en", reason}}, Variant{restarts}})
                .status_code);
    }
};

struct WithoutRestart : Control {
    WithoutRestart() : Control{Restart::Not} {}
};

struct Replacing : Control {
    Replacing() : Control{Restart::ByReplacing} {}
};

/// A program that goes on without its server.
struct GoingOn : Control {
    GoingOn() : Control{Restart::ByGoingOn} {}
};

} // namespace

TEST_CASE_METHOD(Control, "server control: an administrator stops the server",
                 "[unit:Base Info RequestServerStateChange Method]")
{
    auto admin = log_in();
    CHECK(request(admin, ServerState::Shutdown, 86'401) == "Bad_OutOfRange");
    CHECK(stops == 0);
    CHECK(request(admin, ServerState::Shutdown) == "Good");
    CHECK(
        read(admin, id::Server_ServerStatus_SecondsTillShutdown).value.value_or<std::uint32_t>(0) ==
        10);
    CHECK(read(admin, id::Server_ServiceLevel).value == Variant{std::uint8_t{0}});
    CHECK(read(admin, id::Server_EstimatedReturnTime).value.value_or<DateTime>({}) > today);
    CHECK(stops == 0);
    advance(10s);
    CHECK(stops == 1);
    CHECK(admin.is_closed());
    CHECK(log.text.find("maintenance") != std::string::npos);
}

TEST_CASE_METHOD(Control, "server control: a shutdown that counts down is taken back")
{
    auto admin = log_in();
    const auto state = [&] { return read(admin, id::Server_ServerStatus_State).value; };
    CHECK(request(admin, ServerState::Shutdown) == "Good");
    CHECK(state() == Variant{ServerState::Shutdown});
    advance(9s);
    CHECK(request(admin, ServerState::Suspended) == "Bad_InvalidState");
    CHECK(request(admin, ServerState::Running) == "Good");
    CHECK(state() == Variant{ServerState::Running});
    advance(60s);
    CHECK(stops == 0);
    CHECK_FALSE(admin.is_closed());
    auto another = log_in();
    // A restart that ends the program is one, too; the latest request counts.
    CHECK(request(another, ServerState::Running, 10, true) == "Good");
    CHECK(request(another, ServerState::Running) == "Good");
    CHECK(request(another, ServerState::Shutdown, 3'600) == "Good");
    CHECK(request(another, ServerState::Shutdown, 1) == "Good");
    advance(1s);
    CHECK(stops == 1);
    CHECK(restarts == 0);
}

TEST_CASE_METHOD(Control, "server control: a shutdown waits for nobody when all have left")
{
    {
        auto admin = log_in();
        CHECK(request(admin, ServerState::Shutdown, 3'600) == "Good");
    }
    CHECK(server.is_stopped());
    CHECK(server.next_deadline() <= now);
    advance(0s);
    CHECK(stops == 1);
}

TEST_CASE_METHOD(WithoutRestart, "server control: a reset of what cannot start again ends it")
{
    auto admin = log_in();
    CHECK(name(call(admin, NodeId{0, id::ServerConfiguration},
                    NodeId{0, id::ServerConfiguration_ResetToServerDefaults}, {})
                   .status_code) == "Good");
    CHECK(stops == 1);
}

TEST_CASE_METHOD(Control, "server control: the end after a reset is not taken back")
{
    auto admin = log_in();
    CHECK(name(call(admin, NodeId{0, id::ServerConfiguration},
                    NodeId{0, id::ServerConfiguration_ResetToServerDefaults}, {})
                   .status_code) == "Good");
    CHECK(restarts == 1);
    CallRequest running;
    running.methods_to_call.resize(1);
    CHECK(name(admin.status_of<CallResponse>(running)) == "Bad_Shutdown");
}

TEST_CASE_METHOD(Control, "server control: is not for everybody")
{
    REQUIRE(user_list.add({"pat", {}, 0, {}, {"Engineer"}}, "patience is all", random));
    auto pat = log_in("pat", "patience is all");
    CHECK(request(pat, ServerState::Shutdown).starts_with("Bad_"));
    CHECK(stops == 0);
}

TEST_CASE_METHOD(Control, "server control: an administrator suspends the server, and has it go on")
{
    auto admin = log_in();
    const auto state = [&] { return read(admin, id::Server_ServerStatus_State).value; };
    const auto back = [&] { return read(admin, id::Server_EstimatedReturnTime).value; };
    CHECK(request(admin, ServerState::Running) == "Good");
    CHECK(back() == Variant{today}); // nothing has changed
    // Seconds are not looked at.
    CHECK(request(admin, ServerState::Suspended, UINT32_MAX) == "Good");
    CHECK(state() == Variant{ServerState::Suspended});
    CHECK(read(admin, id::Server_ServiceLevel).value == Variant{std::uint8_t{0}});
    CHECK(back().value_or<DateTime>({}) > today);
    CHECK(request(admin, ServerState::Failed) == "Good");
    CHECK(state() == Variant{ServerState::Failed});
    CHECK(read(admin, id::Server_ServiceLevel).value == Variant{std::uint8_t{1}});
    auto again = log_in();
    CHECK(request(again, ServerState::Running) == "Good");
    CHECK(state() == Variant{ServerState::Running});
    CHECK(back() == Variant{DateTime{}});
    CHECK(read(admin, id::Server_ServiceLevel).value == Variant{std::uint8_t{255}});
    CHECK(stops + restarts == 0);
}

TEST_CASE_METHOD(Control, "server control: refuses what is no state to be asked for")
{
    auto admin = log_in();
    for (const ServerState state : {ServerState::NoConfiguration, ServerState::Test,
                                    ServerState::CommunicationFault, ServerState::Unknown}) {
        CHECK(request(admin, state) == "Bad_InvalidState");
    }
    for (const std::int32_t number : {8, 9, -1, INT32_MAX}) { // Part 4, 5.12.2.4
        CHECK(request(admin, static_cast<ServerState>(number)) == "Bad_InvalidArgument");
    }
    CHECK(request(admin, ServerState::Suspended, 0, true) == "Bad_InvalidState");
    CHECK(request(admin, ServerState::Failed, 0, true) == "Bad_InvalidState");
    const std::string long_reason(257, 'a');
    CHECK(request(admin, ServerState::Suspended, 0, false, long_reason.c_str()) ==
          "Bad_OutOfRange");
    CHECK(read(admin, id::Server_ServerStatus_State).value == Variant{ServerState::Running});
}

TEST_CASE_METHOD(Control, "server control: a restart is an end that the program hears of as one")
{
    auto admin = log_in();
    const ServerState wanted = GENERATE(ServerState::Running, ServerState::Shutdown);
    CHECK(request(admin, wanted, 86'401, true) == "Bad_OutOfRange");
    CHECK(request(admin, wanted, 5, true, "") == "Good");
    CHECK(read(admin, id::Server_ServerStatus_State).value == Variant{ServerState::Shutdown});
    CHECK(log.text.find("an administrator restarts the server") != std::string::npos);
    CHECK(restarts == 0);
    advance(5s);
    CHECK(restarts == 1);
    CHECK(stops == 0);
    CHECK(admin.is_closed());
}

TEST_CASE_METHOD(WithoutRestart, "server control: no restart where the program has none")
{
    auto admin = log_in();
    CHECK(request(admin, ServerState::Running, 0, true) == "Bad_InvalidState");
    CHECK(request(admin, ServerState::Shutdown, 0, true) == "Bad_InvalidState");
    CHECK(request(admin, ServerState::Shutdown, 0) == "Good");
    advance(0s);
    CHECK(stops == 1);
}

TEST_CASE_METHOD(Replacing, "server control: who has another server take over ends this one itself")
{
    auto admin = log_in();
    const ServerState wanted = GENERATE(ServerState::Running, ServerState::Shutdown);
    CHECK(request(admin, wanted, 86'401, true) == "Bad_OutOfRange");
    CHECK_FALSE(wish);
    CHECK(request(admin, wanted, 5, true) == "Good");
    REQUIRE(wish);
    CHECK(wish->reason == "maintenance");
    CHECK(wish->delay == 5s);
    CHECK(wish->return_time > today);
    CHECK(restarts + stops == 0);
    CHECK(read(admin, id::Server_ServerStatus_State).value == Variant{ServerState::Running});
    advance(5s);
    CHECK_FALSE(admin.is_closed());
    CHECK(request(admin, ServerState::Shutdown) == "Good");
    advance(10s);
    CHECK(stops == 1);
}

TEST_CASE_METHOD(Replacing, "server control: a restart that would not work is not promised")
{
    auto admin = log_in();
    refusal = Problem{status::Bad_ConfigurationError, "press.st:2", "found nothing"};
    CHECK(request(admin, ServerState::Running, 5, true) == "Bad_ConfigurationError");
    CHECK_FALSE(wish);
    CHECK(log.text.find("a restart is refused: press.st:2: found nothing") != std::string::npos);
    CHECK(request(admin, ServerState::Suspended) == "Good"); // it is asked for restarts only
    refusal.reset();
    CHECK(request(admin, ServerState::Running, 5, true) == "Good");
    CHECK(wish);
}

TEST_CASE("server control: others are served while a restart is checked")
{
    ManualWorker worker;
    Control control{Control::Restart::ByReplacing, &worker};
    auto admin = control.log_in();
    CallRequest request;
    request.methods_to_call.resize(1);
    CallMethodRequest& method = request.methods_to_call[0];
    method.object_id = NodeId{0, id::Server};
    method.method_id = NodeId{0, id::Server_RequestServerStateChange};
    method.input_arguments = {Variant{static_cast<std::int32_t>(ServerState::Running)},
                              Variant{DateTime{}}, Variant{5U}, Variant{LocalizedText{}},
                              Variant{true}};
    const auto ask = [&] {
        const auto sent = admin.send(request);
        control.complete();
        CHECK(control.read(admin, id::Server_ServerStatus_State).value ==
              Variant{ServerState::Running});
        CHECK_FALSE(control.wish);
        return sent;
    };
    auto sent = ask();
    control.refusal = Problem{status::Bad_ConfigurationError, "press.st:2", "found nothing"};
    worker.work();
    control.complete();
    auto response = admin.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Bad_ConfigurationError");
    CHECK_FALSE(control.wish);

    control.refusal.reset();
    sent = ask();
    worker.work();
    control.complete();
    response = admin.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Good");
    CHECK(control.wish);

    // Who was told meanwhile that the server stops finds that it does, and that alone.
    control.wish.reset();
    static_cast<void>(ask());
    control.server.begin_shutdown(control.now, "another reason");
    worker.work();
    control.complete();
    CHECK_FALSE(control.wish);
}

TEST_CASE_METHOD(GoingOn,
                 "server control: a program that goes on keeps its server for administrators")
{
    auto admin = log_in();
    CHECK(request(admin, ServerState::Shutdown, 5) == "Good");
    CHECK(told_reason.empty());
    advance(5s);
    CHECK(told_reason == "maintenance");
    CHECK(stops == 0);
    CHECK(admin.is_closed());
    auto again = log_in();
    CHECK(read(again, id::Server_ServerStatus_State).value == Variant{ServerState::Failed});
    out = Problem{status::Bad_InvalidState, "the server", "is shut down"};
    CHECK(request(again, ServerState::Running) == "Bad_InvalidState");
    out.reset();
    CHECK(request(again, ServerState::Running) == "Good");
    CHECK(read(again, id::Server_ServerStatus_State).value == Variant{ServerState::Running});
    // A reset has the program start again all the same.
    CHECK(name(call(again, NodeId{0, id::ServerConfiguration},
                    NodeId{0, id::ServerConfiguration_ResetToServerDefaults}, {})
                   .status_code) == "Good");
    CHECK(restarts == 1);
    CHECK(stops == 0);
}

TEST_CASE_METHOD(Control, "server control: who gives no reason has the usual one told")
{
    auto admin = log_in();
    CHECK(request(admin, ServerState::Suspended, 0, false, "") == "Good");
    CHECK(log.text.find("an administrator changed the state of the server") != std::string::npos);
    CHECK(request(admin, ServerState::Running, 0, false, "") == "Good");
    CHECK(log.text.find("an administrator lets the server continue") != std::string::npos);
    CHECK(request(admin, ServerState::Shutdown, 10, false, "") == "Good");
    CHECK(read(admin, id::Server_ServerStatus_ShutdownReason)
              .value.value_or<LocalizedText>({})
              .text.view() == "an administrator stops the server");
}

TEST_CASE_METHOD(Control, "server control: one Call that stops the server twice stops it once")
{
    auto admin = log_in();
    CallRequest twice;
    twice.methods_to_call.resize(2);
    for (CallMethodRequest& one : twice.methods_to_call) {
        one.object_id = NodeId{0, id::Server};
        one.method_id = NodeId{0, id::Server_RequestServerStateChange};
        one.input_arguments = {Variant{static_cast<std::int32_t>(ServerState::Shutdown)},
                               Variant{DateTime{}}, Variant{std::uint32_t{10}},
                               Variant{LocalizedText{}}, Variant{false}};
    }
    const auto sent = admin.send(twice);
    complete();
    const auto response = admin.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Good");
    CHECK(
        read(admin, id::Server_ServerStatus_SecondsTillShutdown).value.value_or<std::uint32_t>(0) ==
        10);
    advance(10s);
    CHECK(stops == 1);
    CHECK(admin.is_closed());
}

} // namespace server_control_test
