#include <catch2/catch.hpp>

#include <thread>

#include "method_fixture.hpp"

namespace method_late_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using busbar::server::MethodCall;

namespace {

struct Fixture : MethodFixture {
    using MethodFixture::MethodFixture;

    const NodeId slow = add_slow("Slow");
    const CallRequest one = request({to_call(slow, {Variant{7}})});

    static Result<CallResponse> take(TestClient& client, std::uint32_t id)
    {
        return client.take<CallResponse>(id);
    }
    static StatusCode fault(TestClient& client, std::uint32_t id)
    {
        const auto response = take(client, id);
        return response ? status::Good : response.error();
    }
    void complete(TestClient& client)
    {
        server.handle_completions(now);
        client.run();
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "a Method that is answered later blocks nobody")
{
    auto client = log_in();
    const auto id = client.send(one);
    CHECK(fault(client, id) == status::Bad_WouldBlock);
    CHECK(use(client) == status::Good);
    REQUIRE(calls.size() == 1);
    CHECK(calls[0].input<std::int32_t>(0) == 7);
    calls[0].succeed({Variant{8}});
    calls[0].fail(status::Bad_DeviceFailure); // too late
    complete(client);
    const auto response = take(client, id);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Good);
    CHECK(response->results[0].output_arguments == Array<Variant>{Variant{8}});
}

TEST_CASE_METHOD(Fixture, "the Methods of one Call are answered one by one, and sent together")
{
    const NodeId now_method =
        add("Now", {}, {}, [](MethodCall call) { call.fail(status::Bad_OutOfService); });
    auto client = log_in();
    const auto id =
        client.send(request({to_call(slow, {Variant{1}}), to_call(now_method), to_call(own("No")),
                             to_call(slow, {Variant{2}}), to_call(slow, {Variant{3}})}));
    REQUIRE(calls.size() == 3);
    calls[2].succeed({Variant{30}});
    calls[0].fail(status::Bad_DeviceFailure);
    complete(client);
    CHECK(fault(client, id) == status::Bad_WouldBlock);
    calls.clear(); // the one that is left is dropped
    complete(client);
    const auto response = take(client, id);
    REQUIRE(response);
    REQUIRE(response->results.size() == 5);
    CHECK(response->results[0].status_code == status::Bad_DeviceFailure);
    CHECK(response->results[1].status_code == status::Bad_OutOfService);
    CHECK(response->results[2].status_code == status::Bad_NodeIdUnknown);
    CHECK(response->results[3].status_code == status::Bad_InternalError);
    CHECK(response->results[4].output_arguments == Array<Variant>{Variant{30}});
}

TEST_CASE_METHOD(Fixture, "Methods are answered from other threads")
{
    auto client = log_in();
    constexpr int count = 20;
    for (int i = 0; i < count; ++i) {
        const unsigned seen = waker_of_test.count();
        const auto id =
            client.send(request({to_call(slow, {Variant{i}}), to_call(slow, {Variant{2 * i}})}));
        REQUIRE(calls.size() == 2);
        const auto answer = [](MethodCall call) {
            call.succeed({Variant{call.input<std::int32_t>(0) + 1}});
        };
        std::thread first{answer, std::move(calls[0])};
        std::thread second{answer, std::move(calls[1])};
        calls.clear();
        waker_of_test.wait(seen);
        complete(client);
        first.join();
        second.join();
        const auto response = take(client, id);
        REQUIRE(response);
        CHECK(response->results[0].output_arguments[0] == Variant{i + 1});
        CHECK(response->results[1].output_arguments[0] == Variant{2 * i + 1});
    }
}

TEST_CASE_METHOD(Fixture, "outputs of a late Method are checked although it was removed meanwhile")
{
    auto client = log_in();
    const auto id = client.send(one);
    REQUIRE(space().remove(space().find(slow)));
    calls[0].succeed({Variant{"text"}});
    complete(client);
    const auto response = take(client, id);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_InternalError);
}

TEST_CASE_METHOD(Fixture, "a Method that takes too long answers Bad_Timeout, the others do not")
{
    struct OtherSource final : server::DataSource {
        void read(server::ReadBatch) override {}
        void call(server::CallBatch batch) override
        {
            batch.results()[0].status = status::Good;
            batch.complete();
        }
    };
    static OtherSource other;
    model::NewMethod method;
    method.source = server.add_source(other);
    add(named("Quick", machine), method);
    auto client = log_in();
    const auto id = client.send(request({to_call(slow, {Variant{1}}), to_call(own("Quick"))}));
    CHECK(client.connection.next_deadline() == now + 5s);
    advance(5s, client);
    const auto response = take(client, id);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_Timeout);
    CHECK(response->results[1].status_code == status::Good);
    calls[0].succeed({Variant{1}}); // harmless
    complete(client);
    CHECK(client.messages.empty());
    CHECK(use(client) == status::Good);
}

