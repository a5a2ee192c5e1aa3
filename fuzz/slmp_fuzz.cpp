#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <busbar/backend/slmp_client.hpp>
#include <busbar/backend/slmp_end_code.hpp>
#include <busbar/harness/slmp_responder.hpp>

#include "fuzz_script.hpp"
#include "require.hpp"

namespace slmp_fuzz {

using namespace busbar;
using namespace busbar::backend;
using fuzz::require;
using Bytes = std::vector<std::byte>;

namespace {

constexpr std::size_t max_operations = 64;

/// Whatever reads as a message is written as the same bytes, or one that reads the same.
void check_messages(std::span<const std::byte> input)
{
    const auto head = read_slmp_head(input);
    if (!head || !*head || (*head)->size > input.size()) {
        return;
    }
    const auto frame = input.first((*head)->size);
    const auto body = read_slmp_request(**head, frame);
    if (!body) {
        static_cast<void>(decode_slmp_answer({}, **head, frame));
        return;
    }
    const auto operation = decode_slmp_request(*body);
    if (!operation) {
        require(slmp_end_code(operation.error()).status.is_bad());
        return;
    }
    const auto again = encode_slmp_request(**head, body->timer, *operation);
    require(again.has_value());
    const auto second = read_slmp_head(*again);
    require(second && *second && (*second)->size == again->size());
    const auto reread = decode_slmp_request(*read_slmp_request(**second, *again));
    require(reread && *reread == *operation);
}

/// A client and a PLC, and between them one who changes what they say, or says it himself.
class Fixture {
public:
    explicit Fixture(fuzz::Script& script)
        : script_{&script}, client_{client_options(script.byte())}, plc_{plc_options()}
    {
        for (const char* const kind : {"D", "M", "X", "LTN", "U1\\G"}) {
            require(plc_.add_devices(kind, 64));
        }
        constexpr std::array value{std::byte{1}, std::byte{0}, std::byte{1}, std::byte{0}};
        plc_.add_label("A", 1, value, 1);
        plc_.add_label("W", 2, value, 2);
    }

    void step()
    {
        switch (script_->byte() % 8) {
        case 0:
        case 1:
            send();
            break;
        case 2:
        case 3:
            give_plc(changed(take(client_)));
            break;
        case 4:
        case 5:
            give_client(changed(take(plc_)));
            break;
        case 6: {
            const std::uint8_t what = script_->byte();
            plc_.happen(static_cast<harness::SlmpMishap>(what % 8), what / 64U,
                        static_cast<std::uint16_t>(0xC000U + what));
            break;
        }
        default:
            wait(std::chrono::milliseconds{script_->byte() * 50});
        }
        poll();
    }
    /// Every request has one answer in the end.
    void finish()
    {
        client_.close(status::Bad_ConnectionClosed, "the test ends it");
        poll();
        require(open_.empty() && client_.is_closed() && client_.output().empty());
        require(client_.next_deadline() == no_deadline);
    }

private:
    [[nodiscard]] SlmpClientOptions client_options(std::uint8_t choice)
    {
        is_datagram_ = (choice & 1U) != 0;
        return {.frame = (choice & 2U) != 0 ? SlmpFrame::Frame3E : SlmpFrame::Frame4E,
                .is_datagram = is_datagram_,
                .max_under_way = 1U + choice / 4U % 4U,
                .max_requests = 8,
                .max_response = 1000};
    }
    [[nodiscard]] harness::SlmpPlcOptions plc_options()
    {
        harness::SlmpPlcOptions options;
        options.is_datagram = is_datagram_;
        options.is_fx5 = script_->byte() % 2 != 0;
        options.latency = std::chrono::milliseconds{script_->byte()};
        options.max_waiting = 4;
        return options;
    }

