#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

#include "channel/buffer_bounds.hpp"
#include "chunk_ends.hpp"
#include "fuzz_script.hpp"

namespace chunk_assembly_fuzz {

using namespace busbar;
using namespace busbar::fuzz;

namespace {

/// What Part 6, 6.7.2 and 6.7.3, and the limits say of each chunk.
class Model {
public:
    Model(bool is_server, std::uint32_t token, std::uint32_t first)
        : is_server_{is_server}, token_{token}, last_{first}
    {
    }

    struct Expected {
        std::optional<Kind> event;
        Bytes body;
    };
    [[nodiscard]] Expected add(const Chunk& chunk)
    {
        const bool follows = chunk.sequence == last_ + 1 && chunk.sequence != 0;
        const bool wraps = last_ >= UINT32_MAX - 1'024 && chunk.sequence < 1'024;
        const bool is_of_channel = chunk.channel == channel_id && chunk.token == token_;
        if (!is_of_channel || (!follows && !wraps) || chunk.type != MessageType::MSG) {
            return {Kind::Closed, {}};
        }
        last_ = chunk.sequence;
        if (has_begun() && chunk.request != request_) {
            return {Kind::Closed, {}};
        }
        if (chunk.flag == 'A') {
            const bool had_begun = has_begun();
            drop();
            return {is_server_ ? (had_begun ? std::optional<Kind>{} : Kind::Closed) : Kind::Aborted,
                    {}};
        }
        return take(chunk);
    }
    void limit(std::size_t size) { limit_ = std::min(size, max_message_size); }
    [[nodiscard]] bool has_begun() const { return chunks_ != 0; }
    [[nodiscard]] std::size_t size() const { return message_.size(); }
    [[nodiscard]] std::uint32_t last() const { return last_; }
    [[nodiscard]] std::uint32_t request() const { return request_; }

private:
    [[nodiscard]] Expected take(const Chunk& chunk)
    {
        const std::size_t size = message_.size() + chunk.body.size();
        const bool is_final = chunk.flag == 'F';
        if (chunks_ == limits.max_chunk_count || size > limit_ ||
            (!is_final && size > budget_size)) {
            return {Kind::Closed, {}};
        }
        message_.insert(message_.end(), chunk.body.begin(), chunk.body.end());
        if (is_final) {
            chunks_ = 0;
            return {Kind::Message, std::exchange(message_, {})};
        }
        ++chunks_;
        request_ = chunk.request;
        return {};
    }
    void drop()
    {
        message_.clear();
        chunks_ = 0;
    }

