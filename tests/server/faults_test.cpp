#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

#include <busbar/server/process_image.hpp>
#include <busbar/types/view.hpp>

#include "attribute_fixture.hpp"
#include "method_fixture.hpp"
#include "server/subscription/timer_queue.hpp"
#include "session_use.hpp"
#include "subscription_fixture.hpp"
#include "support/job_list.hpp"
#include "thrown.hpp"

namespace faults_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Throws wherever it is told to.
struct BrokenSource final : server::DataSource {
    enum class Where { Nowhere, Read, ReadLate, Write, Monitoring, Image, Attach };

    void read(server::ReadBatch batch) override
    {
        ++reads;
        if (broken == Where::ReadLate) {
            kept.push_back(std::move(batch));
        }
        throw_if(broken == Where::Read || broken == Where::ReadLate);
        for (auto& slot : batch.results()) {
            slot = DataValue{Variant{reads}};
        }
        batch.complete();
    }
    void write(server::WriteBatch batch) override
    {
        throw_if(broken == Where::Write);
        batch.finish(status::Good);
    }
    void monitoring_changed(std::span<const server::Monitoring>) override
    {
        throw_if(broken == Where::Monitoring);
    }
    [[nodiscard]] server::ProcessImage* process_image() override
    {
        throw_if(broken == Where::Image);
        return nullptr;
    }
    void attach(server::Waker*) override { throw_if(broken == Where::Attach); }

    Where broken{Where::Nowhere};
    int reads{0};
    std::vector<server::ReadBatch> kept;
};

struct SourceParts {
    BrokenSource source;
    BrokenSource other;
};

/// A client with two Variables: "bus" of the source that throws, "level" in memory.
struct SourceFixture : SourceParts, SubscriptionFixture {
    SourceFixture()
    {
        model::NewVariable variable;
        variable.source = server.add_source(source);
        variable.data_type = NodeId{0, id::Int32};
        variable.access_level = model::Access::ReadWrite;
        bus = add_variable("bus", variable);
        level = add_variable("level", 7);
        users.everybody.access_level_mask = 0xFF;
    }
    static std::vector<StatusCode> read(TestClient& client, std::initializer_list<NodeId> nodes)
    {
        ReadRequest request;
        for (const NodeId& node : nodes) {
            ReadValueId id;
            id.node_id = node;
            id.attribute_id = 13;
            request.nodes_to_read.push_back(id);
        }
        std::vector<StatusCode> answers;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        for (const DataValue& value : response->results) {
            answers.push_back(value.status);
        }
        return answers;
    }
    static StatusCode write(TestClient& client, const NodeId& node)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = node;
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value.value = 1;
        const auto response = client.call<WriteResponse>(request);
        return response ? response->results[0] : response.error();
    }
    [[nodiscard]] bool has_told(std::string_view callback) const
    {
        return log.text.find(std::string{callback} + " threw: bus error") != std::string::npos;
    }

    NodeId bus;
    NodeId level;
};

using Where = BrokenSource::Where;
using Codes = std::vector<StatusCode>;

} // namespace

TEST_CASE_METHOD(SourceFixture, "what DataSource::read throws is its items' answer")
{
    TestClient client = log_in();
    source.broken = GENERATE(Where::Read, Where::ReadLate);
    CHECK(read(client, {level, bus}) == Codes{status::Good, status::Bad_InternalError});
    CHECK(has_told("DataSource::read"));
    source.broken = Where::Nowhere;
    source.kept.clear(); // a batch that is completed late does no harm
    server.handle_completions(now);
    CHECK(read(client, {level, bus}) == Codes{status::Good, status::Good});
}

TEST_CASE_METHOD(SourceFixture, "what DataSource::write throws is the Write's answer")
{
    TestClient client = log_in();
    source.broken = Where::Write;
    CHECK(write(client, bus) == status::Bad_InternalError);
    CHECK(has_told("DataSource::write"));
    source.broken = Where::Nowhere;
    CHECK(write(client, bus) == status::Good);
}

