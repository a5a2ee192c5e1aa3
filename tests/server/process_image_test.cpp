#include <catch2/catch.hpp>

#include <busbar/server/process_image.hpp>

#include "support/source_caller.hpp"

using namespace busbar;
using namespace busbar::server;
using server::detail::DataSources;
using server::detail::WriteCall;

namespace {

struct Owner final : server::detail::CallOwner {
    bool done{false};
    void call_completed() override { done = true; }
};

constexpr DateTime at(std::int64_t second)
{
    return DateTime::from_unix_seconds(second);
}

/// An image with a variable of each shape, its task played by the test, and a server's side.
struct Fixture {
    explicit Fixture(ImageOptions options = {})
    {
        ImageLayout layout;
        speed = layout.add({BuiltInType::Int16, {}, 0}).value();
        name = layout.add({BuiltInType::String, {}, 8}).value();
        levels = layout.add({BuiltInType::Double, {4}, 0}).value();
        grid = layout.add({BuiltInType::UInt32, {2, 3}, 0}).value();
        names = layout.add({BuiltInType::String, {3}, 8}).value();
        image = ProcessImage::create(std::move(layout), options);
        source = std::make_unique<ImageSource>(image);
        sources = std::make_unique<DataSources>(&waker);
        sources->add(*source);
    }

    /// One scan of the task, in which `work(memory)` runs.
    template <typename Work>
    void scan(Work&& work)
    {
        image->begin_scan();
        work(image->memory());
        image->publish(at(++seconds));
    }
    void scan()
    {
        scan([](ImageMemory&) {});
    }
    DataValue read(std::uint64_t handle)
    {
        server::detail::ReadCall call{*sources, 1};
        call.ask(0, 0, {handle, nullptr});
        Owner owner;
        REQUIRE(call.start(owner, TimePoint{}, [](auto&) {}));
        const ReadSlot& slot = call.result(0);
        DataValue copy{slot};
        copy.value = slot.shared != nullptr ? *slot.shared : slot.value;
        return copy;
    }
    struct Pending {
        std::unique_ptr<WriteCall> call;
        std::unique_ptr<Owner> owner;
        StatusCode result(std::size_t index = 0) const { return call->result(index); }
    };
    Pending write(const std::vector<WriteItem>& items)
    {
        Pending pending{std::make_unique<WriteCall>(*sources, items.size()),
                        std::make_unique<Owner>()};
        for (std::size_t i = 0; i < items.size(); ++i) {
            pending.call->ask(i, 0, items[i]);
        }
        pending.owner->done = pending.call->start(*pending.owner, TimePoint{}, [](auto&) {});
        return pending;
    }
    /// Writes, scans, and gives the first item's result.
    StatusCode write_now(const WriteItem& item)
    {
        const Pending pending = write({item});
        scan();
        sources->handle_completions();
        REQUIRE(pending.owner->done);
        return pending.result();
    }

    std::uint32_t speed, name, levels, grid, names;
    std::int64_t seconds{1000};
    test::TestWaker waker;
    std::shared_ptr<ProcessImage> image;
    std::unique_ptr<ImageSource> source;
    std::unique_ptr<DataSources> sources;
};

template <typename T>
DataValue of(T value)
{
    return DataValue{Variant{std::move(value)}};
}

} // namespace

