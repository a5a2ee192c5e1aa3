#include <map>

#include <busbar/backend/modbus_client.hpp>
#include <busbar/harness/modbus_responder.hpp>

#include "fuzz_script.hpp"
#include "require.hpp"

namespace modbus_fuzz {

using namespace busbar;
using namespace busbar::backend;
using busbar::fuzz::require;
using Bytes = std::vector<std::byte>;

namespace {

/// What is read from bytes is written as bytes that are read as the same.
void check_codec(std::span<const std::byte> pdu)
{
    if (pdu.empty()) {
        return;
    }
    const auto request = parse_modbus_request(pdu);
    if (!request) {
        return;
    }
    Bytes written;
    // A device is asked for items that do not exist; nobody sends such a request.
    if (encode_modbus(*request, written)) {
        // Bits after the last coil do not count.
        require(written.size() == pdu.size() && parse_modbus_request(written) == request);
    }
    const auto response = parse_modbus_response(*request, pdu);
    if (response) {
        written.clear();
        require(encode_modbus(*request, *response, written).has_value());
        require(parse_modbus_response(*request, written) == response);
    }
}

/// A small memory is made for each input in no time.
harness::ModbusDeviceOptions small_device()
{
    constexpr std::size_t items = 300;
    harness::ModbusDeviceOptions options;
    options.sizes = {items, items, items, items};
    options.objects = {{0, "Busbar"}};
    return options;
}

ModbusRequest request_of(fuzz::Script& script)
{
    constexpr std::size_t max_items = 130;
    ModbusRequest request;
    request.function = static_cast<ModbusFunction>(script.byte());
    request.address = static_cast<std::uint16_t>(script.byte() * 257U);
    request.quantity = script.byte();
    request.write_address = script.byte();
    request.values.assign(script.byte() % max_items, script.byte() % 2U);
    request.read_code = script.byte();
    request.object = script.byte();
    return request;
}

/// A client whose peer is a device and, in between, the input.
class Connection {
public:
    explicit Connection(fuzz::Script& script) : script_{script}
    {
        options_.max_under_way = 1 + script_.byte() % 4U;
        options_.is_gateway = script_.byte() % 4U == 0;
        options_.max_requests = max_requests;
        client_ = ModbusClient{options_};
    }

    void run()
    {
        while (!script_.is_over()) {
            step();
            check();
        }
        client_.close(status::Bad_ConnectionClosed, "the end");
        check();
        require(pending_.empty() && is_closed_ && !client_.next_event());
    }

private:
    static constexpr std::size_t max_requests = 8;
    enum Step : std::uint8_t { Send, Raw, Answer, Spoil, Wait, Steps };

    void step()
    {
        switch (script_.byte() % Steps) {
        case Send:
            send();
            break;
        case Raw:
            feed(script_.bytes(script_.byte()));
            break;
        case Answer:
        case Spoil:
            answer();
            break;
        default:
            now_ += std::chrono::milliseconds{50 * script_.byte()};
            client_.handle_deadline(now_);
            break;
        }
    }

    void send()
    {
        const auto id = client_.send(request_of(script_), script_.byte(), now_);
        if (id) {
            require(pending_.emplace(*id, true).second);
        }
    }

    /// The device answers all that was sent; a byte of it may be another one.
    void answer()
    {
        static_cast<void>(responder_.feed(client_.output(), now_));
        client_.consume(client_.output().size());
        Bytes bytes{responder_.output().begin(), responder_.output().end()};
        responder_.consume(bytes.size());
        const std::size_t at = script_.byte();
        if (at < bytes.size()) {
            bytes[at] ^= static_cast<std::byte>(script_.byte());
        }
        feed(bytes);
    }

    void feed(std::span<const std::byte> bytes)
    {
        require(client_.feed(bytes, now_).has_value() != client_.is_closed());
    }

    /// Each request has one answer, nothing comes after the end, and nothing grows.
    void check()
    {
        while (const auto event = client_.next_event()) {
            require(!is_closed_);
            if (event->kind == ModbusEvent::Kind::Closed) {
                is_closed_ = true;
                require(event->status.is_bad() && !event->reason.empty());
            } else {
                require(pending_.erase(event->id) == 1);
                require(!event->answer.exception || !(event->status == status::Good));
            }
        }
        require(pending_.size() <= max_requests);
        require(client_.under_way() <= options_.max_under_way);
        require(is_closed_ == client_.is_closed());
        require((client_.next_deadline() == no_deadline) == (client_.under_way() == 0));
        const std::size_t max_frame = modbus_header_size + max_modbus_pdu_size;
        require(responder_.output().size() <= (max_requests + 1) * max_frame);
    }

    fuzz::Script& script_;
    ModbusClientOptions options_{};
    ModbusClient client_{ModbusClientOptions{}};
    harness::ModbusDevice device_{small_device()};
    harness::ModbusResponder responder_{device_};
    std::map<std::uint64_t, bool> pending_;
    TimePoint now_{};
    bool is_closed_{false};
};

} // namespace

/// Bytes as requests and responses, for a device, and for a client with requests under way.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::span<const std::byte> bytes = std::as_bytes(std::span{data, size});
    check_codec(bytes);
    harness::ModbusDevice device{small_device()};
    harness::ModbusResponder responder{device};
    static_cast<void>(responder.feed(bytes, {}));
    fuzz::Script script{{data, size}};
    Connection{script}.run();
    return 0;
}

} // namespace modbus_fuzz
