#include <busbar/backend/slmp_message.hpp>

#include <catch2/catch.hpp>

namespace message_test {

using namespace busbar;
using namespace busbar::backend;

namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<unsigned> values)
{
    Bytes result;
    for (const unsigned value : values) {
        result.push_back(static_cast<std::byte>(value));
    }
    return result;
}

SlmpBlock block(std::uint32_t number, std::uint16_t points = 1, std::uint16_t code = 0xA8)
{
    return {{code, number}, points};
}

StatusCode refusal(const SlmpOperation& operation)
{
    const auto frame = encode_slmp_request({}, 16, operation);
    return frame ? StatusCode{} : frame.error();
}

/// The end code for a request with this data, 0 if it is served.
std::uint16_t end_code(std::uint16_t command, std::uint16_t subcommand, const Bytes& data)
{
    const auto operation = decode_slmp_request({16, command, subcommand, data});
    return operation ? std::uint16_t{0} : operation.error();
}

SlmpOperation read_back(const SlmpOperation& operation)
{
    const auto frame = encode_slmp_request({}, 16, operation);
    REQUIRE(frame);
    const auto head = read_slmp_head(*frame);
    REQUIRE((head && *head));
    const auto body = read_slmp_request(**head, *frame);
    REQUIRE(body);
    const auto decoded = decode_slmp_request(*body);
    REQUIRE(decoded);
    return *decoded;
}

} // namespace

