#include <catch2/catch.hpp>

#include <deque>
#include <thread>

#include "support/source_caller.hpp"

namespace data_source_test {

using namespace busbar;
using namespace busbar::server;
using namespace std::chrono_literals;
using busbar::server::detail::DataSources;
using busbar::server::detail::SourceRead;
using busbar::server::detail::SourceWrite;

namespace {

/// Keeps its batches until the test answers them.
class SlowSource final : public DataSource {
public:
    DataSourceOptions options() const override { return options_; }
    void read(ReadBatch batch) override { reads.push_back(std::move(batch)); }
    void write(WriteBatch batch) override { writes.push_back(std::move(batch)); }

    /// Answers the oldest Read: each value is its handle.
    void answer()
    {
        fill(reads.front());
        reads.pop_front();
    }
    static void fill(ReadBatch& batch)
    {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            batch.results()[i] = DataValue{Variant{batch.items()[i].handle}};
        }
        batch.complete();
    }

    DataSourceOptions options_;
    std::deque<ReadBatch> reads;
    std::deque<WriteBatch> writes;
};

/// Answers at once: each value is its handle.
class FastSource final : public DataSource {
public:
    void read(ReadBatch batch) override
    {
        ++reads;
        SlowSource::fill(batch);
    }
    int reads{0};
};

struct Owner final : server::detail::SourceCallOwner {
    int completed{0};
    void call_completed() override { ++completed; }
};

constexpr auto no_preparation = [](auto&) {};
const TimePoint start_time{1s};

struct Fixture {
    Fixture() : sources{std::make_unique<DataSources>(&waker)}
    {
        sources->add(slow);
        sources->add(fast);
    }
    std::unique_ptr<SourceRead> ask(std::initializer_list<std::uint32_t> source_of_item)
    {
        auto call = std::make_unique<SourceRead>(*sources, source_of_item.size());
        std::size_t i = 0;
        for (const std::uint32_t source : source_of_item) {
            call->ask(i, source, {100 + i, nullptr});
            ++i;
        }
        return call;
    }

    test::TestWaker waker;
    SlowSource slow;
    FastSource fast;
    Owner owner;
    std::unique_ptr<DataSources> sources;
};

std::uint64_t number(const SourceRead& call, std::size_t index)
{
    return call.result(index).value.value_or<std::uint64_t>(0);
}

} // namespace

TEST_CASE_METHOD(Fixture, "a source that answers at once needs no waker")
{
    const auto call = ask({1, 1, 1});
    REQUIRE(call->start(owner, start_time, no_preparation));
    CHECK(fast.reads == 1);
    CHECK(number(*call, 2) == 102);
    CHECK(call->result(2).status == status::Good);
    CHECK(waker.count() == 0);
    CHECK(owner.completed == 0);
    CHECK(call->next_deadline() == no_deadline);
}

TEST_CASE_METHOD(Fixture, "the items of a call reach each source in one batch and in order")
{
    const auto call = ask({1, 0, 1, 0, 0, 1});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    CHECK(fast.reads == 1);
    REQUIRE(slow.reads.size() == 1);
    REQUIRE(slow.reads[0].size() == 3);
    CHECK(slow.reads[0].items()[1].handle == 103);
    slow.answer();
    CHECK(waker.count() == 1);
    CHECK(owner.completed == 0);
    sources->handle_completions();
    CHECK(owner.completed == 1);
    for (std::size_t i = 0; i < 6; ++i) {
        CHECK(number(*call, i) == 100 + i);
    }
}

