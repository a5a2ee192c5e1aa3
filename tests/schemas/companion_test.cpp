#include <catch2/catch.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/types/registry.hpp>

#include <acme/ids.hpp>
#include <acme/registry.hpp>
#include <acme/types.hpp>
#include <acme_line/registry.hpp>
#include <acme_line/types.hpp>

namespace companion_test {

// A vendor's companion model goes through the same generator as the types of OPC UA.
namespace {

constexpr std::uint16_t acme_index = 3;
constexpr std::uint16_t line_index = 4;

busbar::binary::TypeRegistry registry()
{
    busbar::binary::TypeRegistry types{busbar::binary::namespace0_types()};
    types.add(acme_index, acme::types());
    types.add(line_index, acme_line::types());
    return types;
}

template <typename T>
std::vector<std::byte> bytes_of(const T& value)
{
    auto bytes = busbar::binary::to_bytes(value);
    REQUIRE(bytes);
    return std::move(*bytes);
}

template <typename T>
void check_round_trip(const T& value)
{
    const auto types = registry();
    const auto bytes = bytes_of(value);
    const auto decoded = busbar::binary::from_bytes<T>(bytes, &types);
    REQUIRE(decoded);
    CHECK(*decoded == value);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        CHECK_FALSE(busbar::binary::from_bytes<T>(std::span{bytes}.first(size), &types));
    }
}

std::vector<std::byte> raw(std::initializer_list<unsigned> values)
{
    std::vector<std::byte> bytes;
    for (const unsigned value : values) {
        bytes.push_back(static_cast<std::byte>(value));
    }
    return bytes;
}

acme::Axis axis()
{
    acme::Axis result;
    result.serial = "A-1";
    result.weight = 2.5;
    result.type_ = "linear";
    result.mode = acme::DriveMode::TwoSpeed;
    result.flags = acme::AxisFlags::Homed | acme::AxisFlags::Faulted;
    result.limits = busbar::Range{-1, 1};
    result.inertia = {{2, 3}, {1, 2, 3, 4, 5, 6}};
    result.any_part = busbar::ExtensionObject::from(acme::Assembly{.serial = "inner"}, acme_index);
    result.any_parts = {busbar::ExtensionObject{}, result.any_part};
    result.setpoint = busbar::Variant{std::int16_t{-7}};
    result.anything = busbar::Variant{busbar::Array<bool>{true, false}};
    return result;
}

} // namespace

TEST_CASE("Optional fields stand behind a mask")
{
    acme::OptStruct value{.mandatory_int32 = 42};
    CHECK(bytes_of(value) == raw({0, 0, 0, 0, 42, 0, 0, 0}));
    value.opt_int32 = -7;
    CHECK(bytes_of(value) == raw({1, 0, 0, 0, 42, 0, 0, 0, 0xF9, 0xFF, 0xFF, 0xFF}));
    value.opt_int32.reset();
    value.opt_arr = busbar::Array<double>{1.5, 2};
    CHECK(bytes_of(value) == raw({4, 0, 0, 0, 42,   0,    0, 0, 2, 0, 0, 0, 0, 0,
                                  0, 0, 0, 0, 0xF8, 0x3F, 0, 0, 0, 0, 0, 0, 0, 0x40}));
    check_round_trip(value);
    value.opt_string = "x";
    value.opt_int32 = 5;
    check_round_trip(value);
    CHECK(busbar::binary::from_bytes<acme::OptStruct>(raw({8, 0, 0, 0, 42, 0, 0, 0})).error() ==
          busbar::status::Bad_DecodingError);
}

TEST_CASE("A union stands behind its switch field")
{
    acme::UnionStruct value;
    CHECK(bytes_of(value) == raw({0, 0, 0, 0}));
    check_round_trip(value);
    value.set_a(-1);
    CHECK(bytes_of(value) == raw({1, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF}));
    value.set_b("xyz");
    CHECK(bytes_of(value) == raw({2, 0, 0, 0, 3, 0, 0, 0, 'x', 'y', 'z'}));
    check_round_trip(value);
    value.set_c(2.25);
    CHECK(bytes_of(value) == raw({3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0x40}));
    CHECK(value.a() == nullptr);
    CHECK(*value.c() == 2.25);
    CHECK_FALSE(busbar::binary::from_bytes<acme::UnionStruct>(raw({4, 0, 0, 0, 0, 0, 0, 0})));
}

