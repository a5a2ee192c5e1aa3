#include <map>

#include <catch2/catch.hpp>

#include "slmp_vectors.hpp"

// Captures of PLCs, examples of manuals and vectors of other implementations.
namespace slmp_vector_test {

using namespace busbar;
using namespace busbar::backend;
using namespace busbar::test;

namespace {

/// A request is written as its bytes are, and read as what it was written from.
void check_request(const SlmpHead& head, std::uint16_t timer, const SlmpOperation& operation,
                   const std::vector<std::byte>& golden)
{
    const auto encoded = encode_slmp_request(head, timer, operation);
    REQUIRE(encoded);
    CHECK(hex_of(*encoded) == hex_of(golden));
    const auto read = read_slmp_head(golden);
    REQUIRE((read && *read));
    CHECK((*read)->size == golden.size());
    CHECK((*read)->serial == head.serial);
    CHECK((*read)->station == head.station);
    const auto body = read_slmp_request(**read, golden);
    REQUIRE(body);
    CHECK(body->timer == timer);
    CHECK(body->command == static_cast<std::uint16_t>(operation.command));
    CHECK(body->subcommand == slmp_subcommand(operation));
    const auto decoded = decode_slmp_request(*body);
    REQUIRE(decoded);
    if (operation.command != SlmpCommand::ReadMonitor) {
        CHECK(*decoded == operation);
    }
}

void check_answer(const SlmpHead& request, const SlmpOperation& operation, const SlmpAnswer& answer,
                  const std::vector<std::byte>& golden)
{
    const auto encoded = encode_slmp_answer(request, operation, answer);
    REQUIRE(encoded);
    CHECK(hex_of(*encoded) == hex_of(golden));
    const auto head = read_slmp_head(golden);
    REQUIRE((head && *head));
    CHECK((*head)->is_response);
    CHECK((*head)->size == golden.size());
    const auto decoded = decode_slmp_answer(operation, **head, golden);
    REQUIRE(decoded);
    CHECK(*decoded == answer);
}

} // namespace

TEST_CASE("SLMP frames of PLCs, manuals and other implementations in both directions", "[vectors]")
{
    std::size_t count = 0;
    for (const Json& row : slmp_rows("slmp-frames.jsonl")) {
        INFO(row["name"]);
        SlmpHead head;
        head.frame = row["frame"] == "4E" ? SlmpFrame::Frame4E : SlmpFrame::Frame3E;
        head.serial = row.value("serial", std::uint16_t{0});
        head.station = station_of(row);
        const auto golden = bytes_of(row["request"]);
        if (row["command"] == "9999") {
            const auto read = read_slmp_head(golden);
            REQUIRE((read && *read));
            const auto refused = decode_slmp_request(*read_slmp_request(**read, golden));
            REQUIRE_FALSE(refused);
            CHECK(refused.error() == 0xC059);
            ++count;
            continue;
        }
        const auto operation = operation_of(code_of(row["command"]), code_of(row["subcommand"]),
                                            row["request_fields"]);
        check_request(head, row["timer"].get<std::uint16_t>(), operation, golden);
        if (!row["response"].is_null()) {
            check_answer(head, operation, answer_of(row["response_fields"]),
                         bytes_of(row["response"]));
        }
        ++count;
    }
    CHECK(count == 64);
}

TEST_CASE("SLMP requests on which five implementations agree", "[vectors]")
{
    const std::map<std::string, std::pair<std::uint16_t, std::uint16_t>> commands{
        {"read type name", {0x0101, 0}},          {"batch read, words", {0x0401, 2}},
        {"batch write, bits", {0x1401, 3}},       {"random read", {0x0403, 2}},
        {"random write, bits", {0x1402, 3}},      {"block read", {0x0406, 2}},
        {"remote password, unlock", {0x1630, 0}}, {"remote reset", {0x1006, 0}}};
    for (const Json& row : slmp_rows("slmp.jsonl")) {
        INFO(row["name"]);
        const auto [command, subcommand] = commands.at(row["command"].get<std::string>());
        SlmpHead head;
        head.frame = SlmpFrame::Frame4E;
        const auto operation = operation_of(command, subcommand, row);
        check_request(head, row["timer"].get<std::uint16_t>(), operation, bytes_of(row["request"]));

        // Their responses are given without a frame.
        std::vector<std::byte> frame = bytes_of(Json("d4000000000000ffff0300"));
        const auto data = bytes_of(row["response_data"]);
        frame.push_back(static_cast<std::byte>(data.size() + 2));
        frame.resize(frame.size() + 3);
        frame.insert(frame.end(), data.begin(), data.end());
        const auto response = read_slmp_head(frame);
        REQUIRE((response && *response));
        const auto answer = decode_slmp_answer(operation, **response, frame);
        REQUIRE(answer);
        CHECK(hex_of(*encode_slmp_answer(head, operation, *answer)) == hex_of(frame));
    }
}

TEST_CASE("an SLMP frame that is cut anywhere, or has a byte too many, is no message", "[vectors]")
{
    for (const Json& row : slmp_rows("slmp-frames.jsonl")) {
        if (row["command"] == "9999" || row["response"].is_null()) {
            continue;
        }
        INFO(row["name"]);
        const auto operation = operation_of(code_of(row["command"]), code_of(row["subcommand"]),
                                            row["request_fields"]);
        for (const char* const which : {"request", "response"}) {
            const auto frame = bytes_of(row[which]);
            const auto head = **read_slmp_head(frame);
            for (std::size_t size = 0; size < frame.size(); ++size) {
                const auto part = std::span{frame}.first(size);
                const auto read = read_slmp_head(part);
                REQUIRE(read);
                CHECK(read->has_value() == (size >= head.head_size));
                CHECK_FALSE(read_slmp_request(head, part));
                CHECK_FALSE(decode_slmp_answer(operation, head, part));
            }
        }
        // Cut with a length that fits.
        const auto frame = bytes_of(row["request"]);
        const auto head = **read_slmp_head(frame);
        const auto body = *read_slmp_request(head, frame);
        for (std::size_t size = 0; size < body.data.size(); ++size) {
            auto shorter = body;
            shorter.data = body.data.first(size);
            const auto decoded = decode_slmp_request(shorter);
            REQUIRE_FALSE(decoded);
            CHECK(decoded.error() == 0xC061);
        }
        std::vector<std::byte> more(body.data.begin(), body.data.end());
        more.push_back(std::byte{0});
        auto longer = body;
        longer.data = more;
        CHECK(decode_slmp_request(longer).error() == 0xC061);
    }
}

} // namespace slmp_vector_test
