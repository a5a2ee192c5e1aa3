#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <busbar/channel/client_channel.hpp>
#include <busbar/channel/server_channel.hpp>

#include "channel/buffer_bounds.hpp"
#include "channel/frame.hpp"
#include "fuzz_script.hpp"
#include "require.hpp"
#include "support/byte_pipe.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"

namespace reverse_hello_fuzz {

using namespace busbar;
using namespace busbar::channel::detail;
using fuzz::require;
using Bytes = std::vector<std::byte>;

namespace {

constexpr channel::TransportLimits limits{.receive_buffer_size = channel::min_buffer_size,
                                          .send_buffer_size = channel::min_buffer_size,
                                          .max_message_size = 10'000,
                                          .max_chunk_count = 4};
constexpr std::string_view expected_uri = "urn:plc";

/// What the first message of whoever connected to a client is, as Part 6, 7.1.2.6 has it.
struct Greeting {
    enum class Kind : std::uint8_t { Unfinished, Right, Wrong };
    Kind kind{Kind::Wrong};
    std::string url{};
};

Greeting greeting_in(std::span<const std::byte> heard, std::string_view wanted_uri)
{
    if (heard.size() < header_size) {
        return {Greeting::Kind::Unfinished};
    }
    const auto header = parse_frame_header(heard, max_early_size);
    if (!header) {
        return {};
    }
    if (heard.size() < header->size) {
        return {Greeting::Kind::Unfinished};
    }
    const auto hello = parse_reverse_hello(heard.subspan(header_size, header->size - header_size));
    if (header->type != MessageType::RHE || !hello) {
        return {};
    }
    OutputBuffer again;
    write_reverse_hello(again, hello->server_uri.view(), hello->endpoint_url.view());
    const auto reread = parse_reverse_hello(again.output().subspan(header_size));
    require(reread && reread->server_uri.view() == hello->server_uri.view() &&
            reread->endpoint_url.view() == hello->endpoint_url.view());
    const bool is_wanted = wanted_uri.empty() || hello->server_uri.view() == wanted_uri;
    return {is_wanted ? Greeting::Kind::Right : Greeting::Kind::Wrong, hello->endpoint_url.str()};
}

/// A client that waits for its server's connection and a server that made one, and between them
/// somebody who changes what they say, or says it himself.
class Fixture {
public:
    explicit Fixture(fuzz::Script& script)
        : script_{&script}, wanted_uri_{script.byte() % 2 == 0 ? expected_uri : ""},
          uri_{text(expected_uri)}, url_{text("opc.tcp://plc:4840")},
          server_{{.limits = limits, .allowed = {{}}, .channel_id = 77}, environment(), now_},
          client_{client_config(wanted_uri_), environment(), now_}
    {
        const bool is_said = server_.reverse_hello(uri_, url_).has_value();
        require(is_said == (uri_.size() <= max_url_size && url_.size() <= max_url_size));
        require(!is_said || server_.next_deadline() == no_deadline);
        is_honest_ = is_said && (wanted_uri_.empty() || uri_ == wanted_uri_);
        require(client_.output().empty());
    }

