#include <catch2/catch.hpp>

#include <memory>
#include <optional>
#include <vector>

#include "support/source_caller.hpp"

namespace data_source_end_test {

using namespace busbar;
using namespace busbar::server;
using busbar::server::detail::DataSources;
using busbar::server::detail::SourceEntry;
using busbar::server::detail::SourceRead;

namespace {

/// Keeps its batches, and knows who wakes for it.
struct ToldSource final : DataSource {
    void read(ReadBatch batch) override { reads.push_back(std::move(batch)); }
    void attach(Waker* w) override
    {
        waker = w;
        ++attachments;
    }

    Waker* waker{nullptr};
    int attachments{0};
    std::vector<ReadBatch> reads;
};

struct Owner final : server::detail::SourceCallOwner {
    int completed{0};
    void call_completed() override { ++completed; }
};

/// True if the call of source 0 has its answer at once.
bool start(SourceRead& call, Owner& owner)
{
    call.ask(0, 0, {1, nullptr});
    return call.start(owner, TimePoint{}, [](auto&) {});
}

} // namespace

TEST_CASE("a source that is declared before its server is told of the server's end")
{
    ToldSource source;
    test::TestWaker waker;
    {
        DataSources sources{&waker};
        CHECK(sources.add(source) == 0);
        CHECK(source.waker == &waker);
        CHECK(source.attachments == 1);
    }
    CHECK(source.waker == nullptr);
    CHECK(source.attachments == 2);
}

TEST_CASE("a source that is declared behind its server is called as long as it is there")
{
    test::TestWaker waker;
    DataSources sources{&waker};
    Owner owner;
    std::optional<SourceRead> before;
    {
        ToldSource source;
        CHECK(sources.add(source) == 0);
        before.emplace(sources, 1U);
        CHECK_FALSE(start(*before, owner));
        CHECK(source.reads.size() == 1);
    }
    // What it had not answered ended with it.
    CHECK(waker.count() == 1);
    sources.handle_completions();
    CHECK(owner.completed == 1);
    CHECK(before->result(0).status == status::Bad_NoCommunication);
    before.reset();

    SourceRead after{sources, 1};
    CHECK(start(after, owner));
    CHECK(after.result(0).status == status::Bad_NoCommunication);
    CHECK(owner.completed == 1);
}

TEST_CASE("a batch may outlive both its source and its server")
{
    std::vector<ReadBatch> kept;
    auto sources = std::make_unique<DataSources>(nullptr);
    auto source = std::make_unique<ToldSource>();
    sources->add(*source);
    Owner owner;
    auto call = std::make_unique<SourceRead>(*sources, 1);
    CHECK_FALSE(start(*call, owner));
    kept = std::move(source->reads);
    const bool is_source_first = GENERATE(true, false);
    if (is_source_first) {
        source.reset();
    }
    call.reset();
    sources.reset();
    source.reset();
    REQUIRE(kept.size() == 1);
    kept[0].results()[0] = ReadSlot{status::Good};
    kept.clear();
    CHECK(owner.completed == 0);
}

TEST_CASE("a source of two servers ends for both of them")
{
    DataSources one{nullptr};
    DataSources other{nullptr};
    auto source = std::make_unique<ToldSource>();
    CHECK(one.add(*source) == 0);
    CHECK(other.add(*source) == 0);
    CHECK((*one.find(0))->is_attached());
    source.reset();
    for (DataSources* sources : {&one, &other}) {
        const SourceEntry& entry = **sources->find(0);
        CHECK_FALSE(entry.is_attached());
        bool is_called = false;
        CHECK(entry.guard("DataSource::read", [&](DataSource&) { is_called = true; }) ==
              status::Bad_NoCommunication);
        CHECK_FALSE(is_called);
        CHECK(entry.process_image() == nullptr);
        sources->handle_completions();
        ToldSource next;
        CHECK(sources->add(next) == 1);
        CHECK((*sources->find(1))->is_attached());
    }
}

} // namespace data_source_end_test
