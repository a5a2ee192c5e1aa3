#include <catch2/catch.hpp>

#include "image_fixture.hpp"

namespace process_image_test {

using namespace busbar;
using namespace busbar::server;
using namespace busbar::test;

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
    // Sizes that wrap around in 32 bits.
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

TEST_CASE_METHOD(ImageFixture, "a text keeps to its capacity and tells null from empty")
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

TEST_CASE_METHOD(ImageFixture, "readers see what was published, with the time of its change")
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

TEST_CASE_METHOD(ImageFixture, "the source timestamp is that of the last change")
{
    scan();
    const auto time_of = [&](std::uint32_t handle) { return read(handle).source_timestamp; };
    const auto all = {speed, name, levels, grid, names};
    for (int i = 0; i < 3; ++i) {
        for (const std::uint32_t handle : all) {
            CHECK(time_of(handle) == at(1001));
        }
        scan();
    }
    scan([&](ImageMemory& memory) { memory.value<std::int16_t>(speed) = 1; });     // 1005
    scan([&](ImageMemory& memory) { memory.set_text(name, "x"); });                // 1006
    scan([&](ImageMemory& memory) { memory.values<double>(levels)[3] = 1; });      // 1007
    scan([&](ImageMemory& memory) { memory.values<std::uint32_t>(grid)[5] = 1; }); // 1008
    scan([&](ImageMemory& memory) { memory.set_text(names, "y", 2); });            // 1009
    // The same value again is no change.
    scan([&](ImageMemory& memory) { memory.value<std::int16_t>(speed) = 1; });
    std::int64_t expected = 1005;
    for (const std::uint32_t handle : all) {
        CHECK(time_of(handle) == at(expected++));
    }
    SECTION("written by a client")
    {
        const DataValue same = of<std::int16_t>(1);
        CHECK(write_now({speed, nullptr, &same}) == status::Good);
        CHECK(time_of(speed) == at(1005));
        const DataValue other = of<std::int16_t>(2);
        CHECK(write_now({speed, nullptr, &other}) == status::Good);
        CHECK(time_of(speed) == at(seconds));
    }
    SECTION("while the task is halted and when it starts again")
    {
        image->halt();
        CHECK(time_of(speed) == at(1005));
        scan();
        CHECK(time_of(speed) == at(1005));
    }
}

TEST_CASE_METHOD(ImageFixture, "an older scan has no times of newer ones")
{
    scan();
    scan();
    const ImagePin pin = image->pin(); // 1002
    ReadSlot slot;
    scan([&](ImageMemory& memory) { memory.value<std::int16_t>(speed) = 1; });
    pin.read(speed, slot);
    CHECK(slot.source_timestamp == at(1001));
    // Its time was kept once; from then on it is the scan's at most.
    scan([&](ImageMemory& memory) { memory.value<std::int16_t>(speed) = 2; });
    pin.read(speed, slot);
    CHECK(slot.source_timestamp == at(1002));
    CHECK(read(speed).source_timestamp == at(1004));
}

TEST_CASE("times of changes are those of single variables among many")
{
    ImageLayout layout;
    std::vector<std::int16_t> runtime(500);
    const auto options = GENERATE(true, false);
    for (std::size_t i = 0; i < 1'000; ++i) {
        ImageVariable variable;
        variable.type = i % 7 == 0 ? BuiltInType::Double : BuiltInType::Int16;
        if (options && i % 2 == 1 && i % 7 != 0) {
            variable.runtime = std::as_writable_bytes(std::span{runtime}.subspan(i / 2, 1));
        }
        if (i % 97 == 0) {
            variable = {BuiltInType::String, {}, 600}; // longer than what is compared at once
        }
        REQUIRE(layout.add(variable));
    }
    const auto image = ProcessImage::create(std::move(layout));
    image->publish(at(1));
    std::int64_t second = 1;
    std::vector<std::int64_t> expected(1'000, 1);
    for (std::uint32_t i = 0; i < 1'000; i += 3) {
        std::byte* const bytes = image->memory().bytes(image->layout()[i]);
        const std::uint32_t last = image->layout()[i].bytes() - 1;
        bytes[last] = std::byte{1};
        expected[i] = ++second;
        image->publish(at(second));
    }
    const ImagePin pin = image->pin();
    for (std::uint32_t i = 0; i < 1'000; ++i) {
        ReadSlot slot;
        pin.read(i, slot);
        REQUIRE(slot.source_timestamp == at(expected[i]));
    }
}

TEST_CASE_METHOD(ImageFixture, "a pinned scan stays as it was")
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
    ImageFixture f{options};
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
        f.scan([&](ImageMemory& memory) { ++memory.value<std::int16_t>(f.speed); });
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
    ImageFixture f;
    f.scan([&](ImageMemory& memory) { memory.value<std::int16_t>(f.speed) = 5; });
    const ImagePin pin = f.image->pin();
    f.sources.reset();
    f.source.reset();
    f.image.reset();
    CHECK(pin.value(f.speed) == Variant{std::int16_t{5}});
}

} // namespace process_image_test