    [[nodiscard]] SlmpDevice device()
    {
        constexpr std::array<std::uint16_t, 4> codes{0xA8, 0x90, 0x9C, 0x52};
        const std::uint8_t choice = script_->byte();
        return {codes[choice % codes.size()], choice / 3U};
    }
    [[nodiscard]] SlmpOperation operation()
    {
        constexpr std::array commands{
            SlmpCommand::BatchRead,        SlmpCommand::BatchWrite, SlmpCommand::RandomRead,
            SlmpCommand::BlockRead,        SlmpCommand::TypeName,   SlmpCommand::LabelRandomRead,
            SlmpCommand::LabelArrayRead,   SlmpCommand::SelfTest,   SlmpCommand::RegisterMonitor,
            SlmpCommand::LabelRandomWrite, SlmpCommand::RemoteReset};
        SlmpOperation operation;
        operation.command = commands[script_->byte() % commands.size()];
        const std::uint8_t form = script_->byte();
        operation.has_long_form = (form & 1U) != 0;
        operation.is_bits = operation.command == SlmpCommand::BatchRead && (form & 2U) != 0;
        operation.blocks = {{device(), 1}};
        operation.text = "ABC";
        if (operation.command == SlmpCommand::BatchRead) {
            operation.blocks[0].points = form;
        } else if (operation.command == SlmpCommand::RandomRead) {
            operation.more_blocks = {{device()}};
        } else if (operation.command == SlmpCommand::BatchWrite) {
            operation.words = {form};
        }
        operation.labels = {{.name = (form & 4U) != 0 ? "A[1]" : "W[0]"}};
        if (operation.command == SlmpCommand::LabelArrayRead) {
            operation.labels[0].is_in_bits = (form & 8U) != 0;
            operation.labels[0].length = 2;
        } else if (operation.command == SlmpCommand::LabelRandomWrite) {
            operation.labels[0].data = {std::byte{form}, std::byte{0}};
        }
        return operation;
    }
    void send()
    {
        if (open_.size() >= max_operations) {
            return;
        }
        const SlmpOperation next = operation();
        if (const auto id = client_.send(next, now_)) {
            require(open_.emplace(*id, next).second);
        }
    }
    void poll()
    {
        while (const auto event = client_.next_event()) {
            if (event->kind == SlmpEvent::Kind::Closed) {
                require(event->status.is_bad() && !event->reason.empty() && client_.is_closed());
                continue;
            }
            const auto request = open_.find(event->id);
            require(request != open_.end());
            if (event->status.is_good() && event->answer.end_code == 0) {
                check_size(request->second, event->answer);
            }
            open_.erase(request);
        }
    }
    /// An answer has what was requested, whoever has given it.
    static void check_size(const SlmpOperation& operation, const SlmpAnswer& answer)
    {
        if (operation.command == SlmpCommand::BatchRead) {
            require(answer.words.size() == operation.blocks[0].points);
        } else if (operation.command == SlmpCommand::RandomRead) {
            require(answer.words.size() == 3);
        } else if (operation.command == SlmpCommand::LabelRandomRead) {
            require(answer.labels.size() == 1);
        }
    }

    template <typename Engine>
    static Bytes take(Engine& engine)
    {
        const auto output = engine.output();
        Bytes bytes{output.begin(), output.end()};
        engine.consume(bytes.size());
        return bytes;
    }
    [[nodiscard]] Bytes changed(Bytes bytes)
    {
        const std::uint8_t how = script_->byte();
        if (how < 0x80) {
            return bytes;
        }
        if (how < 0x90) {
            const auto raw = script_->bytes(script_->byte());
            return {raw.begin(), raw.end()};
        }
        if (bytes.empty()) {
            return bytes;
        }
        if (how < 0xA8) {
            bytes.resize(bytes.size() - 1 - how % bytes.size());
        } else if (how < 0xB8) {
            bytes.insert(bytes.end(), bytes.begin(), bytes.end());
        } else {
            bytes[script_->byte() % bytes.size()] ^= static_cast<std::byte>(how);
        }
        return bytes;
    }
    void give_client(const Bytes& bytes)
    {
        const bool is_open = client_.feed(bytes, now_).has_value();
        require(is_open != client_.is_closed());
    }
    void give_plc(const Bytes& bytes)
    {
        plc_.feed(bytes, now_);
        if (plc_.is_closed() && plc_.output().empty()) {
            plc_.reconnect();
        }
    }
    void wait(Duration time)
    {
        now_ += time;
        plc_.handle_deadline(now_);
        client_.handle_deadline(now_);
        require(client_.next_deadline() > now_);
    }

    fuzz::Script* script_;
    bool is_datagram_{false};
    TimePoint now_{};
    SlmpClient client_;
    harness::SlmpResponder plc_;
    /// By id.
    std::map<std::uint64_t, SlmpOperation> open_{};
};

} // namespace

/// The input as a message, and as a script of what happens between a client and a PLC.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    check_messages(std::as_bytes(std::span{data, size}));
    fuzz::Script script{{data, size}};
    Fixture fixture{script};
    for (int step = 0; step < 64 && !script.is_over(); ++step) {
        fixture.step();
    }
    fixture.finish();
    return 0;
}

} // namespace slmp_fuzz