    bool is_server_;
    std::uint32_t token_;
    std::uint32_t last_;
    std::size_t limit_{max_message_size};
    std::uint32_t chunks_{0};
    std::uint32_t request_{0};
    Bytes message_;
};

/// Mostly a chunk that may come next; a high byte of the script makes a field another one.
Chunk next_chunk(fuzz::Script& script, const Model& model, std::uint32_t token)
{
    static constexpr std::array flags{'F', 'C', 'C', 'A'};
    Chunk chunk;
    const std::uint8_t shape = script.byte();
    chunk.flag = flags[shape % 4];
    chunk.request = model.has_begun() && (shape & 0x40U) == 0 ? model.request() : shape;
    chunk.sequence = model.last() + 1;
    chunk.token = token;
    if (shape >= 0xc0) {
        const std::uint8_t wrong = script.byte();
        chunk.sequence = wrong % 8 == 0 ? script.byte() * 8U : chunk.sequence;
        chunk.sequence += wrong % 8 == 1 ? script.byte() - 128U : 0U;
        chunk.token += wrong % 8 == 2 ? script.byte() : 0U;
        chunk.channel += wrong % 8 == 3 ? script.byte() : 0U;
        chunk.type = wrong % 8 == 4 ? MessageType::CLO : MessageType::MSG;
        chunk.flag = wrong % 8 == 4 ? 'F' : chunk.flag;
    }
    const std::size_t size = script.byte();
    chunk.body.resize(size < 0x10 ? size : (size - 0xf) * 17);
    for (std::size_t i = 0; i < chunk.body.size(); ++i) {
        chunk.body[i] = static_cast<std::byte>(i + chunk.sequence);
    }
    return chunk;
}

template <typename End>
class Play {
public:
    Play(fuzz::Script& script, World& world, End& end, std::uint32_t first)
        : script_{&script}, world_{&world}, end_{&end}, model_{End::is_server, End::token, first}
    {
    }
    /// False when nothing can follow.
    [[nodiscard]] bool step()
    {
        const std::uint8_t what = script_->byte();
        if (what >= 0xf8) {
            return spoil(what);
        }
        if constexpr (End::is_server) {
            if (what >= 0xf0) {
                const std::uint32_t size = script_->byte() * 32U;
                end_->engine.limit_messages(size);
                model_.limit(size);
            }
        }
        const Chunk chunk = next_chunk(*script_, model_, End::token);
        const auto expected = model_.add(chunk);
        auto event = heard(sealed(*end_, chunk), what % 2 == 0 ? SIZE_MAX : 1 + what % 16);
        require(event.has_value() == expected.event.has_value());
        if (event) {
            compare(*event, expected, chunk);
        }
        check_memory();
        if (expected.event == Kind::Closed) {
            return false;
        }
        require(world_->budget.left() == budget_size - model_.size());
        if constexpr (End::is_server) {
            require(end_->engine.unfinished_size() == model_.size());
        }
        return true;
    }

private:
    /// The event of these bytes, which come in pieces and make one at most.
    std::optional<ChannelEvent> heard(std::span<const std::byte> bytes, std::size_t piece)
    {
        std::optional<ChannelEvent> heard;
        while (!bytes.empty()) {
            const auto part = bytes.first(std::min(piece, bytes.size()));
            static_cast<void>(end_->engine.feed(part, {}));
            while (auto event = end_->engine.next_event()) {
                require(!heard);
                heard = std::move(event);
            }
            bytes = bytes.subspan(part.size());
        }
        end_->engine.consume(end_->engine.output().size());
        return heard;
    }
    void compare(ChannelEvent& event, const Model::Expected& expected, const Chunk& chunk)
    {
        const bool is_good_close = End::is_server && chunk.type == MessageType::CLO;
        require(event.kind == *expected.event);
        if (event.kind == Kind::Closed) {
            require(event.status.is_bad() || is_good_close);
            return;
        }
        require(event.request_id == chunk.request && event.body == expected.body);
        if (event.kind == Kind::Message && script_->byte() % 2 != 0) {
            end_->engine.recycle(std::move(event.body));
        }
    }
    /// A chunk whose bytes are changed, or anything: only the limits are sure then, and that a
    /// signature shows what is not its sender's.
    [[nodiscard]] bool spoil(std::uint8_t what)
    {
        Bytes bytes = sealed(*end_, next_chunk(*script_, model_, End::token));
        const bool is_raw = what % 2 != 0;
        if (is_raw) {
            const auto raw = script_->bytes(script_->byte());
            bytes.assign(raw.begin(), raw.end());
        } else {
            const std::size_t at = header_size + script_->byte() % (bytes.size() - header_size);
            bytes[at] ^= static_cast<std::byte>(1U << script_->byte() % 8U);
        }
        for (int again = 0; again < 3; ++again) {
            const auto event = first_of(bytes);
            require(std::is_same_v<End, SecuredEnd> == false || is_raw ||
                    (event && event->kind == Kind::Closed) || again > 0);
        }
        check_memory();
        return false;
    }
    std::optional<ChannelEvent> first_of(const Bytes& bytes)
    {
        static_cast<void>(end_->engine.feed(bytes, {}));
        auto first = end_->engine.next_event();
        while (end_->engine.next_event()) {
        }
        end_->engine.consume(end_->engine.output().size());
        return first;
    }
    /// No more than the owner was told, whatever came.
    void check_memory()
    {
        const auto bounds = bounds_of(limits, 0);
        const std::size_t message = std::max(bounds.kept, 2 * max_message_size);
        require(end_->engine.memory_in_use() <= bounds.input + bounds.output + message);
        require(world_->budget.left() <= budget_size);
    }

    fuzz::Script* script_;
    World* world_;
    End* end_;
    Model model_;
};

template <typename End>
void play(fuzz::Script& script, World& world, End&& end, std::uint32_t first)
{
    Play<std::remove_reference_t<End>> play{script, world, end, first};
    for (int step = 0; step < 64 && !script.is_over() && play.step(); ++step) {
    }
}

} // namespace

/// Chunks that a peer makes as it likes once a channel is open: their sizes, flags, ids and
/// sequence numbers, and with keys that both have also what is signed and encrypted. The first byte
/// chooses the end and its security, the second the first sequence number.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    World world;
    const std::uint8_t end = script.byte() % 4;
    const std::uint32_t choice = script.byte();
    const std::uint32_t first = choice < 0x80 ? choice : UINT32_MAX - 8 * (0xff - choice);
    if (end == 0) {
        play(script, world, ServerEnd{world, first}, first);
    } else if (end == 1) {
        play(script, world, ClientEnd{world, first}, first);
    } else {
        play(script, world, SecuredEnd{world, end == 3, first}, first);
    }
    require(world.budget.left() == budget_size);
    return 0;
}

} // namespace chunk_assembly_fuzz
