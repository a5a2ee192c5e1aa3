#include <busbar/harness/modbus_responder.hpp>

#include <map>

#include <catch2/catch.hpp>

#include <busbar/backend/modbus_client.hpp>
#include <busbar/harness/link.hpp>

namespace modbus_responder_test {

using namespace busbar;
using namespace busbar::backend;
using namespace busbar::harness;
using namespace std::chrono_literals;
using Fault = ModbusFault;

namespace {

/// An engine at the end of a link, whose deadlines are kept.
template <typename Engine>
class Host final : public LinkEnd {
public:
    Host(Scheduler& scheduler, Engine& engine)
        : scheduler_{scheduler}, engine_{engine}, alarm_{scheduler, [this] { on_time(); }}
    {
    }

    void attach(const std::shared_ptr<Link>& link, Side side)
    {
        link_ = link;
        side_ = side;
        link->attach(side, *this);
        update();
    }
    void update()
    {
        alarm_.set(engine_.next_deadline());
        if (link_ != nullptr) {
            link_->flush(side_);
            if (engine_.is_closed() && engine_.output().empty()) {
                std::exchange(link_, nullptr)->close(side_);
            }
        }
    }

    [[nodiscard]] std::span<const std::byte> output() const override { return engine_.output(); }
    void consume(std::size_t size) override { engine_.consume(size); }
    void feed(std::span<const std::byte> in) override
    {
        static_cast<void>(engine_.feed(in, scheduler_.now()));
        update();
    }
    void link_lost() override
    {
        link_ = nullptr;
        if constexpr (std::is_same_v<Engine, ModbusClient>) {
            engine_.close(status::Bad_ConnectionClosed, "the peer has closed the connection");
        }
        alarm_.set(engine_.next_deadline());
    }

private:
    void on_time()
    {
        engine_.handle_deadline(scheduler_.now());
        update();
    }

    Scheduler& scheduler_;
    Engine& engine_;
    Alarm alarm_;
    std::shared_ptr<Link> link_;
    Side side_{Side::Client};
};

/// A client and a device at the ends of a link, in virtual time.
struct Plant {
    explicit Plant(ModbusClientOptions client_options = {},
                   ModbusResponderOptions responder_options = {},
                   ModbusDeviceOptions device_options = {})
        : device{std::move(device_options)}, client{client_options}, responder{device,
                                                                               responder_options}
    {
        const auto registers = device.table(ModbusTable::HoldingRegister);
        for (std::size_t i = 0; i < registers.size(); ++i) {
            registers[i] = static_cast<std::uint16_t>(i);
        }
        responder_host.attach(link, Side::Server);
        client_host.attach(link, Side::Client);
    }

    std::uint64_t send(ModbusRequest request, std::uint8_t unit = 1)
    {
        const auto id = client.send(std::move(request), unit, scheduler.now());
        REQUIRE(id);
        client_host.update();
        return *id;
    }
    std::uint64_t read(std::uint16_t address, std::uint16_t quantity = 1)
    {
        ModbusRequest request;
        request.address = address;
        request.quantity = quantity;
        return send(request);
    }
    std::uint64_t write(std::uint16_t address, std::uint16_t value)
    {
        ModbusRequest request;
        request.function = ModbusFunction::WriteRegister;
        request.address = address;
        request.values = {value};
        return send(request);
    }

    /// Runs until this request is finished.
    ModbusEvent wait(std::uint64_t id)
    {
        const auto is_there = [&] {
            while (auto event = client.next_event()) {
                if (event->kind == ModbusEvent::Kind::Closed) {
                    closed = event;
                } else {
                    answers.emplace(event->id, std::move(*event));
                }
            }
            return answers.count(id) != 0;
        };
        REQUIRE(scheduler.run_until(is_there, scheduler.now() + 1min));
        return answers.at(id);
    }
    StatusCode status_of_read(std::uint16_t address) { return wait(read(address)).status; }

