#include <catch2/catch.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "image_fixture.hpp"

namespace image_write_test {

// Writes reach the task at the edge of a scan.

using namespace busbar;
using namespace busbar::server;
using namespace busbar::test;

TEST_CASE_METHOD(ImageFixture, "the writes of a call are applied together at the next scan's edge")
{
    scan();
    const DataValue five = of(std::int16_t{5});
    const DataValue text = of(String{"five"});
    const Pending pending = write({{speed, nullptr, &five}, {name, nullptr, &text}});
    CHECK_FALSE(pending.owner->done);
    image->begin_scan();
    CHECK(image->memory().value<std::int16_t>(speed) == 5);
    CHECK(image->memory().text(name) == "five");
    sources->handle_completions();
    CHECK_FALSE(pending.owner->done); // a Read would not show it yet
    CHECK(waker.count() == 0);
    image->publish(at(2000));
    CHECK(waker.count() == 1);
    sources->handle_completions();
    REQUIRE(pending.owner->done);
    CHECK(pending.result(0) == status::Good);
    CHECK(pending.result(1) == status::Good);
    CHECK(read(speed) == DataValue{Variant{std::int16_t{5}}, {}, at(2000)});
    scan();
    CHECK(waker.count() == 2); // the completion's own; a scan without writes wakes nobody
}

TEST_CASE_METHOD(ImageFixture,
                 "a write that does not fit the variable is refused, the others are done")
{
    scan();
    const DataValue good = of(std::int16_t{5});
    const DataValue wrong = of(std::int32_t{5});
    const DataValue long_text = of(String{"123456789"});
    const DataValue short_array = of(Array<double>{1, 2});
    const DataValue with_status{Variant{std::int16_t{5}}, status::Uncertain_InitialValue};
    const Pending pending = write({{speed, nullptr, &wrong},
                                   {name, nullptr, &long_text},
                                   {speed, nullptr, &good},
                                   {levels, nullptr, &short_array},
                                   {speed, nullptr, &with_status},
                                   {99, nullptr, &good}});
    scan();
    sources->handle_completions();
    REQUIRE(pending.owner->done);
    CHECK(pending.result(0) == status::Bad_TypeMismatch);
    CHECK(pending.result(1) == status::Bad_OutOfRange);
    CHECK(pending.result(2) == status::Good);
    CHECK(pending.result(3) == status::Bad_TypeMismatch);
    CHECK(pending.result(4) == status::Bad_WriteNotSupported);
    CHECK(pending.result(5) == status::Bad_NodeIdUnknown);
    CHECK(read(speed).value == Variant{std::int16_t{5}});

    const Pending hopeless = write({{speed, nullptr, &wrong}});
    CHECK(hopeless.owner->done); // nothing is left to wait for
    CHECK(hopeless.result() == status::Bad_TypeMismatch);
}

namespace {

/// Keeps the writes of some variables, or refuses to.
struct WriteLog final : ImageWriteLog {
    bool keeps(const ProcessImage&, std::uint32_t handle) const override
    {
        return handle != unkept;
    }
    StatusCode keep(const ProcessImage&, std::span<const ImageWrite> writes) override
    {
        for (const ImageWrite& write : writes) {
            kept.push_back({write.handle, write.offset, write.bytes.size()});
        }
        return answer;
    }

