#include "mapped_fixture.hpp"

#include "support/allocation_count.hpp"

namespace mapped_cost_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct Fixture : MappedFixture {
    Fixture() { plc->sizes.reserve(100); }

    /// Allocations of reading the handles from `first` on.
    std::size_t cost(std::uint64_t first, std::size_t count)
    {
        server::detail::DataSources sources{&waker_of_test};
        sources.add(source);
        server::detail::SourceRead call{sources, count};
        for (std::size_t i = 0; i < count; ++i) {
            call.ask(i, 0, {first + i, nullptr});
        }
        struct Owner final : server::detail::SourceCallOwner {
            void call_completed() override {}
        } owner;
        const std::size_t before = allocation_count();
        REQUIRE(call.start(owner, TimePoint{}, [](auto&) {}));
        const std::size_t allocations = allocation_count() - before;
        CHECK(call.result(count - 1).status == status::Good);
        return allocations;
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "8.3 Read: many scalars cost as many allocations as few", "[8.3]")
{
    plc->add("X", LabelType::Word, std::int16_t{1});
    const auto scalar = shape(id::Int16);
    for (int i = 0; i < 1'000; ++i) {
        static_cast<void>(source.add(MappedVariable{NodeId{1, "x"}, scalar, {"X"}, {}}));
    }
    source.start();
    static_cast<void>(cost(0, 1)); // what is kept from request to request
    const std::size_t few = cost(0, 10);
    CHECK(cost(0, 1'000) == few);
    CHECK(few <= 20);
}

TEST_CASE_METHOD(Fixture, "8.3 Read: arrays cost as many allocations as there are of them", "[8.3]")
{
    plc->add("X", LabelType::Word, std::int16_t{1});
    const auto list = shape(id::Int16, 100);
    for (int i = 0; i < 250; ++i) {
        static_cast<void>(source.add(
            MappedVariable{NodeId{1, "x"}, list, std::vector<std::string>(100, "X"), {}}));
    }
    source.start();
    static_cast<void>(cost(0, 250)); // the first one has values to keep
    const std::size_t all = cost(0, 250);
    // Of each: the value with its shape, and what the Variable keeps.
    CHECK(all <= 20 + 5 * 250);
}

} // namespace mapped_cost_test
