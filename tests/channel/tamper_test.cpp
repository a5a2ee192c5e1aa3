#include <catch2/catch.hpp>

#include "support/effort.hpp"
#include "tampering.hpp"

namespace tamper_test {

using namespace busbar;
using namespace busbar::test;
using namespace busbar::channel::detail;
using channel::ClientChannel;
using channel::SecuritySetting;
using channel::ServerChannel;
using Kind = channel::ChannelEvent::Kind;

namespace {

/// Whether both have the same keys and algorithms once a channel is open: policies may differ in
/// nothing but how they open one.
bool is_alike(const SecuritySetting& a, const SecuritySetting& b)
{
    const bool is_encrypted = a.mode == MessageSecurityMode::SignAndEncrypt;
    return a.mode == b.mode && a.policy->digest == b.policy->digest &&
           a.policy->signing_key_size == b.policy->signing_key_size &&
           (!is_encrypted || a.policy->encrypting_key_size == b.policy->encrypting_key_size);
}

/// Why a chunk is refused one byte of which, `at` bytes from its beginning, was changed.
StatusCode refusal_of_chunk(std::size_t at)
{
    if (at < 4) {
        return status::Bad_TcpMessageTypeInvalid;
    }
    if (at == 6 || at == 7) {
        return status::Bad_TcpMessageTooLarge; // the high bytes of its size
    }
    if (at >= 8 && at < 12) {
        return status::Bad_TcpSecureChannelUnknown;
    }
    return at >= 12 && at < 16 ? status::Bad_SecureChannelTokenUnknown
                               : status::Bad_SecurityChecksFailed;
}

/// Flips a bit of every byte of `message`, chunks of a message that an open channel waits for. What
/// follows the headers of a chunk is alike: unless the effort is full, the round's third of it.
template <typename Engine>
void flip_every_byte(const Recording<Engine>& recording, const Bytes& message)
{
    constexpr std::size_t headers_size = 24;
    const Turns turns{"flipped", 3};
    std::size_t chunk = 0;
    for (std::size_t at = 0; at < message.size(); ++at) {
        INFO("byte " << at << " of " << message.size());
        const auto header = parse_frame_header(std::span{message}.subspan(chunk), 65'535);
        REQUIRE(header);
        if (at == chunk + header->size) {
            chunk = at;
        }
        if (at - chunk >= headers_size && at % turns.stride != turns.first) {
            continue;
        }
        Subject<Engine> subject{recording.script.security};
        recording.bring(subject, Stage::Open);
        subject.feed(flipped(message, at));
        subject.feed(Bytes(8'192)); // for a chunk that is said to be longer now
        const StatusCode status = refusal_of_chunk(at - chunk);
        check_refused(subject, status, status);
    }
}

} // namespace

TEMPLATE_TEST_CASE("a chunk is refused whichever byte of it was changed", "[channel][tamper]",
                   ServerChannel, ClientChannel)
{
    for (const SecuritySetting& setting : all_settings()) {
        INFO(setting.policy->name << " mode " << static_cast<int>(setting.mode));
        Recording<TestType> recording{setting};
        const std::uint32_t sequence = recording.script.sequence;
        flip_every_byte(recording, recording.script.message(MessageType::MSG));
        recording.script.sequence = sequence;
        flip_every_byte(recording, recording.script.message(MessageType::MSG, 40, 80));
        if (Subject<TestType>::is_server) {
            recording.script.sequence = sequence;
            flip_every_byte(recording, recording.script.message(MessageType::CLO));
        }
    }
}

TEMPLATE_TEST_CASE("wrong padding is refused although it is signed", "[channel][tamper]",
                   ServerChannel, ClientChannel)
{
    for (const SecuritySetting& setting : all_settings()) {
        if (setting.mode != MessageSecurityMode::SignAndEncrypt) {
            continue;
        }
        INFO(setting.policy->name);
        Recording<TestType> recording{setting};
        // As much body as leaves three bytes of padding, besides their number.
        const std::size_t body = 16 + (16 + 12 - 8 - setting.policy->symmetric_signature_size) % 16;
        const Bytes good = recording.script.message(MessageType::MSG, body);
        struct Row {
            std::size_t from_end;
            unsigned byte;
        };
        for (const Row& row : {Row{1, 2}, Row{1, 4}, Row{1, 255}, Row{2, 0}, Row{4, 255}}) {
            INFO("the byte " << row.from_end << " from the end is " << row.byte);
            Subject<TestType> subject{setting};
            recording.bring(subject, Stage::Open);
            subject.feed(recording.script.resealed(good, [&](std::span<std::byte> text) {
                REQUIRE(text.back() == std::byte{3});
                text[text.size() - row.from_end] = static_cast<std::byte>(row.byte);
            }));
            check_refused(subject, status::Bad_SecurityChecksFailed);
        }
    }
}

TEMPLATE_TEST_CASE("chunks are taken in their order only", "[channel][tamper]", ServerChannel,
                   ClientChannel)
{
    struct Row {
        const char* name;
        std::uint32_t of_open;           // the sequence number of the OPN
        std::vector<std::uint32_t> sent; // those of the chunks after it
        std::size_t delivered;           // how many of them; if not all, the next one is refused
    };
    constexpr std::uint32_t last = 4'294'966'272; // the first that the next may wrap after
    const std::vector<Row> rows = {{"in order", 7, {8, 9, 10}, 3},
                                   {"replayed", 7, {8, 8}, 1},
                                   {"replayed later", 7, {8, 9, 8}, 2},
                                   {"the number of the OPN", 7, {7}, 0},
                                   {"back by one", 7, {6}, 0},
                                   {"one left out", 7, {9}, 0},
                                   {"exchanged", 7, {9, 8}, 0},
                                   {"begun again", 7, {0}, 0},
                                   {"wrapped to 0", last, {0, 1}, 2},
                                   {"wrapped to 1", last, {1}, 1},
                                   {"wrapped to 1023", last, {1'023}, 1},
                                   {"wrapped too far", last, {1'024}, 0},
                                   {"wrapped too early", last - 2, {1}, 0},
                                   {"wrapped late", UINT32_MAX, {0}, 1},
                                   {"jumped to the end", last, {UINT32_MAX}, 0}};
    for (const SecuritySetting& setting : all_settings()) {
        for (const Row& row : rows) {
            INFO(setting.policy->name << " " << row.name);
            Recording<TestType> recording{setting, row.of_open};
            Subject<TestType> subject{setting};
            recording.bring(subject, Stage::Open);
            for (const std::uint32_t number : row.sent) {
                subject.feed(recording.script.message_numbered(number));
            }
            REQUIRE(subject.count(Kind::Message) == row.delivered);
            if (row.delivered == row.sent.size()) {
                CHECK(subject.engine.is_open());
                continue;
            }
            subject.events.erase(subject.events.begin(),
                                 subject.events.begin() +
                                     static_cast<std::ptrdiff_t>(row.delivered));
            check_refused(subject, status::Bad_SequenceNumberInvalid);
        }
    }
}

TEMPLATE_TEST_CASE("chunks of another channel, token, policy or mode are refused",
                   "[channel][tamper]", ServerChannel, ClientChannel)
{
    for (const SecuritySetting& setting : all_settings()) {
        Recording<TestType> recording{setting};
        const auto refused = [&](auto change, StatusCode status) {
            Script<TestType> script{setting};
            script.sequence = recording.script.sequence;
            script.token_id = recording.script.token_id;
            script.own_nonce = recording.script.own_nonce;
            script.peer_nonce = recording.script.peer_nonce;
            change(script);
            script.agree();
            Subject<TestType> subject{setting};
            recording.bring(subject, Stage::Open);
            subject.feed(script.message(MessageType::MSG));
            check_refused(subject, status, status);
        };
        for (const std::uint32_t id : {0U, 76U, 78U, UINT32_MAX}) {
            refused([&](auto& script) { script.sent_channel_id = id; },
                    status::Bad_TcpSecureChannelUnknown);
            refused([&](auto& script) { script.token_id = id; },
                    status::Bad_SecureChannelTokenUnknown);
        }
        refused([](auto& script) { script.own_nonce[0] ^= std::byte{1}; },
                status::Bad_SecurityChecksFailed);
        for (const char flag : {'C', 'A'}) { // of what was a whole message
            Subject<TestType> subject{setting};
            recording.bring(subject, Stage::Open);
            Bytes message = recording.script.message_numbered(recording.script.sequence + 1);
            message[3] = static_cast<std::byte>(flag);
            subject.feed(message);
            check_refused(subject, status::Bad_SecurityChecksFailed);
        }
        for (const SecuritySetting& other : all_settings()) {
            if (!is_alike(other, setting)) {
                INFO(setting.policy->name << " " << other.policy->name);
                refused([&](auto& script) { script.security = other; },
                        status::Bad_SecurityChecksFailed);
            }
        }
    }
}

} // namespace tamper_test