TEST_CASE_METHOD(SourceFixture, "a sample that throws ends neither sampling nor the others")
{
    TestClient client = log_in();
    const auto subscription = subscribe(client);
    monitor(client, subscription, item_request(level, 1));
    monitor(client, subscription, item_request(bus, 2));
    CHECK(next_data(client, 100ms).size() == 2);
    source.broken = Where::Read;
    set(0, 8);
    bool has_level = false;
    bool has_fault = false;
    for (int i = 0; i < 4; ++i) {
        for (const auto& change : next_data(client, 50ms)) {
            has_level = has_level || change.client_handle == 1;
            has_fault = has_fault || change.value.status == status::Bad_InternalError;
        }
    }
    CHECK(has_level);
    CHECK(has_fault);
    CHECK(has_told("DataSource::read"));
    source.broken = Where::Nowhere;
    CHECK(next_data(client, 100ms).size() + next_data(client, 100ms).size() > 0);
}

TEST_CASE_METHOD(SourceFixture, "what a source throws when it is told things is logged")
{
    TestClient client = log_in();
    const auto subscription = subscribe(client);
    source.broken = Where::Monitoring;
    CHECK(monitor(client, subscription, item_request(bus)).status_code == status::Good);
    CHECK(has_told("DataSource::monitoring_changed"));
    source.broken = Where::Image;
    CHECK(monitor(client, subscription, item_request(bus)).status_code == status::Good);
    CHECK(next_data(client, 100ms).size() == 2);
    CHECK(has_told("DataSource::process_image"));
    source.broken = Where::Attach; // and so it does when the server ends
    other.broken = Where::Attach;
    server.add_source(other);
    CHECK(has_told("DataSource::attach"));
}

TEST_CASE("a Method that throws answers Bad_InternalError, the others of the Call as ever")
{
    MethodFixture fixture;
    const NodeId broken = fixture.add("Broken", {}, {}, [](server::MethodCall) { throw_if(true); });
    const NodeId sum = fixture.add_sum();
    TestClient client = fixture.log_in();
    const auto response = client.call<CallResponse>(
        MethodFixture::request({MethodFixture::to_call(broken), MethodFixture::to_call(sum, {1, 2}),
                                MethodFixture::to_call(broken)}));
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_InternalError);
    CHECK(response->results[1].status_code == status::Good);
    CHECK(response->results[1].output_arguments[0] == Variant{3});
    CHECK(response->results[2].status_code == status::Bad_InternalError);
    CHECK(fixture.log.text.find("MethodTable::Function threw: bus error") != std::string::npos);
}

TEST_CASE("a login whose UserStore throws answers Bad_InternalError, and is no wrong guess")
{
    ServerFixture fixture;
    TestClient client = fixture.connect("Basic256Sha256", MessageSecurityMode::Sign);
    REQUIRE(client.create_session());
    for (int i = 0; i < 20; ++i) {
        fixture.users.is_broken = true;
        CHECK(client.activate(client.user("operator", "operator-secret")) ==
              status::Bad_InternalError);
    }
    CHECK(fixture.log.text.find("UserStore::log_in threw: bus error") != std::string::npos);
    fixture.users.is_broken = false;
    CHECK(client.activate(client.user("operator", "operator-secret")) == status::Good);

    TestClient other = fixture.connect();
    REQUIRE(other.create_session());
    fixture.users.is_broken = true;
    CHECK(other.activate(TestClient::anonymous()) == status::Bad_InternalError);
    CHECK(fixture.log.text.find("UserStore::anonymous threw: bus error") != std::string::npos);
    fixture.users.is_broken = false;
    CHECK(other.activate(TestClient::anonymous()) == status::Good);
    CHECK(use(other) == status::Good);
}

TEST_CASE("a log that throws loses its lines and nothing else")
{
    ServerFixture fixture;
    fixture.log.is_broken = true;
    TestClient client = fixture.log_in();
    CHECK(use(client) == status::Good);
    CHECK(client.close_session() == status::Good);
    fixture.server.begin_shutdown(fixture.now, "the end");
    fixture.log.is_broken = false;
}