    std::uint32_t unkept{UINT32_MAX};
    std::vector<std::array<std::size_t, 3>> kept; // handle, offset, size
    StatusCode answer;
};

} // namespace

TEST_CASE_METHOD(ImageFixture, "a write is kept after it was published and before it is answered")
{
    using Kept = std::vector<std::array<std::size_t, 3>>;
    WriteLog log;
    log.unkept = grid;
    source->keep_writes(&log);
    scan();
    const auto range = NumericRange::parse("1:2").value();
    const DataValue five = of(std::int16_t{5});
    const DataValue text = of(String{"five"});
    const DataValue two = of(Array<double>{8, 9});
    const DataValue wrong = of(std::int32_t{5});
    const DataValue numbers{Variant::matrix(Array<std::uint32_t>(6), Array<std::uint32_t>{2, 3})};
    const Pending pending = write({{speed, nullptr, &five},
                                   {name, nullptr, &text},
                                   {levels, &range, &two},
                                   {speed, nullptr, &wrong},
                                   {grid, nullptr, &numbers}});
    image->begin_scan();
    sources->handle_completions();
    CHECK(log.kept.empty());
    image->publish(at(2000));
    CHECK(log.kept.empty()); // not by the task
    SECTION("kept")
    {
        sources->handle_completions();
        REQUIRE(pending.owner->done);
        CHECK(log.kept == Kept{{speed, 0, 2}, {name, 0, 8}, {levels, 8, 16}});
        CHECK(pending.result(0) == status::Good);
        CHECK(pending.result(2) == status::Good);
        CHECK(pending.result(3) == status::Bad_TypeMismatch);
        CHECK(pending.result(4) == status::Good);
        log.kept.clear();
        CHECK(write_now({grid, nullptr, &numbers}) == status::Good);
        CHECK(log.kept.empty());
    }
    SECTION("refused")
    {
        log.answer = status::Bad_ResourceUnavailable;
        sources->handle_completions();
        REQUIRE(pending.owner->done);
        CHECK(pending.result(0) == status::Bad_ResourceUnavailable);
        CHECK(pending.result(2) == status::Bad_ResourceUnavailable);
        CHECK(pending.result(3) == status::Bad_TypeMismatch);
        CHECK(pending.result(4) == status::Good);
        CHECK(read(speed).value == Variant{std::int16_t{5}});
    }
    SECTION("not applied")
    {
        const Pending late = write({{speed, nullptr, &five}});
        sources->handle_completions();
        log.kept.clear();
        image->halt();
        sources->handle_completions();
        CHECK(late.result() == status::Bad_NoCommunication);
        CHECK(log.kept.empty());
    }
}

TEST_CASE_METHOD(ImageFixture, "ranges of arrays are written")
{
    scan();
    const auto write_to = [&](std::uint64_t handle, const char* range_text, Variant value) {
        const auto range = NumericRange::parse(range_text).value();
        const DataValue data{std::move(value)};
        return write_now({handle, &range, &data});
    };
    CHECK(write_to(levels, "1:2", Array<double>{8, 9}) == status::Good);
    CHECK(write_to(levels, "3", Array<double>{4}) == status::Good);
    CHECK(read(levels).value == Variant{Array<double>{0, 8, 9, 4}});
    CHECK(write_to(grid, "0:1,1:2",
                   Variant::matrix(Array<std::uint32_t>{1, 2, 3, 4}, Array<std::uint32_t>{2, 2})) ==
          status::Good);
    CHECK(read(grid).value ==
          Variant::matrix(Array<std::uint32_t>{0, 1, 2, 0, 3, 4}, Array<std::uint32_t>{2, 3}));
    CHECK(write_to(names, "1:2", Array<String>{"b", "c"}) == status::Good);
    CHECK(read(names).value == Variant{Array<String>{String{}, "b", "c"}});

    CHECK(write_to(levels, "3:4", Array<double>{1, 2}) == status::Bad_IndexRangeNoData);
    CHECK(write_to(levels, "0:4294967294", Array<double>{1}) == status::Bad_IndexRangeNoData);
    CHECK(write_to(levels, "0,0", Array<double>{1}) == status::Bad_IndexRangeNoData);
    CHECK(write_to(levels, "0:2", Array<double>{1, 2}) == status::Bad_IndexRangeDataMismatch);
    CHECK(write_to(levels, "0", Array<float>{1}) == status::Bad_TypeMismatch);
    CHECK(write_to(grid, "0", Array<std::uint32_t>{1}) == status::Bad_IndexRangeNoData);
    CHECK(write_to(grid, "0:1,0:1",
                   Variant::matrix(Array<std::uint32_t>{1, 2, 3, 4}, Array<std::uint32_t>{1, 4})) ==
          status::Bad_IndexRangeDataMismatch);
    CHECK(write_to(speed, "0", std::int16_t{1}) == status::Bad_IndexRangeNoData);
    CHECK(write_to(name, "0:1", String{"ab"}) == status::Bad_WriteNotSupported);
    CHECK(write_to(names, "0,0:1", Array<String>{"ab"}) == status::Bad_WriteNotSupported);
    CHECK(write_to(names, "0", Array<String>{"123456789"}) == status::Bad_OutOfRange);
    CHECK(read(levels).value == Variant{Array<double>{0, 8, 9, 4}});
}

TEST_CASE_METHOD(ImageFixture, "the task may refuse items")
{
    scan();
    const DataValue number = of(std::int16_t{5});
    const DataValue text = of(String{"five"});
    const Pending pending = write({{speed, nullptr, &number}, {name, nullptr, &text}});
    image->begin_scan([&](std::uint32_t handle) -> StatusCode {
        return handle == speed ? status::Bad_NotWritable : status::Good;
    });
    image->publish(at(2000));
    sources->handle_completions();
    CHECK(pending.result(0) == status::Bad_NotWritable);
    CHECK(pending.result(1) == status::Good);
    CHECK(image->memory().value<std::int16_t>(speed) == 0);
}

TEST_CASE("what one scan applies is limited, and so are the calls that wait")
{
    ImageOptions options;
    options.max_waiting_writes = 3;
    options.max_changes_per_scan = 4;
    ImageFixture f{options};
    f.scan();
    const DataValue one = of(std::int16_t{1});
    const std::vector<WriteItem> three(3, {f.speed, nullptr, &one});
    const std::vector<WriteItem> five(5, {f.speed, nullptr, &one});
    const auto too_large = f.write(five);
    REQUIRE(too_large.owner->done);
    CHECK(too_large.result() == status::Bad_TooManyOperations);

    std::vector<ImageFixture::Pending> pending;
    for (int i = 0; i < 3; ++i) {
        pending.push_back(f.write(three));
    }
    const auto too_many = f.write(three);
    REQUIRE(too_many.owner->done);
    CHECK(too_many.result() == status::Bad_TooManyOperations);
    for (std::size_t scans = 1; scans <= 3; ++scans) {
        f.scan();
        f.sources->handle_completions();
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(pending[i].owner->done == (i < scans));
        }
    }
    CHECK_FALSE(f.write(three).owner->done);
}

