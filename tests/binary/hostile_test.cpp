#include <fstream>

#include <catch2/catch.hpp>

#include "structures.hpp"

// Every structure of the vectors, damaged byte by byte: nothing may crash or take memory without
// bounds, whatever is read. The sanitizer builds watch.
namespace busbar::test::hostile_test {

namespace {

struct Sample {
    const NamedType* type;
    std::vector<std::byte> bytes;
};

std::vector<Sample> samples()
{
    std::vector<Sample> result;
    std::ifstream file{BUSBAR_SOURCE_DIR "/tests/vectors/structs.jsonl"};
    for (std::string line; std::getline(file, line);) {
        const Json row = Json::parse(line);
        result.push_back({find_type(row["type"]), from_hex(row["hex"])});
    }
    REQUIRE(result.size() > 50);
    return result;
}

bool is_decoding_status(StatusCode code)
{
    return code == status::Bad_DecodingError || code == status::Bad_EncodingLimitsExceeded;
}

} // namespace

TEST_CASE("A structure cut at any offset is rejected")
{
    for (const Sample& sample : samples()) {
        for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
            const auto decoded = sample.type->recode(std::span{sample.bytes}.first(size));
            REQUIRE_FALSE(decoded);
            CHECK(decoded.error() == status::Bad_DecodingError);
        }
    }
}

TEST_CASE("Four bytes anywhere may become any length")
{
    constexpr std::uint32_t lengths[] = {0,          1,          0x7FFF,     0x10000,
                                         0x7FFFFFFF, 0x80000000, 0xFFFFFFFE, 0xFFFFFFFF};
    for (const Sample& sample : samples()) {
        for (std::size_t at = 0; at + 4 <= sample.bytes.size(); ++at) {
            for (const std::uint32_t length : lengths) {
                auto bytes = sample.bytes;
                for (unsigned i = 0; i < 4; ++i) {
                    bytes[at + i] = static_cast<std::byte>(length >> (8 * i));
                }
                const auto decoded = sample.type->recode(bytes);
                CHECK((decoded || is_decoding_status(decoded.error())));
            }
        }
    }
}

TEST_CASE("Any byte may have any bit turned")
{
    for (const Sample& sample : samples()) {
        for (std::size_t at = 0; at < sample.bytes.size(); ++at) {
            for (unsigned bit = 0; bit < 8; ++bit) {
                auto bytes = sample.bytes;
                bytes[at] ^= static_cast<std::byte>(1U << bit);
                const auto decoded = sample.type->recode(bytes);
                CHECK((decoded || is_decoding_status(decoded.error())));
            }
        }
    }
}

TEST_CASE("Bytes behind a structure are an error")
{
    for (Sample sample : samples()) {
        sample.bytes.push_back(std::byte{0});
        CHECK_FALSE(sample.type->recode(sample.bytes));
    }
}

namespace {

/// A Variant with `levels` others in one another, each an array of one.
std::vector<std::byte> nested_variants(std::size_t levels)
{
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i < levels; ++i) {
        for (const int byte : {0x98, 1, 0, 0, 0}) {
            bytes.push_back(static_cast<std::byte>(byte));
        }
    }
    bytes.insert(bytes.end(), {std::byte{0x01}, std::byte{0x01}}); // true
    return bytes;
}

} // namespace

// Part 6, 5.1.5: decoders support at least 100 levels.
TEST_CASE("A hundred values in one another are decoded and encoded, one more is not")
{
    const auto decode = [](std::size_t levels) {
        return binary::from_bytes<Variant>(nested_variants(levels));
    };
    for (const std::size_t levels : {std::size_t{99}, std::size_t{100}}) {
        const auto value = decode(levels);
        REQUIRE(value);
        CHECK(binary::to_bytes(*value).value() == nested_variants(levels));
    }
    for (const std::size_t levels : {std::size_t{101}, std::size_t{102}, std::size_t{10'000}}) {
        const auto value = decode(levels);
        REQUIRE_FALSE(value);
        CHECK(value.error() == status::Bad_EncodingLimitsExceeded);
    }
    Variant deepest = *decode(100);
    CHECK_FALSE(binary::to_bytes(Variant{Array<Variant>{std::move(deepest)}}));
}

} // namespace busbar::test::hostile_test