TEST_CASE("operations that no SLMP request can have are refused before they are sent")
{
    const StatusCode invalid{status::Bad_InvalidArgument};
    using enum SlmpCommand;
    CHECK(refusal({.command = BatchRead}) == invalid);
    CHECK(refusal({.command = BatchRead, .blocks = {block(1), block(2)}}) == invalid);
    CHECK(refusal({.command = BatchRead, .blocks = {block(0x1000000)}}) == invalid);
    CHECK(refusal({.command = BatchRead, .blocks = {block(1, 1, 0x2C00)}}) == invalid);
    CHECK(refusal({.command = BatchWrite, .blocks = {block(1, 2)}, .words = {1}}) == invalid);
    CHECK(refusal({.command = RandomRead, .is_bits = true, .blocks = {block(1)}}) == invalid);
    CHECK(refusal({.command = RandomRead, .blocks = {block(1, 2)}}) == invalid);
    CHECK(refusal({.command = RandomRead, .blocks = std::vector<SlmpBlock>(256, block(1))}) ==
          invalid);
    CHECK(refusal({.command = RandomWrite, .blocks = {block(1)}}) == invalid);
    CHECK(refusal({.command = RandomWrite,
                   .is_bits = true,
                   .more_blocks = {block(1)},
                   .words = {1, 2}}) == invalid);
    CHECK(refusal({.command = BlockWrite, .blocks = {block(1, 3)}, .words = {1, 2}}) == invalid);
    CHECK(refusal({.command = SelfTest}) == invalid);
    CHECK(refusal({.command = SelfTest, .text = std::string(961, 'A')}) == invalid);
    CHECK(refusal({.command = Unlock, .text = std::string(33, 'A')}) == invalid);
    CHECK(refusal({.command = LabelRandomRead, .labels = {{.name = "\xC3"}}}) == invalid);
    CHECK(refusal({.command = LabelRandomRead, .abbreviations = {"\xFF"}}) == invalid);
    CHECK(refusal({.command = LabelArrayWrite, .labels = {{"L", false, 2, bytes({1})}}}) ==
          invalid);
    CHECK(refusal({.command = LabelArrayWrite, .labels = {{"L", true, 17, bytes({1, 0})}}}) ==
          invalid);
    CHECK(refusal({.command = static_cast<SlmpCommand>(0x9999)}) == invalid);
    const std::vector<std::uint16_t> many(40'000, 1);
    CHECK(refusal({.command = BatchWrite, .blocks = {block(1, 40'000)}, .words = many}) ==
          StatusCode{status::Bad_RequestTooLarge});
    CHECK(refusal({.command = BatchWrite,
                   .is_bits = true,
                   .blocks = {block(1, 40'000)},
                   .words = many}) == StatusCode{});
}

TEST_CASE("requests that have no meaning get the end code that says so")
{
    CHECK(end_code(0x0401, 0, bytes({1, 0, 0, 0xA8, 1, 0})) == 0);
    CHECK(end_code(0x0401, 4, bytes({1, 0, 0, 0xA8, 1, 0})) == 0xC059);
    CHECK(end_code(0x0403, 1, bytes({0})) == 0xC059);
    CHECK(end_code(0x0101, 2, {}) == 0xC059);
    CHECK(end_code(0x0101, 0, bytes({0})) == 0xC061);
    CHECK(end_code(0x0401, 0, bytes({1, 0, 0, 0xA8, 1})) == 0xC061);
    // Bits that are neither on nor off.
    CHECK(end_code(0x1401, 1, bytes({1, 0, 0, 0x90, 2, 0, 0x12})) == 0xC060);
    CHECK(end_code(0x1401, 1, bytes({1, 0, 0, 0x90, 1, 0, 0x11})) == 0xC060);
    CHECK(end_code(0x1402, 1, bytes({1, 1, 0, 0, 0x90, 2})) == 0xC060);
    // Modification by an index register, and an extension of nothing.
    CHECK(end_code(0x0401, 0x80, bytes({0, 1, 0, 0, 0, 0xA8, 0, 0, 0, 0, 0, 1, 0})) == 0xC05C);
    CHECK(end_code(0x0401, 0x80, bytes({0, 0, 0, 0, 0, 0xA8, 0, 0, 1, 0, 0, 1, 0})) == 0xC05C);
    CHECK(end_code(0x0401, 0x80, bytes({0, 0, 0, 0, 0, 0xA8, 0, 0, 0, 0, 0, 1, 0})) == 0);
    // Counts of more than there is.
    CHECK(end_code(0x0403, 0, bytes({0xFF, 0xFF, 1, 0, 0, 0xA8})) == 0xC061);
    CHECK(end_code(0x1406, 0, bytes({1, 0, 0, 0, 0, 0xA8, 0xFF, 0xFF, 1, 0})) == 0xC061);
    CHECK(end_code(0x041C, 0, bytes({0xFF, 0xFF, 0, 0})) == 0xC061);
    CHECK(end_code(0x041C, 0, bytes({1, 0, 0xFF, 0xFF})) == 0xC061);
    CHECK(end_code(0x141B, 0, bytes({1, 0, 0, 0, 1, 0, 'A', 0, 0xFF, 0xFF, 1, 2})) == 0xC061);
    // Half of a character, and characters without their other half.
    CHECK(end_code(0x041C, 0, bytes({1, 0, 0, 0, 2, 0, 'A', 0, 'B'})) == 0xC061);
    CHECK(end_code(0x041C, 0, bytes({1, 0, 0, 0, 1, 0, 0x00, 0xD8})) == 0xC061);
    CHECK(end_code(0x041C, 0, bytes({1, 0, 0, 0, 2, 0, 0x00, 0xDC, 0x00, 0xD8})) == 0xC061);
    // Units of arrays, texts and modes.
    CHECK(end_code(0x041A, 0, bytes({1, 0, 0, 0, 1, 0, 'A', 0, 2, 0, 1, 0})) == 0xC05C);
    CHECK(end_code(0x041A, 0, bytes({1, 0, 0, 0, 1, 0, 'A', 0, 1, 1, 1, 0})) == 0xC05C);
    CHECK(end_code(0x0619, 0, bytes({0, 0})) == 0xC05C);
    CHECK(end_code(0x1001, 0, bytes({2, 0, 0, 0})) == 0xC05C);
    CHECK(end_code(0x1001, 0, bytes({1, 0, 3, 0})) == 0xC05C);
}

TEST_CASE("names of labels keep every character, and bits of a batch every bit")
{
    SlmpOperation labels{
        .command = SlmpCommand::LabelRandomWrite,
        .abbreviations = {"Stra\xC3\x9F"
                          "e"},
        .labels = {{.name = "%1.\xE6\xB8\xA9\xE5\xBA\xA6[0,1,2]", .data = bytes({1, 2})},
                   {.name = "\xF0\x9F\x98\x80", .data = bytes({})}}};
    CHECK(read_back(labels) == labels);
    for (std::uint16_t count = 0; count < 6; ++count) {
        SlmpOperation bits{
            .command = SlmpCommand::BatchWrite, .is_bits = true, .blocks = {block(7, count, 0x90)}};
        for (std::uint16_t i = 0; i < count; ++i) {
            bits.words.push_back(i % 3 == 0 ? 1 : 0);
        }
        CHECK(read_back(bits) == bits);
    }
}

TEST_CASE("what is no SLMP frame is refused at its first bytes")
{
    const auto is_refused = [](const Bytes& frame) { return !read_slmp_head(frame).has_value(); };
    CHECK_FALSE(is_refused({}));
    CHECK_FALSE(is_refused(bytes({0x50})));
    CHECK(is_refused(bytes({0x35}))); // ASCII
    CHECK(is_refused(bytes({0x51})));
    CHECK(is_refused(bytes({0xD0, 1})));
    CHECK(is_refused(bytes({0x50, 0, 0, 0xFF, 0xFF, 3, 0, 5, 0})));
    CHECK_FALSE(is_refused(bytes({0x50, 0, 0, 0xFF, 0xFF, 3, 0, 6, 0})));
    CHECK(is_refused(bytes({0xD0, 0, 0, 0xFF, 0xFF, 3, 0, 1, 0})));
    CHECK_FALSE(is_refused(bytes({0xD0, 0, 0, 0xFF, 0xFF, 3, 0, 2, 0})));
}

TEST_CASE("an SLMP answer fits its request or is none")
{
    const SlmpOperation operation{.command = SlmpCommand::BatchRead, .blocks = {block(1, 2)}};
    const auto answer = [&](Bytes rest) {
        Bytes frame = bytes({0xD0, 0, 0, 0xFF, 0xFF, 3, 0, 0, 0});
        frame[7] = static_cast<std::byte>(rest.size());
        frame.insert(frame.end(), rest.begin(), rest.end());
        return decode_slmp_answer(operation, **read_slmp_head(frame), frame);
    };
    CHECK(answer(bytes({0, 0, 1, 0, 2, 0}))->words == std::vector<std::uint16_t>{1, 2});
    CHECK_FALSE(answer(bytes({0, 0, 1, 0})));
    CHECK_FALSE(answer(bytes({0, 0, 1, 0, 2, 0, 3, 0})));
    // With and without error information, and with half of it.
    CHECK(answer(bytes({0x31, 0x40, 0, 0xFF, 0xFF, 3, 0, 1, 4, 0, 0}))->error->command == 0x0401);
    CHECK(answer(bytes({0x31, 0x40}))->end_code == 0x4031);
    CHECK_FALSE(answer(bytes({0x31, 0x40, 0, 0xFF})));
}

} // namespace message_test