TEST_CASE_METHOD(Fixture, "answers of the server stand among those of the sources")
{
    SourceRead call{*sources, 4};
    call.ask(2, 0, {7, nullptr});
    call.answer(0) = DataValue{Variant{std::uint64_t{1}}};
    call.ask(1, 1, {8, nullptr});
    call.answer(3) = DataValue{status::Bad_NodeIdUnknown};
    REQUIRE_FALSE(call.start(owner, start_time, no_preparation));
    slow.answer();
    sources->handle_completions();
    CHECK(number(call, 0) == 1);
    CHECK(number(call, 1) == 8);
    CHECK(number(call, 2) == 7);
    CHECK(call.result(3).status == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(Fixture, "a batch completes from another thread")
{
    const auto call = ask({0, 0});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    std::thread plc{[&] { slow.answer(); }};
    waker.wait(0);
    sources->handle_completions();
    plc.join();
    CHECK(owner.completed == 1);
    CHECK(number(*call, 1) == 101);
}

TEST_CASE("a batch that completes while it is being given away is taken once")
{
    /// Its thread answers as fast as it can, before or after DataSource::read has returned.
    class RacingSource final : public DataSource {
    public:
        ~RacingSource() override { join(); }
        void read(ReadBatch batch) override
        {
            join();
            thread_ = std::thread{[b = std::move(batch)]() mutable { SlowSource::fill(b); }};
        }
        void join()
        {
            if (thread_.joinable()) {
                thread_.join();
            }
        }

    private:
        std::thread thread_;
    };
    RacingSource source;
    test::SourceCaller caller{source};
    for (std::uint64_t i = 0; i < 500; ++i) {
        REQUIRE(caller.read({i})[0].value == Variant{i});
    }
}

TEST_CASE_METHOD(Fixture, "a dropped batch answers with what it has")
{
    const auto call = ask({0, 0});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    slow.reads[0].results()[0] = DataValue{Variant{std::uint64_t{5}}};
    slow.reads.clear();
    sources->handle_completions();
    CHECK(number(*call, 0) == 5);
    CHECK(call->result(1).status == status::Bad_NoCommunication);
}

TEST_CASE_METHOD(Fixture, "a source can fail a whole batch")
{
    const auto call = ask({0, 1, 0});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    slow.reads[0].fail(status::Bad_DeviceFailure);
    CHECK(slow.reads[0].size() == 0);
    slow.reads[0].complete(); // does nothing
    sources->handle_completions();
    CHECK(call->result(0).status == status::Bad_DeviceFailure);
    CHECK(call->result(2).status == status::Bad_DeviceFailure);
    CHECK(number(*call, 1) == 101);
}

TEST_CASE_METHOD(Fixture, "a late source answers Bad_Timeout and may still write into its slots")
{
    const auto call = ask({0, 1});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    CHECK(call->next_deadline() == start_time + 5s);
    CHECK_FALSE(call->handle_deadline(start_time + 4999ms));
    CHECK(call->handle_deadline(start_time + 5s));
    CHECK(call->result(0).status == status::Bad_Timeout);
    CHECK(number(*call, 1) == 101);
    slow.answer();
    CHECK(waker.count() == 0);
    sources->handle_completions();
    CHECK(owner.completed == 0);
    CHECK(call->result(0).status == status::Bad_Timeout);
}

TEST_CASE_METHOD(Fixture, "batches outlive their call, the server and the source's registration")
{
    auto kept = std::make_shared<int>(7);
    const std::weak_ptr<int> watch = kept;
    auto call = ask({0});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    SECTION("the call is gone")
    {
        call.reset();
    }
    SECTION("the call is gone with its answer in the queue")
    {
        slow.reads[0].keep_alive(std::move(kept));
        slow.answer();
        call.reset();
        sources->handle_completions();
    }
    SECTION("everything is gone with the answer in the queue")
    {
        slow.answer();
        call.reset();
        sources.reset();
    }
    SECTION("everything is gone")
    {
        call.reset();
        sources.reset();
        slow.reads[0].keep_alive(std::move(kept));
    }
    if (!slow.reads.empty()) {
        slow.answer();
    }
    kept.reset();
    CHECK(watch.expired());
    CHECK(owner.completed == 0);
}

TEST_CASE_METHOD(Fixture, "kept memory is held until the call is done with it")
{
    auto memory = std::make_shared<std::string>("a text that lies in the source");
    const std::weak_ptr<std::string> watch = memory;
    auto call = ask({0});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    slow.reads[0].results()[0] = DataValue{Variant{String::borrow(*memory)}};
    slow.reads[0].keep_alive(std::move(memory));
    slow.reads.clear();
    sources->handle_completions();
    CHECK(call->result(0).value == Variant{"a text that lies in the source"});
    CHECK_FALSE(watch.expired());
    call.reset();
    CHECK(watch.expired());
}

TEST_CASE_METHOD(Fixture, "a call that waits for one source owns what the others answered")
{
    /// Lends a value that the test changes behind its back.
    class LendingSource final : public DataSource {
    public:
        void read(ReadBatch batch) override
        {
            batch.results()[0] = DataValue{Variant{}};
            batch.results()[0].shared = &lent;
            batch.keep_alive(kept);
            batch.complete();
        }
        Variant lent{1};
        std::shared_ptr<int> kept{std::make_shared<int>()};
    };
    LendingSource lender;
    sources->add(lender);
    auto call = ask({0, 2});
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    CHECK(lender.kept.use_count() == 1);
    lender.lent = Variant{2};
    slow.answer();
    sources->handle_completions();
    CHECK(call->result(1).shared == nullptr);
    CHECK(call->result(1).value == Variant{1});
    call.reset();
    sources.reset(); // before the lender
}

TEST_CASE("a source is not asked for more than it may hold")
{
    SlowSource source;
    source.options_.max_batches = 2;
    source.options_.max_items = 5;
    test::TestWaker waker;
    DataSources sources{&waker};
    sources.add(source);
    Owner owner;
    const auto send = [&](std::size_t count) {
        auto call = std::make_unique<SourceRead>(sources, count);
        for (std::size_t i = 0; i < count; ++i) {
            call->ask(i, 0, {i, nullptr});
        }
        static_cast<void>(call->start(owner, start_time, no_preparation));
        return call;
    };
    CHECK(send(6)->result(5).status == status::Bad_TooManyOperations);
    auto first = send(3);
    CHECK(send(3)->result(0).status == status::Bad_TooManyOperations);
    auto second = send(2);
    CHECK(send(0)->waiting() == false);
    // A batch that timed out counts for as long as the source holds it.
    CHECK(second->handle_deadline(start_time + 1h));
    second.reset();
    CHECK(send(1)->result(0).status == status::Bad_TooManyOperations);
    source.answer();
    source.answer();
    CHECK(send(5)->waiting());
}

TEST_CASE_METHOD(Fixture, "a source that was refused is not called")
{
    const auto call = ask({1, 0});
    call->refuse(1, status::Bad_InvalidState);
    REQUIRE_FALSE(call->start(owner, start_time, no_preparation));
    CHECK(fast.reads == 0);
    CHECK(call->result(0).status == status::Bad_InvalidState);
}

TEST_CASE_METHOD(Fixture, "one completion may end the calls of others that are queued")
{
    struct Killer final : server::detail::SourceCallOwner {
        std::unique_ptr<SourceRead>* victim{nullptr};
        void call_completed() override { victim->reset(); }
    };
    Killer killer;
    auto first = ask({0});
    auto second = ask({0});
    killer.victim = &second;
    REQUIRE_FALSE(first->start(killer, start_time, no_preparation));
    REQUIRE_FALSE(second->start(owner, start_time, no_preparation));
    slow.answer();
    slow.answer();
    CHECK(waker.count() == 1);
    sources->handle_completions();
    CHECK(second == nullptr);
    CHECK(owner.completed == 0);
}

TEST_CASE_METHOD(Fixture, "a write takes the same way; a read-only source refuses it")
{
    const DataValue data{Variant{1}};
    SourceWrite call{*sources, 3};
    call.ask(0, 0, {1, nullptr, &data});
    call.ask(1, 1, {2, nullptr, &data});
    call.ask(2, 0, {3, nullptr, &data});
    REQUIRE_FALSE(call.start(owner, start_time, no_preparation));
    CHECK(call.result(1) == status::Bad_NotWritable);
    slow.writes[0].results()[1] = status::Good;
    slow.writes.clear();
    sources->handle_completions();
    CHECK(owner.completed == 1);
    CHECK(call.result(0) == status::Bad_NoCommunication);
    CHECK(call.result(2) == status::Good);
}

TEST_CASE("a source that the server keeps hears the end and then ends")
{
    struct Parting final : DataSource {
        Parting(Waker*& waker, int& ends) : waker_{waker}, ends_{ends} {}
        ~Parting() override { ++ends_; }
        void read(ReadBatch batch) override { batch.complete(); }
        void attach(Waker* waker) override { waker_ = waker; }

        Waker*& waker_;
        int& ends_;
    };
    test::TestWaker waker;
    Waker* attached = nullptr;
    int ends = 0;
    auto sources = std::make_unique<DataSources>(&waker);
    CHECK(sources->add(std::make_unique<Parting>(attached, ends)) == 0);
    CHECK(attached == &waker);
    CHECK(ends == 0);
    sources.reset();
    CHECK(attached == nullptr);
    CHECK(ends == 1);
}

} // namespace data_source_test