    void step()
    {
        const std::uint8_t what = script_->byte();
        switch (what % 8) {
        case 0:
        case 1:
            give_client(changed(test::take_output(server_)));
            break;
        case 2:
        case 3:
            give_server(changed(test::take_output(client_)));
            break;
        case 4:
            give_client(raw());
            break;
        case 5:
            give_server(raw());
            break;
        default:
            wait(std::chrono::milliseconds{script_->byte() * 50});
        }
    }
    /// Whom nobody has disturbed are connected in the end.
    void finish()
    {
        if (!is_honest_) {
            return;
        }
        for (int turn = 0; turn < 8; ++turn) {
            give_client(test::take_output(server_));
            give_server(test::take_output(client_));
        }
        require(client_.is_open() && server_.is_open());
        require(client_.endpoint_url() == url_ && server_.endpoint_url() == url_);
    }

private:
    [[nodiscard]] channel::ChannelEnvironment environment()
    {
        return {.random = &random_, .wall_clock = &wall_clock_, .log = &log_};
    }
    [[nodiscard]] static channel::ClientChannelConfig client_config(std::string_view wanted_uri)
    {
        channel::ClientChannelConfig config;
        config.limits = limits;
        config.endpoint_url = "opc.tcp://configured";
        config.is_reverse = true;
        config.expected_server_uri = wanted_uri;
        return config;
    }
    /// The usual text, one at or past the limit, or anything.
    [[nodiscard]] std::string text(std::string_view usual)
    {
        const std::size_t choice = script_->byte();
        if (choice < 0xe0) {
            return std::string{usual};
        }
        if (choice < 0xf0) {
            return std::string(max_url_size + choice - 0xe8, 'x');
        }
        const auto bytes = script_->bytes(choice - 0xf0);
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    [[nodiscard]] Bytes raw()
    {
        const auto bytes = script_->bytes(script_->byte());
        is_honest_ = is_honest_ && bytes.empty();
        return {bytes.begin(), bytes.end()};
    }
    [[nodiscard]] Bytes changed(Bytes bytes)
    {
        const std::uint8_t how = script_->byte();
        if (how < 0x80 || bytes.empty()) {
            return bytes;
        }
        is_honest_ = false;
        if (how < 0xa0) {
            bytes.resize(bytes.size() - 1 - how % 32 % bytes.size());
        } else if (how < 0xb0) {
            bytes.insert(bytes.end(), bytes.begin(), bytes.end());
        } else {
            bytes[script_->byte() % bytes.size()] ^= static_cast<std::byte>(how);
        }
        return bytes;
    }

    void give_client(const Bytes& bytes)
    {
        const bool is_awaited = !is_greeted_ && !client_.is_closed();
        static_cast<void>(client_.feed(bytes, now_));
        heard_.insert(heard_.end(), bytes.begin(), bytes.end());
        while (client_.next_event()) {
        }
        if (is_awaited) {
            check_greeting();
        }
        check_memory(client_.memory_in_use());
    }
    /// That the client says its Hello, to the URL that the server named, when it has heard a
    /// ReverseHello of the server that it waits for; and before that nothing but an Error.
    void check_greeting()
    {
        const auto greeting = greeting_in(heard_, wanted_uri_);
        const auto said = client_.output();
        switch (greeting.kind) {
        case Greeting::Kind::Unfinished:
            require(said.empty() || client_.is_closed());
            break;
        case Greeting::Kind::Wrong:
            require(client_.is_closed());
            break;
        case Greeting::Kind::Right: {
            const auto header = parse_frame_header(said, max_early_size);
            require(header && header->type == MessageType::HEL);
            const auto hello = parse_hello(said.subspan(header_size, header->size - header_size));
            require(hello && hello->endpoint_url.view() == greeting.url);
            require(client_.endpoint_url() == greeting.url);
            is_greeted_ = true;
            return;
        }
        }
        require(!client_.is_open());
    }

    void give_server(const Bytes& bytes)
    {
        const bool is_first = server_.next_deadline() == no_deadline && !server_.is_closed();
        static_cast<void>(server_.feed(bytes, now_));
        if (is_first && !bytes.empty()) {
            // Part 6, 7.1.2.6: now the client has use for it, and as long as any other.
            require(server_.next_deadline() == now_ + limits.handshake_timeout);
        }
        while (server_.next_event()) {
        }
        check_memory(server_.memory_in_use());
    }

    void wait(Duration time)
    {
        now_ += time;
        const bool is_client_late = !client_.is_open() && now_ >= client_.next_deadline();
        const bool is_server_late = !server_.is_open() && now_ >= server_.next_deadline();
        client_.handle_deadline(now_);
        server_.handle_deadline(now_);
        require(!is_client_late || client_.is_closed());
        require(!is_server_late || server_.is_closed());
        is_honest_ = is_honest_ && !client_.is_closed() && !server_.is_closed();
        while (client_.next_event()) {
        }
        while (server_.next_event()) {
        }
    }
    static void check_memory(std::size_t size)
    {
        const auto bounds = bounds_of(limits, max_early_size);
        const std::size_t message = std::max<std::size_t>(bounds.kept, 2 * limits.max_message_size);
        require(size <= bounds.input + bounds.output + message);
    }

    fuzz::Script* script_;
    test::SeededRandom random_;
    test::FixedWallClock wall_clock_;
    NullLog log_;
    TimePoint now_{};
    std::string_view wanted_uri_;
    std::string uri_;
    std::string url_;
    channel::ServerChannel server_;
    channel::ClientChannel client_;
    Bytes heard_;
    bool is_greeted_{false};
    bool is_honest_{false};
};

} // namespace

/// A reverse connection (Part 6, 7.1.2.6) on both of its ends, in virtual time: a listening client
/// that anybody can call, and a server that calls and finds anybody there.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    Fixture fixture{script};
    for (int step = 0; step < 32 && !script.is_over(); ++step) {
        fixture.step();
    }
    fixture.finish();
    return 0;
}

} // namespace reverse_hello_fuzz