TEST_CASE("a layout refuses what an image cannot have")
{
    ImageLayout layout;
    const auto add = [&](BuiltInType type, std::vector<std::uint32_t> dimensions,
                         std::uint32_t capacity = 0) {
        const auto added = layout.add({type, std::move(dimensions), capacity});
        return added ? StatusCode{} : added.error();
    };
    CHECK(add(BuiltInType::NodeId, {}) == status::Bad_DataTypeIdUnknown);
    CHECK(add(BuiltInType::Null, {}) == status::Bad_DataTypeIdUnknown);
    CHECK(add(BuiltInType::Int16, {3, 0}) == status::Bad_OutOfRange);
    CHECK(add(BuiltInType::Int16, std::vector<std::uint32_t>(17, 1)) == status::Bad_OutOfRange);
    CHECK(add(BuiltInType::Int16, {65536, 65536}) == status::Bad_OutOfMemory);
    CHECK(add(BuiltInType::Byte, {65536, 65536, 65536, 65536}) == status::Bad_OutOfMemory);
    CHECK(add(BuiltInType::String, {}, UINT32_MAX) == status::Bad_OutOfMemory);
    // What wraps where a size has 32 bits (E6).
    CHECK(add(BuiltInType::Int16, {65537, 65537}) == status::Bad_OutOfMemory);
    CHECK(add(BuiltInType::Double, {0x2000'0001}) == status::Bad_OutOfMemory);
    CHECK(add(BuiltInType::String, {2}, 0x7FFF'FFFC) == status::Bad_OutOfMemory);
    CHECK(add(BuiltInType::ByteString, {}, UINT32_MAX - 3) == status::Bad_OutOfMemory);
    CHECK(layout.size() == 0);
    CHECK(add(BuiltInType::Guid, {}) == status::Good);
    CHECK(add(BuiltInType::Boolean, {}) == status::Good);
    CHECK(add(BuiltInType::Int64, {}) == status::Good);
    CHECK(layout[2].offset == 24);
}

TEMPLATE_TEST_CASE("an image's memory holds every basic type", "", bool, std::int8_t, std::uint8_t,
                   std::int16_t, std::uint16_t, std::int32_t, std::uint32_t, std::int64_t,
                   std::uint64_t, float, double, DateTime, Guid, StatusCode, String, ByteString,
                   XmlElement)
{
    ImageLayout layout;
    const auto scalar = layout.add({built_in_type_of<TestType>, {}, 4}).value();
    const auto array = layout.add({built_in_type_of<TestType>, {2}, 4}).value();
    const auto image = ProcessImage::create(layout);
    ImageMemory& memory = image->memory();
    TestType value{};
    if constexpr (std::is_arithmetic_v<TestType>) {
        value = static_cast<TestType>(1);
    } else if constexpr (std::is_same_v<TestType, String>) {
        value = String{"abc"};
    } else if constexpr (std::is_same_v<TestType, ByteString>) {
        value = ByteString{std::as_bytes(std::span{"abc", 3})};
    }
    const Variant array_value{Array<TestType>{TestType{}, value}};
    CHECK(memory.store(scalar, Variant{value}) == status::Good);
    CHECK(memory.store(array, array_value) == status::Good);
    CHECK(memory.load(scalar) == Variant{value});
    image->publish(at(1));
    const ImagePin pin = image->pin();
    CHECK(pin.value(scalar) == Variant{value});
    CHECK(pin.value(array) == array_value);
    CHECK(memory.store(scalar, array_value) == status::Bad_TypeMismatch);
    CHECK(memory.store(array, Variant{Array<TestType>{value}}) == status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(Fixture, "a text keeps to its capacity and tells null from empty")
{
    ImageMemory& memory = image->memory();
    CHECK_FALSE(memory.text(name));
    CHECK(memory.set_text(name, "12345678"));
    CHECK_FALSE(memory.set_text(name, "123456789"));
    CHECK(memory.text(name) == "12345678");
    CHECK(memory.set_text(name, ""));
    CHECK(memory.load(name) == Variant{String{""}});
    CHECK(memory.set_text(name, std::nullopt));
    CHECK(memory.load(name) == Variant{String{}});
    CHECK(memory.store(name, Variant{"123456789"}) == status::Bad_OutOfRange);
}

TEST_CASE_METHOD(Fixture, "readers see what was published, with the scan's time")
{
    CHECK(read(speed).status == status::Bad_NoCommunication);
    scan([&](ImageMemory& memory) {
        memory.value<std::int16_t>(speed) = 7;
        memory.set_text(name, "first");
        memory.values<double>(levels)[3] = 2.5;
        memory.values<std::uint32_t>(grid)[5] = 6;
    });
    image->memory().value<std::int16_t>(speed) = 8; // the next scan's
    CHECK(read(speed) == DataValue{Variant{std::int16_t{7}}, {}, at(1001)});
    CHECK(read(name).value == Variant{"first"});
    CHECK(read(levels).value == Variant{Array<double>{0, 0, 0, 2.5}});
    CHECK(read(grid).value ==
          Variant::matrix(Array<std::uint32_t>{0, 0, 0, 0, 0, 6}, Array<std::uint32_t>{2, 3}));
    CHECK(read(names).value == Variant{Array<String>{String{}, String{}, String{}}});
    CHECK(read(99).status == status::Bad_NodeIdUnknown);
    scan();
    CHECK(read(speed) == DataValue{Variant{std::int16_t{8}}, {}, at(1002)});
}

TEST_CASE_METHOD(Fixture, "a pinned scan stays as it was")
{
    scan([&](ImageMemory& memory) { memory.set_text(name, "old"); });
    const ImagePin pin = image->pin();
    ReadSlot slot;
    CHECK(pin.read(name, slot));
    CHECK_FALSE(slot.value.get_if<String>()->is_owned());
    for (int i = 0; i < 100; ++i) {
        scan([&](ImageMemory& memory) { memory.set_text(name, "new"); });
    }
    CHECK(slot.value == Variant{"old"});
    CHECK(pin.read(levels, slot)); // a slot may be used again
    CHECK(*slot.shared == Variant{Array<double>(4)});
    CHECK_FALSE(pin.read(speed, slot));
    CHECK(slot.shared == nullptr);
    CHECK(slot.value == Variant{std::int16_t{0}});
    CHECK(pin.scan() == 1);
    CHECK(pin.time() == at(1001));
    CHECK(image->pin().scan() == 101);
}

TEST_CASE("pins are limited, and never stand in the task's way")
{
    ImageOptions options;
    options.max_pins = 3;
    Fixture f{options};
    CHECK_FALSE(f.image->pin());
    std::vector<ImagePin> pins;
    for (int i = 0; i < 3; ++i) {
        f.scan();
        pins.push_back(f.image->pin());
    }
    f.scan();
    CHECK_FALSE(f.image->pin());
    CHECK(f.read(f.speed).status == status::Bad_TooManyOperations);
    for (int i = 0; i < 10; ++i) {
        f.scan();
    }
    for (std::size_t i = 0; i < pins.size(); ++i) {
        CHECK(pins[i].scan() == i + 1);
    }
    pins.erase(pins.begin());
    CHECK(f.image->pin().scan() == 14);
    CHECK(f.read(f.speed).source_timestamp == at(f.seconds));
}

TEST_CASE("a pin outlives the source and the task's reference")
{
    Fixture f;
    f.scan([&](ImageMemory& memory) { memory.value<std::int16_t>(f.speed) = 5; });
    const ImagePin pin = f.image->pin();
    f.sources.reset();
    f.source.reset();
    f.image.reset();
    CHECK(pin.value(f.speed) == Variant{std::int16_t{5}});
}

TEST_CASE_METHOD(Fixture, "the writes of a call are applied together at the next scan's edge")
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

TEST_CASE_METHOD(Fixture, "a write that does not fit the variable is refused, the others are done")
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

TEST_CASE_METHOD(Fixture, "ranges of arrays are written")
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

TEST_CASE_METHOD(Fixture, "the task may refuse items")
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
    Fixture f{options};
    f.scan();
    const DataValue one = of(std::int16_t{1});
    const std::vector<WriteItem> three(3, {f.speed, nullptr, &one});
    const std::vector<WriteItem> five(5, {f.speed, nullptr, &one});
    const auto too_large = f.write(five);
    REQUIRE(too_large.owner->done);
    CHECK(too_large.result() == status::Bad_TooManyOperations);

    std::vector<Fixture::Pending> pending;
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

TEST_CASE("the calls that wait are limited in number and in bytes (C5)")
{
    const DataValue one = of(std::int16_t{1});
    Fixture many;
    many.scan();
    std::vector<Fixture::Pending> pending;
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
    Fixture few{options};
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
    test::SourceCaller caller{source};
    const DataValue data = of(ByteString{std::vector<std::byte>(60'000)});
    const auto results = caller.write({{text, nullptr, &data}, {text, nullptr, &data}});
    CHECK(results == std::vector<StatusCode>(2, status::Bad_TooManyOperations));
}

TEST_CASE_METHOD(Fixture, "a stopped task leaves its last values and takes no writes")
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

    scan();
    CHECK(read(speed) == DataValue{Variant{std::int16_t{7}}, {}, at(1002)});
    CHECK(write_now({speed, nullptr, &one}) == status::Good);
}

TEST_CASE_METHOD(Fixture, "a server that ends while writes wait leaves the task unharmed")
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
