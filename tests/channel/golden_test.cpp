#include <cstdlib>
#include <fstream>
#include <map>

#include <catch2/catch.hpp>

#include <busbar/types/secure_channel.hpp>

#include "channel/conversation.hpp"
#include "support/channel_pair.hpp"

namespace golden_test {

using namespace busbar;
using namespace busbar::channel::detail;
using Bytes = std::vector<std::byte>;

namespace {

/// The text after `"key":"` in a line of JSON up to the next quote.
std::string text_field(const std::string& line, const std::string& key)
{
    const auto at = line.find("\"" + key + "\":\"");
    REQUIRE(at != std::string::npos);
    const auto begin = at + key.size() + 4;
    return line.substr(begin, line.find('"', begin) - begin);
}

/// The messages of an independent stack by id.
std::map<std::string, Bytes> golden_messages()
{
    const char* const chosen = std::getenv("BUSBAR_VECTORS");
    const std::string folder = chosen != nullptr ? chosen : BUSBAR_SOURCE_DIR "/tests/vectors";
    std::ifstream file{folder + "/messages.jsonl"};
    REQUIRE(file);
    std::map<std::string, Bytes> rows;
    for (std::string line; std::getline(file, line);) {
        const std::string hex = text_field(line, "hex");
        Bytes bytes;
        for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
            bytes.push_back(static_cast<std::byte>(std::stoul(hex.substr(i, 2), nullptr, 16)));
        }
        rows[text_field(line, "id")] = bytes;
    }
    return rows;
}

std::span<const std::byte> body(const Bytes& message)
{
    return std::span{message}.subspan(header_size);
}

Bytes bytes_of(const OutputBuffer& output)
{
    return {output.output().begin(), output.output().end()};
}

/// Both directions of an OPN with policy None.
template <typename T>
void check_open(const Bytes& golden, std::uint32_t channel_id)
{
    const auto header = parse_asymmetric_header(golden);
    REQUIRE(header);
    CHECK(header->channel_id == channel_id);
    CHECK(header->policy->is_none());
    const auto content = open_asymmetric(golden, *header, nullptr, nullptr);
    REQUIRE(content);
    CHECK(content->sequence_number == 1);
    CHECK(content->request_id == 1);
    const auto structure = decode_message<T>(content->body);
    REQUIRE(structure);
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_message(writer, *structure);
    OutputBuffer output;
    REQUIRE(seal_asymmetric(
        output, {channel_id, header->policy, nullptr, nullptr, 1, 1, sink.take(writer.written())},
        65'535));
    CHECK(bytes_of(output) == golden);
}

/// The body of one or more chunks of policy None, and the chunks that it is sent in.
void check_chunks(Bytes golden, MessageType type, std::uint32_t chunk_size)
{
    Token token;
    token.id = 1;
    const Bytes before = golden;
    std::span<std::byte> rest{golden};
    Bytes whole;
    std::uint32_t first_sequence = 0;
    std::uint32_t request_id = 0;
    while (!rest.empty()) {
        const auto header = parse_frame_header(rest, 65'535);
        REQUIRE(header);
        CHECK(header->type == type);
        const auto chunk = rest.first(header->size);
        CHECK(header->chunk == (chunk.size() == rest.size() ? 'F' : 'C'));
        const auto ids = parse_symmetric_header(chunk);
        REQUIRE(ids);
        CHECK(ids->channel_id == 11);
        CHECK(ids->token_id == 1);
        const auto content = open_symmetric(chunk, {}, token);
        REQUIRE(content);
        first_sequence = first_sequence == 0 ? content->sequence_number : first_sequence;
        request_id = content->request_id;
        whole.insert(whole.end(), content->body.begin(), content->body.end());
        rest = rest.subspan(chunk.size());
    }
    OutputBuffer output;
    SequenceNumbers sequence;
    sequence.reset_to(first_sequence - 1);
    ChunkSink sink{output,
                   token,
                   sequence,
                   {type, 11, request_id, {}, chunk_size, 65'535, 100, status::Bad_InternalError}};
    binary::Writer writer{sink};
    writer.bytes(whole);
    REQUIRE(sink.finish(writer.filled()));
    CHECK(bytes_of(output) == before);
}

} // namespace

TEST_CASE("golden messages of the connection protocol", "[channel][vectors][unit:Protocol UA TCP]")
{
    const auto rows = golden_messages();
    for (const char* id : {"messages/HEL", "messages/HEL null url"}) {
        const Bytes& golden = rows.at(id);
        const auto hello = parse_hello(body(golden));
        REQUIRE(hello);
        CHECK(hello->receive_buffer_size == 65'535);
        CHECK(hello->send_buffer_size == 65'536);
        CHECK(hello->max_message_size == 16'777'216);
        OutputBuffer output;
        write_hello(output, *hello);
        CHECK(bytes_of(output) == golden);
    }
    const auto acknowledge = parse_acknowledge(body(rows.at("messages/ACK")));
    REQUIRE(acknowledge);
    OutputBuffer output;
    write_acknowledge(output, *acknowledge);
    CHECK(bytes_of(output) == rows.at("messages/ACK"));
    const auto error = parse_error(body(rows.at("messages/ERR")));
    REQUIRE(error);
    CHECK(error->error == status::Bad_TcpMessageTypeInvalid);
    OutputBuffer second;
    write_error(second, error->error, error->reason.view());
    CHECK(bytes_of(second) == rows.at("messages/ERR"));
    const auto silent = parse_error(body(rows.at("messages/ERR null reason")));
    REQUIRE(silent);
    CHECK(silent->error == status::Bad_TcpMessageTooLarge);
    CHECK(silent->reason.is_null());
}

TEST_CASE("golden messages that open a channel", "[channel][vectors][unit:UA Secure Conversation]")
{
    const auto rows = golden_messages();
    check_open<OpenSecureChannelRequest>(rows.at("messages/OPN request None"), 0);
    check_open<OpenSecureChannelResponse>(rows.at("messages/OPN response None"), 11);
}

TEST_CASE("golden chunks", "[channel][vectors][unit:UA Secure Conversation]")
{
    for (const auto& [id, bytes] : golden_messages()) {
        INFO(id);
        if (id == "messages/MSG chunked GetEndpointsResponse") {
            check_chunks(bytes, MessageType::MSG, 124);
        } else if (id == "messages/CLO") {
            check_chunks(bytes, MessageType::CLO, 65'535);
        } else if (id.find("/MSG ") != std::string::npos && id != "messages/MSG abort") {
            check_chunks(bytes, MessageType::MSG, 65'535);
        }
    }
}

TEST_CASE("a golden abort", "[channel][vectors]")
{
    Bytes bytes = golden_messages().at("messages/MSG abort");
    const auto header = parse_frame_header(bytes, 65'535);
    REQUIRE(header);
    CHECK(header->chunk == 'A');
    Token token;
    const auto content = open_symmetric(bytes, {}, token);
    REQUIRE(content);
    CHECK(content->sequence_number == 300);
    Assembly assembly{{}, nullptr};
    const auto event = assembly.add(header->chunk, *content);
    REQUIRE((event && *event));
    CHECK((*event)->kind == channel::ChannelEvent::Kind::Aborted);
    CHECK((*event)->request_id == 88);
    CHECK((*event)->status == status::Bad_RequestTooLarge);
    CHECK((*event)->reason == "too large");
}

} // namespace golden_test
