#include "mapped_fixture.hpp"

#include <atomic>
#include <thread>

namespace mapped_threads_test {

using namespace busbar;
using namespace busbar::test;

namespace {

/// A PLC with a thread of its own, which answers what has come to its mailbox.
class ThreadedLabels final : public backend::LabelBackend {
public:
    ThreadedLabels() : thread_{[this] { run(); }} {}
    ~ThreadedLabels() override
    {
        {
            const std::lock_guard lock{mutex_};
            is_ending_ = true;
        }
        came_.notify_all();
        thread_.join();
    }
    void start(std::unique_ptr<LabelRequest> request) override
    {
        {
            const std::lock_guard lock{mutex_};
            mailbox_.push_back(std::move(request));
        }
        came_.notify_all();
    }
    void attach(backend::LabelListener* listener) override
    {
        const std::lock_guard lock{listener_mutex_};
        listener_ = listener;
    }
    std::atomic<int> changes_to_tell{0};

private:
    void run()
    {
        std::unique_lock lock{mutex_};
        while (!is_ending_) {
            if (mailbox_.empty()) {
                came_.wait(lock);
                continue;
            }
            auto request = std::move(mailbox_.front());
            mailbox_.pop_front();
            lock.unlock();
            answer(std::move(request));
            lock.lock();
        }
    }
    void answer(std::unique_ptr<LabelRequest> request)
    {
        request->status = LabelStatus::Done;
        request->time = DateTime{++time_};
        for (std::size_t i = 0; i < request->names.size(); ++i) {
            ResolvedLabel label;
            label.error = backend::LabelError::None;
            label.kind = {LabelType::Word};
            label.address = i;
            request->labels.push_back(label);
        }
        const std::lock_guard lock{listener_mutex_};
        if (listener_ != nullptr) {
            if (changes_to_tell > 0) {
                --changes_to_tell;
                listener_->labels_changed();
            }
            listener_->done(std::move(request));
        }
    }

    std::mutex mutex_;
    std::mutex listener_mutex_;
    std::condition_variable came_;
    std::deque<std::unique_ptr<LabelRequest>> mailbox_;
    backend::LabelListener* listener_{nullptr};
    bool is_ending_{false};
    std::int64_t time_{0};
    std::thread thread_;
};

struct Parts {
    Parts() : plc{std::make_shared<ThreadedLabels>()} {}

    TestWaker waker_of_test;
    std::shared_ptr<ThreadedLabels> plc;
    std::unique_ptr<MappedSource> source{std::make_unique<MappedSource>(plc)};
};

struct Fixture : Parts, ServerFixture {
    Fixture() : ServerFixture{waker_of_test}
    {
        users.everybody.access_level_mask = 0xFF;
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int16};
        variable.access_level = model::Access::ReadWrite;
        variable.source = server.add_source(*source);
        controller::ValueDeclaration declaration;
        declaration.data_type = NodeId{0, id::Int16};
        auto shape = controller::ValueShape::of(server.address_space(), types, declaration);
        REQUIRE(shape);
        variable.handle = source->add(MappedVariable{
            node, std::make_shared<const controller::ValueShape>(std::move(*shape)), {"X"}, {}});
        model::NewNode named;
        named.id = node;
        named.browse_name = QualifiedName{1, "x"};
        named.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_variable(named, variable));
    }
    [[nodiscard]] std::uint32_t send(TestClient& client)
    {
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Neither;
        ReadValueId id;
        id.node_id = node;
        id.attribute_id = 13;
        request.nodes_to_read = {id, id};
        return client.send(request);
    }
    [[nodiscard]] static std::uint32_t send_write(TestClient& client, const NodeId& node)
    {
        WriteRequest request;
        WriteValue value;
        value.node_id = node;
        value.attribute_id = 13;
        value.value.value = Variant{std::int16_t{1}};
        request.nodes_to_write = {value};
        return client.send(request);
    }
    template <typename Response>
    Response wait_for(TestClient& client, std::uint32_t id)
    {
        while (true) {
            const unsigned seen = waker_of_test.count();
            server.handle_completions(now);
            const auto response = client.take<Response>(id);
            if (response) {
                return *response;
            }
            REQUIRE(response.error() == status::Bad_WouldBlock);
            waker_of_test.wait(seen);
        }
    }

    binary::DynamicTypes types;
    NodeId node{1, "x"};
};

} // namespace

TEST_CASE("8.3 Data input/output: a PLC answers on a thread of its own", "[8.3]")
{
    for (int round = 0; round < 10; ++round) {
        Fixture fixture;
        fixture.source->start();
        TestClient client = fixture.log_in();
        fixture.plc->changes_to_tell = 3;
        for (int i = 0; i < 20; ++i) {
            const auto read = fixture.send(client);
            const auto write = Fixture::send_write(client, fixture.node);
            const auto read_answer = fixture.wait_for<ReadResponse>(client, read);
            CHECK(read_answer.results[1].status == status::Good);
            const auto written = fixture.wait_for<WriteResponse>(client, write);
            CHECK(written.results[0] == status::Good);
        }
        // All of it ends while requests are on their way.
        static_cast<void>(fixture.send(client));
        static_cast<void>(Fixture::send_write(client, fixture.node));
        if (round % 2 == 0) {
            fixture.source.reset();
        }
    }
}

} // namespace mapped_threads_test