namespace {

struct CountingTimer final : server::detail::Timer {
    void expire(TimePoint) override
    {
        ++expired;
        throw_if(is_broken);
    }
    int expired{0};
    bool is_broken{false};
};

} // namespace

TEST_CASE("a timer that throws leaves the others to the next call")
{
    server::detail::TimerQueue queue;
    CountingTimer timers[4];
    timers[1].is_broken = true;
    for (int i = 0; i < 4; ++i) {
        queue.set(timers[i], TimePoint{1s + i * 1ms});
    }
    CHECK_THROWS(queue.expire(TimePoint{2s}));
    CHECK(timers[2].expired == 0);
    CHECK(queue.next_deadline() == TimePoint::min());
    queue.cancel(timers[3]);
    queue.expire(TimePoint{2s});
    for (int i = 0; i < 3; ++i) {
        CHECK(timers[i].expired == 1);
    }
    CHECK(timers[3].expired == 0);
    CHECK(queue.next_deadline() == no_deadline);
}

TEST_CASE("who raises an event is not told what the Waker throws, and the event is there")
{
    struct BrokenWaker final : server::Waker {
        void wake() override { throw_if(true); }
    };
    FixedWallClock clock;
    BrokenWaker waker;
    server::EventQueue queue{clock, &waker, 4};
    CHECK(queue.raise(server::Event{}));
    server::Event event;
    CHECK(queue.next(event));
    queue.close(); // which waits for those who raise
}

TEST_CASE_METHOD(AttributeFixture, "an answer that throws leaves the others to the next call")
{
    struct ThrowingOwner final : server::detail::SourceCallOwner {
        void call_completed() override { throw_if(true); }
    };
    struct KeepingSource final : server::DataSource {
        void read(server::ReadBatch batch) override { kept.push_back(std::move(batch)); }
        std::vector<server::ReadBatch> kept;
    };
    auto& source = make_source<KeepingSource>();
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.source = sources.add(source);
    const ReadRequest request = read_request({read_value_id(add("Far", variable))});
    ThrowingOwner broken;
    auto first = read_job(request);
    auto second = read_job(request);
    REQUIRE_FALSE(first.start(broken, TimePoint{}));
    REQUIRE_FALSE(second.start(owner, TimePoint{}));
    for (auto& batch : source.kept) {
        batch.complete();
    }
    CHECK_THROWS_AS(sources.handle_completions(), std::runtime_error);
    CHECK(owner.completed == 0);
    sources.handle_completions();
    CHECK(owner.completed == 1);
}

TEST_CASE("a PLC task that publishes a scan is not told what the Waker throws")
{
    struct BrokenWaker final : server::Waker {
        void wake() override
        {
            ++calls;
            throw_if(true);
        }
        int calls{0};
    };
    BrokenWaker waker;
    server::ImageLayout layout;
    REQUIRE(layout.add({BuiltInType::Int32, {}, 0}));
    const auto image = server::ProcessImage::create(layout);
    {
        server::ImageSource source{image};
        source.attach(&waker); // and the destructor waits for those who wake
        image->halt();
        CHECK(waker.calls == 1);
    }
    CHECK(waker.calls == 2);
}

namespace {

class BrokenWorker final : public server::Worker {
public:
    [[nodiscard]] bool run(std::function<void()>) override
    {
        throw_if(true);
        return false;
    }
};

} // namespace

TEST_CASE("a worker that throws ends the connection that it was to work for")
{
    SilentWaker waker;
    BrokenWorker worker;
    ServerFixture fixture{waker, &worker};
    auto other = fixture.log_in();
    auto client = fixture.connect(setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt));
    CHECK(client.is_closed());
    CHECK(fixture.log.text.find("Worker::run threw: bus error") != std::string::npos);
    CHECK(use(other) == status::Good);
}

} // namespace faults_test
