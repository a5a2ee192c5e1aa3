#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/channel/key_log.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/harness/bench.hpp>
#include <busbar/harness/catch.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/types/attribute.hpp>

namespace decrypted_recording_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

class KeyBook final : public channel::KeyLog {
public:
    void write(std::string_view lines) override { text += lines; }

    std::string text;
};

/// A recording of a secured session that reads a level, and the keys of its channel.
struct Secured {
    explicit Secured(MessageSecurityMode mode, const char* policy)
    {
        BenchOptions options;
        options.server.identity = default_server_identity();
        options.server.endpoints[0].security = {crypto::find_policy_by_name(policy), mode};
        options.client.channel.security = options.server.endpoints[0].security;
        options.client.channel.server_certificate = default_server_identity().certificates.front();
        // Several chunks for the long text below.
        options.client.channel.limits.receive_buffer_size = channel::min_buffer_size;
        options.client_parts.identity = &default_client_identity();
        options.client_parts.key_log = &keys;
        Bench bench{options};
        const auto recorder = std::make_shared<Recorder>(1);
        bench.world().network().set_observer(recorder);
        const NodeId level = need(bench.add_variable("Level", Variant{1.5}));
        const NodeId text =
            need(bench.add_variable("Text", Variant{String{std::string(20'000, 'x')}}));
        CHECK_THAT(bench.read(level), holds(1.5));
        CHECK(bench.read(text).value.get_if<String>()->size() == 20'000);
        bench.client().close();
        bench.run_for(1s);
        recording = recorder->recording();
    }

    KeyBook keys;
    Recording recording;
};

std::vector<std::string> names_of(const Recording& recording)
{
    std::vector<std::string> names;
    for (const RecordedMessage& message : read_messages(recording)) {
        names.push_back(message.name);
    }
    return names;
}

std::uint32_t word_at(const std::vector<std::byte>& bytes, std::size_t at)
{
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        word |= std::to_integer<std::uint32_t>(bytes.at(at + i)) << (8 * i);
    }
    return word;
}

} // namespace

#ifdef BUSBAR_KEY_LOG
TEST_CASE("a recording of a secured channel is read with its keys", "[harness]")
{
    const auto mode = GENERATE(MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt);
    const auto* const policy = GENERATE("Basic256Sha256", "Aes128_Sha256_RsaOaep");
    INFO(policy << " " << static_cast<int>(mode));
    const Secured secured{mode, policy};
    const auto before = names_of(secured.recording);
    CHECK(std::count(before.begin(), before.end(), "MSG") >= 5);

    const Recording plain = decrypted(secured.recording, secured.keys.text);
    const auto after = names_of(plain);
    CHECK(after == std::vector<std::string>{"HEL", "ACK", "OPN", "OPN", "CreateSessionRequest",
                                            "CreateSessionResponse", "ActivateSessionRequest",
                                            "ActivateSessionResponse", "ReadRequest",
                                            "ReadResponse", "ReadRequest", "ReadResponse",
                                            "CloseSessionRequest", "CLO"});
    const auto messages = read_messages(plain);
    const auto value = std::find_if(messages.begin(), messages.end(), [](const auto& message) {
        return message.name == "ReadResponse";
    });
    REQUIRE(value != messages.end());
    CHECK(summary(*value).ends_with("server -> ReadResponse Double 1.5"));
    // It is a recording as others are.
    CHECK(need(read_recording(write_recording(plain))) == plain);
}

TEST_CASE("a recording whose keys are not there stays as it is", "[harness]")
{
    const Secured secured{MessageSecurityMode::SignAndEncrypt, "Basic256Sha256"};
    std::string keys;
    SECTION("none") {}
    SECTION("damaged ones")
    {
        keys = secured.keys.text.substr(0, secured.keys.text.size() / 3);
    }
    SECTION("those of another channel")
    {
        keys = Secured{MessageSecurityMode::SignAndEncrypt, "Basic256Sha256"}.keys.text;
        std::replace(keys.begin(), keys.end(), 'A', 'B');
    }
    SECTION("anything")
    {
        keys = "client_key_1_1: 00\nclient_iv_1_1 zz\n::\n_\nclient_key_x_y: 1";
    }
    CHECK(decrypted(secured.recording, keys) == secured.recording);
}
#endif

TEST_CASE("a capture of pcapng has the keys before its packets", "[harness]")
{
    Recording recording;
    recording.entries = {
        {Recording::Kind::Opened, 1ms, 1, Side::Client, {}},
        {Recording::Kind::Bytes, 2ms, 1, Side::Client, {std::byte{0x48}, std::byte{0xEF}}}};
    const std::string keys = "client_key_1_1: 00\n";
    const auto bytes = to_pcapng(recording, keys);
    // Blocks have their type and size in front, and their size again at the end.
    std::vector<std::uint32_t> types;
    for (std::size_t at = 0; at < bytes.size();) {
        const std::uint32_t size = word_at(bytes, at + 4);
        REQUIRE(size >= 12);
        REQUIRE(size % 4 == 0);
        REQUIRE(at + size <= bytes.size());
        CHECK(word_at(bytes, at + size - 4) == size);
        types.push_back(word_at(bytes, at));
        if (types.back() == 0xA) {
            CHECK(word_at(bytes, at + 8) == 0x5541'4B4C);
            CHECK(word_at(bytes, at + 12) == keys.size());
        }
        at += size;
    }
    CHECK(types == std::vector<std::uint32_t>{0x0A0D'0D0A, 1, 0xA, 6, 6, 6, 6});
    CHECK(to_pcapng(recording, {}).size() < bytes.size());
}

} // namespace decrypted_recording_test