TEST_CASE_METHOD(Fixture, "each Method of a Call that ends early is recorded once, with its result",
                 "[unit:Auditing Method]")
{
    const NodeId now_method =
        add("Now", {}, {}, [](MethodCall call) { call.fail(status::Bad_OutOfService); });
    auto client = log_in();
    client.timeout_hint = 1'000;
    log.keeps_records = true;
    client.send(request({to_call(slow, {Variant{1}}), to_call(now_method), to_call(own("No")),
                         to_call(slow, {Variant{2}})}));
    REQUIRE(calls.size() == 2);
    calls[0].succeed({Variant{8}});
    const auto recorded = [this] {
        std::vector<std::string> found;
        for (const std::string& line : std::exchange(log.records, {})) {
            if (line.find("MethodCalled") == 0) {
                found.push_back(line.substr(0, line.find(' ', sizeof "MethodCalled")));
            }
        }
        return found;
    };
    std::string end;
    SECTION("timeout hint")
    {
        advance(1s, client);
        end = "MethodCalled Bad_Timeout";
    }
    SECTION("CloseSession")
    {
        REQUIRE(client.close_session() == status::Good);
        end = "MethodCalled Bad_SessionClosed";
    }
    SECTION("shutdown")
    {
        server.begin_shutdown(now, "maintenance");
        end = "MethodCalled Bad_Shutdown";
    }
    SECTION("a result that comes in time")
    {
        calls[1].fail(status::Bad_DeviceFailure);
        complete(client);
        end = "MethodCalled Bad_DeviceFailure";
    }
    CHECK(recorded() == std::vector<std::string>{"MethodCalled Good",
                                                 "MethodCalled Bad_OutOfService",
                                                 "MethodCalled Bad_NodeIdUnknown", end});
    calls[1].succeed({Variant{9}});
    complete(client);
    CHECK(recorded().empty());
}

TEST_CASE_METHOD(Fixture, "a Method that was done is recorded so, although its source is late",
                 "[unit:Auditing Method]")
{
    auto client = log_in();
    log.keeps_records = true;
    const auto id =
        client.send(request({to_call(slow, {Variant{1}}), to_call(slow, {Variant{2}})}));
    REQUIRE(calls.size() == 2);
    calls[0].succeed({Variant{8}});
    advance(5s, client);
    const auto response = take(client, id);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_Timeout);
    REQUIRE(log.records.size() == 2);
    CHECK(log.records[0].find("MethodCalled Good ") == 0);
    CHECK(log.records[1].find("MethodCalled Bad_Timeout ") == 0);
}

TEST_CASE_METHOD(Fixture, "a Call ends with the client's patience, its session and the server")
{
    auto client = log_in();
    SECTION("timeout hint")
    {
        client.timeout_hint = 1'000;
        const auto id = client.send(one);
        advance(1s, client);
        CHECK(fault(client, id) == status::Bad_Timeout);
    }
    SECTION("Cancel")
    {
        const auto id = client.send(one);
        CancelRequest cancel;
        cancel.request_handle = client.last_handle;
        CHECK(client.call<CancelResponse>(cancel)->cancel_count == 1);
        CHECK(fault(client, id) == status::Bad_RequestCancelledByClient);
    }
    SECTION("CloseSession")
    {
        const auto id = client.send(one);
        REQUIRE(client.close_session() == status::Good);
        CHECK(fault(client, id) == status::Bad_SessionClosed);
    }
    SECTION("shutdown")
    {
        const auto id = client.send(one);
        server.begin_shutdown(now, "maintenance");
        CHECK(fault(client, id) == status::Bad_Shutdown);
        CHECK(client.status_of<CallResponse>(one) == status::Bad_Shutdown);
    }
    // The inputs are still there for whoever works on them.
    REQUIRE(calls.size() == 1);
    CHECK(calls[0].input<std::int32_t>(0) == 7);
    CHECK(calls[0].method_id() == slow);
    calls[0].succeed({Variant{8}});
    complete(client);
    CHECK(client.messages.empty());
}

TEST_CASE("calls may outlive their server")
{
    auto fixture = std::make_unique<Fixture>();
    auto parts = std::deque<MethodCall>{};
    {
        auto client = fixture->log_in();
        client.send(fixture->request({fixture->to_call(fixture->slow, {Variant{"kept"}})}));
        client.send(fixture->one);
        parts = std::move(fixture->calls);
    }
    fixture.reset();
    REQUIRE(parts.size() == 1); // the first one's type was wrong
    CHECK(parts[0].input<std::int32_t>(0) == 7);
    parts[0].succeed({Variant{8}});
}

TEST_CASE("a backend is given only as much as it takes")
{
    struct Parts {
        server::DataSourceOptions options;
        std::vector<MethodCall> calls;
    };
    Parts parts;
    parts.options.max_batches = 1;
    server::MethodTable small{parts.options};
    Fixture fixture;
    model::NewMethod method;
    method.source = fixture.server.add_source(small);
    method.handle = small.add([&](MethodCall call) { parts.calls.push_back(std::move(call)); });
    const NodeId node = fixture.add(Fixture::named("Small", fixture.machine), method);
    auto client = fixture.log_in();
    const auto first = client.send(Fixture::request({Fixture::to_call(node)}));
    CHECK(Fixture::status_of(client, Fixture::to_call(node)) == status::Bad_TooManyOperations);
    parts.calls.front().succeed();
    fixture.complete(client);
    CHECK(Fixture::take(client, first)->results[0].status_code == status::Good);
}

} // namespace method_late_test