TEST_CASE("the calls that wait are limited in number and in bytes")
{
    const DataValue one = of(std::int16_t{1});
    ImageFixture many;
    many.scan();
    std::vector<ImageFixture::Pending> pending;
    for (std::uint32_t i = 0; i < many.image->options().max_waiting_writes; ++i) {
        pending.push_back(many.write({{many.speed, nullptr, &one}}));
        INFO(i << " waiting");
        REQUIRE_FALSE(pending.back().owner->done);
    }
    CHECK(pending.size() >= 1'000); // what 200 clients may send within a scan of 500 ms
    CHECK(many.write({{many.speed, nullptr, &one}}).result() == status::Bad_TooManyOperations);
    CHECK(many.read(many.speed).value == Variant{std::int16_t{0}});

    ImageOptions options;
    options.max_waiting_bytes = 1;
    ImageFixture few{options};
    few.scan();
    const auto first = few.write({{few.speed, nullptr, &one}});
    CHECK_FALSE(first.owner->done); // which alone is more than a byte
    CHECK(few.write({{few.speed, nullptr, &one}}).result() == status::Bad_TooManyOperations);
    few.scan();
    few.sources->handle_completions();
    CHECK(first.result() == status::Good);
    CHECK_FALSE(few.write({{few.speed, nullptr, &one}}).owner->done);
}

TEST_CASE("a call whose texts are more than the limit is refused before they are copied")
{
    ImageLayout layout;
    const auto text = layout.add({BuiltInType::ByteString, {}, 100'000}).value();
    ImageOptions options;
    options.max_bytes_per_scan = 1;
    const auto image = ProcessImage::create(layout, options);
    CHECK(image->options().max_bytes_per_scan >= 100'004);
    image->publish(at(1));
    ImageSource source{image};
    SourceCaller caller{source};
    const DataValue data = of(ByteString{std::vector<std::byte>(60'000)});
    const auto results = caller.write({{text, nullptr, &data}, {text, nullptr, &data}});
    CHECK(results == std::vector<StatusCode>(2, status::Bad_TooManyOperations));
}

TEST_CASE_METHOD(ImageFixture, "a stopped task leaves its last values and takes no writes")
{
    const DataValue one = of(std::int16_t{1});
    CHECK(write({{speed, nullptr, &one}}).result() == status::Bad_NoCommunication);
    scan([&](ImageMemory& memory) { memory.value<std::int16_t>(speed) = 7; });
    const Pending waiting = write({{speed, nullptr, &one}});
    image->halt();
    CHECK(waker.count() == 1);
    sources->handle_completions();
    REQUIRE(waiting.owner->done);
    CHECK(waiting.result() == status::Bad_NoCommunication);
    CHECK(read(speed) ==
          DataValue{Variant{std::int16_t{7}}, status::Uncertain_LastUsableValue, at(1001)});
    CHECK(write({{speed, nullptr, &one}}).result() == status::Bad_NoCommunication);

    scan(); // which does not change the value, whose time stays
    CHECK(read(speed) == DataValue{Variant{std::int16_t{7}}, {}, at(1001)});
    CHECK(write_now({speed, nullptr, &one}) == status::Good);
}

TEST_CASE_METHOD(ImageFixture, "a server that ends while writes wait leaves the task unharmed")
{
    scan();
    const DataValue one = of(std::int16_t{1});
    Pending given_up = write({{speed, nullptr, &one}});
    SECTION("the call is given up")
    {
        given_up.call.reset();
        scan();
        sources->handle_completions();
    }
    SECTION("the server ends before the task has it")
    {
        given_up.call.reset();
        sources.reset();
        source.reset();
        scan();
    }
    SECTION("the server ends while the task has it")
    {
        image->begin_scan();
        given_up.call.reset();
        sources.reset();
        source.reset();
        image->publish(at(2000));
    }
    CHECK(image->memory().value<std::int16_t>(speed) == 1);
    CHECK(waker.count() <= 2);
}

} // namespace image_write_test