    Scheduler scheduler;
    Weather weather;
    std::shared_ptr<Link> link{std::make_shared<Link>(scheduler, weather, Chance{7, 1})};
    ModbusDevice device;
    ModbusClient client;
    ModbusResponder responder;
    Host<ModbusResponder> responder_host{scheduler, responder};
    Host<ModbusClient> client_host{scheduler, client};
    std::map<std::uint64_t, ModbusEvent> answers;
    std::optional<ModbusEvent> closed;
};

ModbusClientOptions with_under_way(std::size_t count)
{
    ModbusClientOptions options;
    options.max_under_way = count;
    return options;
}

ModbusResponderOptions slow(Duration latency, Duration scan = {})
{
    ModbusResponderOptions options;
    options.latency = latency;
    options.scan = scan;
    return options;
}

} // namespace

TEST_CASE("A Modbus device keeps what is written and answers what is read")
{
    Plant plant;
    CHECK(plant.wait(plant.read(10, 3)).answer.values == std::vector<std::uint16_t>{10, 11, 12});
    CHECK(plant.wait(plant.write(11, 500)).status == status::Good);
    CHECK(plant.wait(plant.read(11)).answer.values[0] == 500);
    CHECK(plant.device.table(ModbusTable::HoldingRegister)[11] == 500);

    // The example of the specification (6.16).
    plant.device.table(ModbusTable::HoldingRegister)[4] = 0x12;
    ModbusRequest mask;
    mask.function = ModbusFunction::MaskWriteRegister;
    mask.address = 4;
    mask.and_mask = 0xF2;
    mask.or_mask = 0x25;
    CHECK(plant.wait(plant.send(mask)).status == status::Good);
    CHECK(plant.device.table(ModbusTable::HoldingRegister)[4] == 0x17);

    // Function 23 writes first.
    ModbusRequest both;
    both.function = ModbusFunction::ReadWriteRegisters;
    both.address = 20;
    both.quantity = 2;
    both.write_address = 21;
    both.values = {77};
    CHECK(plant.wait(plant.send(both)).answer.values == std::vector<std::uint16_t>{20, 77});

    ModbusRequest coils;
    coils.function = ModbusFunction::WriteCoils;
    coils.address = 3;
    coils.values = {1, 0, 1};
    CHECK(plant.wait(plant.send(coils)).status == status::Good);
    coils.function = ModbusFunction::ReadCoils;
    coils.address = 2;
    coils.quantity = 5;
    CHECK(plant.wait(plant.send(coils)).answer.values == std::vector<std::uint16_t>{0, 1, 0, 1, 0});
}

TEST_CASE("A Modbus device refuses what it does not have")
{
    ModbusDeviceOptions options;
    options.sizes[static_cast<std::size_t>(ModbusTable::HoldingRegister)] = 100;
    options.missing_functions = {ModbusFunction::MaskWriteRegister};
    options.units = {1, 2};
    options.max_registers = 50;
    options.objects = {{0, "Busbar"}, {1, "Responder"}, {0x80, "Own"}};
    Plant plant{{}, {}, options};
    plant.device.refuse(ModbusTable::HoldingRegister, 60, 2);
    CHECK(plant.wait(plant.read(50, 10)).status == status::Good);
    CHECK(plant.wait(plant.read(50, 11)).status == status::Bad_ConfigurationError);
    CHECK(plant.wait(plant.read(61)).status == status::Bad_ConfigurationError);
    CHECK(plant.wait(plant.read(62, 38)).status == status::Good);
    CHECK(plant.wait(plant.read(62, 39)).status == status::Bad_ConfigurationError);
    CHECK(plant.wait(plant.read(0, 51)).status == status::Bad_OutOfRange);
    ModbusRequest request;
    request.function = ModbusFunction::MaskWriteRegister;
    CHECK(plant.wait(plant.send(request)).status == status::Bad_NotSupported);
    request.function = ModbusFunction::ReadCoils;
    CHECK(plant.wait(plant.send(request, 2)).status == status::Good);
    CHECK(plant.wait(plant.send(request, 3)).status == status::Bad_NoCommunication);
    request.function = ModbusFunction::ReadDeviceIdentification;
    CHECK(plant.wait(plant.send(request)).answer.identification.objects.size() == 2);
    request.read_code = 3;
    CHECK(plant.wait(plant.send(request)).answer.identification.objects.size() == 3);
    request.read_code = 4;
    request.object = 7;
    CHECK(plant.wait(plant.send(request)).status == status::Bad_ConfigurationError);
}

TEST_CASE("Requests take their time, one after the other, and are executed between two scans")
{
    Plant plant{with_under_way(4), slow(5ms, 10ms)};
    // With 1 ms each way: the first arrives at 1 ms, and they are ready at 6, 11 and 16 ms.
    const auto first = plant.read(0);
    const auto second = plant.read(1);
    const auto third = plant.read(2);
    CHECK(plant.wait(first).round_trip == 11ms);
    CHECK(plant.wait(second).round_trip == 21ms);
    CHECK(plant.wait(third).round_trip == 21ms);
}

TEST_CASE("A device that takes one request at a time says that it is busy or ignores the next")
{
    ModbusResponderOptions options = slow(50ms);
    options.overlap = ModbusResponderOptions::Overlap::Busy;
    Plant busy{with_under_way(2), options};
    const auto first = busy.read(0);
    CHECK(busy.wait(busy.read(1)).answer.exception == ModbusException::DeviceBusy);
    CHECK(busy.wait(first).status == status::Good);

    options.overlap = ModbusResponderOptions::Overlap::Ignore;
    Plant deaf{with_under_way(2), options};
    const auto answered = deaf.read(0);
    CHECK(deaf.wait(deaf.read(1)).status == status::Bad_Timeout);
    CHECK(deaf.wait(answered).status == status::Good);
}

TEST_CASE("A fault of the device hits one request, and the next ones have their answers")
{
    struct Row {
        Fault fault;
        StatusCode status;
        bool ends_connection;
    };
    const auto row = GENERATE(values<Row>({
        {{Fault::Kind::Silent}, status::Bad_Timeout, false},
        {{Fault::Kind::Exception}, status::Bad_DeviceFailure, false},
        {{Fault::Kind::Exception, 0, ModbusException::DeviceBusy},
         status::Bad_ResourceUnavailable,
         false},
        {{Fault::Kind::Late, 0, {}, 500ms}, status::Good, false},
        {{Fault::Kind::Late, 0, {}, 1500ms}, status::Bad_Timeout, false},
        {{Fault::Kind::Overtaken}, status::Good, false},
        {{Fault::Kind::Twice}, status::Good, false},
        {{Fault::Kind::WrongTransaction}, status::Bad_Timeout, false},
        {{Fault::Kind::WrongUnit}, status::Bad_Timeout, false},
        {{Fault::Kind::WrongFunction}, status::Bad_UnknownResponse, false},
        {{Fault::Kind::Short, 0, {}, {}, 1}, status::Bad_UnknownResponse, false},
        {{Fault::Kind::Short, 0, {}, {}, 3}, status::Bad_UnknownResponse, false},
        {{Fault::Kind::Long, 0, {}, {}, 1}, status::Bad_UnknownResponse, false},
        {{Fault::Kind::Oversize}, status::Bad_DecodingError, true},
        {{Fault::Kind::Undersize}, status::Bad_DecodingError, true},
        {{Fault::Kind::OtherProtocol}, status::Bad_DecodingError, true},
    }));
    INFO(static_cast<int>(row.fault.kind));
    Plant plant{with_under_way(2)};
    Fault fault = row.fault;
    fault.after = 1;
    plant.device.disturb(fault);
    CHECK(plant.status_of_read(0) == status::Good);
    const auto hit = plant.read(1);
    const auto next = plant.read(2);
    const ModbusEvent event = plant.wait(hit);
    CHECK(event.status == row.status);
    CHECK(plant.device.pending_faults() == 0);
    CHECK(plant.wait(next).status == (row.ends_connection ? row.status : status::Good));
    CHECK(plant.client.is_closed() == row.ends_connection);
    if (!row.ends_connection) {
        CHECK(plant.wait(plant.read(3)).answer.values[0] == 3);
        plant.scheduler.run_for(3s);
        CHECK(plant.wait(plant.read(4)).answer.values[0] == 4);
    }
}

TEST_CASE("A connection that ends after any byte of an answer fails its request")
{
    // The answer has 11 bytes.
    for (std::size_t bytes = 0; bytes <= 11; ++bytes) {
        INFO(bytes);
        Plant plant;
        Fault fault{Fault::Kind::Cut};
        fault.bytes = bytes;
        plant.device.disturb(fault);
        const auto hit = plant.read(1);
        const auto next = plant.read(2);
        CHECK(plant.wait(hit).status ==
              (bytes == 11 ? status::Good : status::Bad_ConnectionClosed));
        CHECK(plant.wait(next).status == status::Bad_ConnectionClosed);
        CHECK(plant.client.is_closed());
    }
}

TEST_CASE("Faults of the network cost at most the connection")
{
    Plant cut;
    const auto lost = cut.read(0);
    cut.link->cut();
    CHECK(cut.wait(lost).status == status::Bad_ConnectionClosed);

    // Nobody tells the client that the device is gone.
    Plant silent;
    silent.link->hold(Side::Server);
    for (int i = 0; i < 3; ++i) {
        CHECK(silent.status_of_read(0) == status::Bad_Timeout);
    }
    CHECK(silent.client.is_closed());
    CHECK(silent.closed->status == status::Bad_Timeout);

    Plant pieces{with_under_way(8)};
    pieces.link->split(1);
    pieces.weather.max_latency = 20ms;
    pieces.weather.has_random_cuts = true;
    std::vector<std::uint64_t> ids;
    for (std::uint16_t i = 0; i < 50; ++i) {
        ids.push_back(pieces.read(i, 100));
    }
    for (std::uint16_t i = 0; i < 50; ++i) {
        CHECK(pieces.wait(ids[i]).answer.values.at(0) == i);
    }
}

TEST_CASE("Bytes that are no Modbus end the device's side")
{
    ModbusDevice device;
    ModbusResponder responder{device};
    const std::array<std::byte, 7> bytes{std::byte{'G'}, std::byte{'E'}, std::byte{'T'}};
    CHECK(responder.feed(bytes, {}).error() == status::Bad_DecodingError);
    CHECK(responder.is_closed());
    CHECK(responder.next_deadline() == no_deadline);
}

} // namespace modbus_responder_test