TEST_CASE("Option sets are numbers or structures")
{
    const auto flags = acme::AxisFlags::Homed | acme::AxisFlags::Faulted;
    CHECK(static_cast<unsigned>(flags) == 0x8001);
    CHECK(has_bits(flags, acme::AxisFlags::Homed));
    CHECK_FALSE(has_bits(flags, acme::AxisFlags::Moving));
    CHECK(static_cast<unsigned>(acme::WideFlags::Bit::Ninth) == 8);
    const auto bits = raw({0, 1});
    check_round_trip(
        acme::WideFlags{.value = busbar::ByteString{bits}, .valid_bits = busbar::ByteString{bits}});
}

TEST_CASE("Subtypes, matrices and inherited fields survive, across namespaces")
{
    check_round_trip(axis());
    acme_line::LinearAxis linear;
    linear.serial = "L";
    linear.limits = busbar::Range{0, 9};
    linear.length = 1.25;
    linear.choice.set_b("left");
    linear.flags2 = acme::AxisFlags::Moving;
    check_round_trip(linear);
    check_round_trip(acme_line::NamedRange{.low = 1, .high = 2, .name = "span"});
    CHECK(acme::Axis::type.binary_encoding_id.string == "Axis.Binary");

    const auto types = registry();
    const auto object = busbar::ExtensionObject::from(axis(), acme_index);
    const auto decoded =
        busbar::binary::from_bytes<busbar::ExtensionObject>(bytes_of(object), &types);
    REQUIRE(decoded);
    REQUIRE(decoded->get_if<acme::Axis>() != nullptr);
    CHECK(*decoded->get_if<acme::Axis>() == axis());
}

TEST_CASE("A matrix's dimensions and values agree")
{
    acme::Axis value = axis();
    value.inertia = {};
    check_round_trip(value);
    value.inertia = {{2, 3}, {1, 2}};
    CHECK(busbar::binary::to_bytes(value).error() == busbar::status::Bad_EncodingError);
    using Matrix = busbar::Matrix<std::uint8_t>;
    const auto decode = [](std::initializer_list<unsigned> bytes) {
        return busbar::binary::from_bytes<Matrix>(raw(bytes));
    };
    CHECK(decode({2, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 7, 8})->values.size() == 2);
    CHECK(decode({2, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0})->values.empty());
    CHECK_FALSE(decode({1, 0, 0, 0, 1, 0, 0, 0, 7}));
    CHECK_FALSE(decode({2, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 7}));
    CHECK_FALSE(decode({2, 0, 0, 0, 255, 255, 255, 127, 255, 255, 255, 127, 7}));
    CHECK(decode({3, 0, 0, 0, 255, 255, 255, 127, 255, 255, 255, 127, 0, 0, 0, 0})->values.empty());
}

TEST_CASE("A structure inside itself counts its levels")
{
    const auto nested = [](unsigned levels) {
        acme::Assembly value;
        for (unsigned i = 1; i < levels; ++i) {
            acme::Assembly outer;
            outer.children.push_back(std::move(value));
            value = std::move(outer);
        }
        return value;
    };
    check_round_trip(nested(3));
    CHECK(busbar::binary::to_bytes(nested(101))); // a hundred inside of the outermost one
    CHECK(busbar::binary::to_bytes(nested(102)).error() ==
          busbar::status::Bad_EncodingLimitsExceeded);

    std::vector<std::byte> deep;
    for (int i = 0; i < 100'000; ++i) {
        const auto level = raw({0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 1, 0, 0, 0});
        deep.insert(deep.end(), level.begin(), level.end());
    }
    CHECK(busbar::binary::from_bytes<acme::Assembly>(deep).error() ==
          busbar::status::Bad_EncodingLimitsExceeded);
}

TEST_CASE("Unknown enumeration values are kept")
{
    acme::Axis value = axis();
    value.mode = static_cast<acme::DriveMode>(99);
    check_round_trip(value);
    CHECK(static_cast<int>(acme::DriveMode::default_) == -1);
}

} // namespace companion_test
