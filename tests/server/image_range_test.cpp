#include <catch2/catch.hpp>

#include <cstdint>
#include <limits>
#include <utility>

#include <busbar/core/extension_object.hpp>
#include <busbar/server/image_structure.hpp>

#include "image_fixture.hpp"

namespace image_range_test {

// Integers of which a process image takes some values only.

using namespace busbar;
using namespace busbar::server;
using namespace busbar::test;

namespace {

const NodeId drive_encoding{2, "Drive.Binary"};

struct RangeFixture : ImageFixture {
    RangeFixture()
    {
        ImageLayout layout;
        gear = layout.add({.type = BuiltInType::Int16, .range = ImageRange{1, 5}}).value();
        gears =
            layout
                .add({.type = BuiltInType::SByte, .dimensions = {2, 2}, .range = ImageRange{-3, 3}})
                .value();
        const std::vector<ImageVariable> members{
            {.type = BuiltInType::UInt32},
            {.type = BuiltInType::Byte, .dimensions = {2}, .range = ImageRange{10, 20}}};
        drive = layout
                    .add({.type = BuiltInType::ExtensionObject,
                          .structure = ImageStructure::create(drive_encoding, members).value()})
                    .value();
        huge = layout
                   .add({.type = BuiltInType::UInt64,
                         .range = ImageRange{0, std::numeric_limits<std::int64_t>::max()}})
                   .value();
        real = layout.add({.type = BuiltInType::Double, .range = ImageRange{0, 1}}).value();
        image = ProcessImage::create(std::move(layout), {});
        source = std::make_unique<ImageSource>(image);
        sources = std::make_unique<server::detail::DataSources>(&waker);
        sources->add(*source);
        scan();
    }

    [[nodiscard]] StatusCode set(std::uint32_t handle, Variant value, const char* range = nullptr)
    {
        const DataValue data{std::move(value)};
        if (range == nullptr) {
            return write_now({handle, nullptr, &data});
        }
        const auto parsed = NumericRange::parse(range).value();
        return write_now({handle, &parsed, &data});
    }
    /// Three of UInt32 and two of Byte.
    [[nodiscard]] static ExtensionObject drive_of(unsigned first, unsigned second)
    {
        std::vector<std::byte> body{std::byte{3},
                                    {},
                                    {},
                                    {}, // UInt32
                                    std::byte{2},
                                    {},
                                    {},
                                    {}, // elements
                                    static_cast<std::byte>(first),
                                    static_cast<std::byte>(second)};
        return ExtensionObject::from_binary(drive_encoding, ByteString{std::move(body)});
    }

    std::uint32_t gear, gears, drive, huge, real;
};

} // namespace

TEST_CASE_METHOD(RangeFixture, "a write outside a variable's range is refused")
{
    const std::int16_t value = GENERATE(std::int16_t{1}, std::int16_t{3}, std::int16_t{5});
    CHECK(set(gear, value) == status::Good);
    CHECK(read(gear).value == Variant{value});
    const std::int16_t wrong = GENERATE(as<std::int16_t>{}, 0, 6, -1, INT16_MIN, INT16_MAX);
    CHECK(set(gear, wrong) == status::Bad_OutOfRange);
    CHECK(read(gear).value == Variant{value});
}

TEST_CASE_METHOD(RangeFixture, "each element of an array is to be in its range")
{
    using Bytes = Array<std::int8_t>;
    const Array<std::uint32_t> shape{2, 2};
    const Variant good = Variant::matrix(Bytes{-3, 0, 1, 3}, shape);
    CHECK(set(gears, good) == status::Good);
    CHECK(set(gears, Variant::matrix(Bytes{0, 0, 0, 4}, shape)) == status::Bad_OutOfRange);
    const Array<std::uint32_t> row{1, 2};
    CHECK(set(gears, Variant::matrix(Bytes{-4, 0}, row), "1,0:1") == status::Bad_OutOfRange);
    CHECK(read(gears).value == good);
    CHECK(set(gears, Variant::matrix(Bytes{2, -2}, row), "1,0:1") == status::Good);
    CHECK(read(gears).value == Variant::matrix(Bytes{-3, 0, 2, -2}, shape));
}

TEST_CASE_METHOD(RangeFixture, "a structure's members are to be in their ranges")
{
    CHECK(set(drive, drive_of(10, 20)) == status::Good);
    CHECK(set(drive, drive_of(10, 21)) == status::Bad_OutOfRange);
    CHECK(set(drive, drive_of(9, 20)) == status::Bad_OutOfRange);
    CHECK(read(drive).value == Variant{drive_of(10, 20)});
    CHECK(image->memory().store(drive, drive_of(0, 10)) == status::Bad_OutOfRange);
}

TEST_CASE_METHOD(RangeFixture, "unsigned values beyond every signed one are outside a range")
{
    CHECK(set(huge, std::uint64_t{INT64_MAX}) == status::Good);
    CHECK(set(huge, std::uint64_t{INT64_MAX} + 1) == status::Bad_OutOfRange);
    CHECK(set(huge, UINT64_MAX) == status::Bad_OutOfRange);
}

TEST_CASE_METHOD(RangeFixture, "ranges are for integers, and do not hinder the task")
{
    CHECK(set(real, 7.5) == status::Good);
    image->memory().value<std::int16_t>(gear) = 9;
    scan();
    CHECK(read(gear).value == Variant{std::int16_t{9}});
    CHECK(image->memory().store(gear, std::int16_t{9}) == status::Bad_OutOfRange);
}

} // namespace image_range_test
