#include <catch2/catch.hpp>

#include <array>
#include <initializer_list>
#include <limits>

#include <busbar/binary/codec.hpp>

namespace wire_order_test {

using namespace busbar;

namespace {

std::vector<std::byte> bytes(std::initializer_list<unsigned> values)
{
    std::vector<std::byte> result;
    for (const unsigned value : values) {
        result.push_back(static_cast<std::byte>(value));
    }
    return result;
}

/// Blocks of three bytes, so that most numbers lie across two of them.
class SmallBlocks final : public binary::Sink {
public:
    [[nodiscard]] std::span<std::byte> next() override
    {
        const auto block = std::span{bytes_}.subspan(3 * used_, 3);
        ++used_;
        return block;
    }
    [[nodiscard]] StatusCode status() const override { return status::Bad_EncodingLimitsExceeded; }
    [[nodiscard]] std::vector<std::byte> first(std::size_t size) const
    {
        return {bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size)};
    }

private:
    std::array<std::byte, 99> bytes_{};
    std::size_t used_{0};
};

enum class Colour : std::int32_t { Red = 0x01020304 };

const std::vector<std::byte> numbers_on_wire =
    bytes({0x7F,                                           // Byte
           0x02, 0x01,                                     // UInt16
           0xFE, 0xFF, 0xFF, 0xFF,                         // Int32
           0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01, // UInt64
           0x00, 0x00, 0x80, 0xBF,                         // Float
           0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xF4, 0x3F, // Double
           0x04, 0x03, 0x02, 0x01});                       // Enumeration

} // namespace

TEST_CASE("numbers are little-endian on the wire, whatever the processor is",
          "[binary][wire_order]")
{
    SmallBlocks sink;
    binary::Writer writer{sink};
    writer.number(std::uint8_t{0x7F});
    writer.number(std::uint16_t{0x0102});
    writer.number(std::int32_t{-2});
    writer.number(std::uint64_t{0x0102030405060708});
    writer.number(-1.0F);
    writer.number(1.25);
    writer.number(Colour::Red);
    REQUIRE(writer.ok());
    CHECK(sink.first(writer.written()) == numbers_on_wire);

    binary::Reader reader{numbers_on_wire};
    CHECK(reader.number<std::uint8_t>() == 0x7F);
    CHECK(reader.number<std::uint16_t>() == 0x0102);
    CHECK(reader.number<std::int32_t>() == -2);
    CHECK(reader.number<std::uint64_t>() == 0x0102030405060708);
    CHECK(reader.number<float>() == -1.0F);
    CHECK(reader.number<double>() == 1.25);
    CHECK(reader.number<Colour>() == Colour::Red);
    CHECK(reader.ok());
    CHECK(reader.remaining() == 0);
}

TEST_CASE("arrays of numbers are little-endian on the wire", "[binary][wire_order]")
{
    const auto on_wire =
        bytes({0x02, 0x00, 0x00, 0x00, 0x04, 0x03, 0x02, 0x01, 0xFF, 0xFF, 0xFF, 0xFF});
    const Array<std::uint32_t> values{0x01020304, UINT32_MAX};
    CHECK(*binary::to_bytes(values) == on_wire);
    CHECK(*binary::from_bytes<Array<std::uint32_t>>(on_wire) == values);
    const Array<double> doubles{1.25};
    const auto doubles_on_wire = bytes({0x01, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xF4, 0x3F});
    CHECK(*binary::to_bytes(doubles) == doubles_on_wire);
    CHECK(*binary::from_bytes<Array<double>>(doubles_on_wire) == doubles);
    CHECK(*binary::from_bytes<Array<std::uint16_t>>(bytes({0, 0, 0, 0})) ==
          Array<std::uint16_t>(std::size_t{0}));
}

TEST_CASE("a Guid's numbers are little-endian on the wire", "[binary][wire_order]")
{
    // Part 6, 5.2.2.6
    const Guid guid = *Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63");
    const auto on_wire = bytes({0x91, 0x2B, 0x96, 0x72, 0x75, 0xFA, 0xE6, 0x4A, 0x8D, 0x28, 0xB4,
                                0x04, 0xDC, 0x7D, 0xAF, 0x63});
    CHECK(*binary::to_bytes(guid) == on_wire);
    CHECK(*binary::from_bytes<Guid>(on_wire) == guid);
}

TEST_CASE("a big-endian processor turns each number round", "[binary][wire_order]")
{
    using binary::detail::copy_number;
    using binary::detail::copy_numbers;
    const auto from = bytes({1, 2, 3, 4, 5, 6, 7, 8});
    std::vector<std::byte> to(8);
    copy_number<8, std::endian::big>(to.data(), from.data());
    CHECK(to == bytes({8, 7, 6, 5, 4, 3, 2, 1}));
    copy_numbers<2, std::endian::big>(to.data(), from.data(), 4);
    CHECK(to == bytes({2, 1, 4, 3, 6, 5, 8, 7}));
    copy_numbers<4, std::endian::big>(to.data(), from.data(), 2);
    CHECK(to == bytes({4, 3, 2, 1, 8, 7, 6, 5}));
    copy_numbers<1, std::endian::big>(to.data(), from.data(), 8);
    CHECK(to == from);
    copy_numbers<4, std::endian::little>(to.data(), from.data(), 2);
    CHECK(to == from);
    copy_numbers<4, std::endian::big>(nullptr, nullptr, 0);
    copy_numbers<4, std::endian::little>(nullptr, nullptr, 0);
}

TEST_CASE("what a message may take in memory does not wrap where a size has 32 bits",
          "[binary][wire_order]")
{
    const auto message = bytes({2, 0, 0, 0, 1, 1});
    binary::Reader reader{message};
    CHECK(reader.array_length(1, std::size_t{1} << 31U) == -1);
    CHECK(reader.status() == status::Bad_EncodingLimitsExceeded);

    binary::DecodeLimits limits;
    limits.max_expansion = std::numeric_limits<std::uint32_t>::max();
    binary::Reader generous{message, binary::Strings::Own, nullptr, limits};
    CHECK(generous.array_length(1, 1'000'000) == 2);
}

} // namespace wire_order_test
