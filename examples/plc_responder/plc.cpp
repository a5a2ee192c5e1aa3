#include "plc.hpp"

#include <array>
#include <utility>

#include <busbar/harness/modbus_responder.hpp>
#include <busbar/harness/slmp_responder.hpp>

namespace plc_responder {

namespace {

using namespace busbar;

template <typename Responder>
class ConnectionOf final : public Connection {
public:
    explicit ConnectionOf(Responder responder) : responder_{std::move(responder)} {}

    void feed(std::span<const std::byte> in, TimePoint now) override
    {
        static_cast<void>(responder_.feed(in, now)); // is_closed() says the same
    }
    [[nodiscard]] std::span<const std::byte> output() const override { return responder_.output(); }
    void consume(std::size_t size) override { responder_.consume(size); }
    [[nodiscard]] TimePoint next_deadline() const override { return responder_.next_deadline(); }
    void handle_deadline(TimePoint now) override { responder_.handle_deadline(now); }
    [[nodiscard]] bool is_closed() const override { return responder_.is_closed(); }
    void set_latency(Duration latency) override { responder_.set_latency(latency); }

private:
    Responder responder_;
};

class ModbusPlc final : public Plc {
public:
    explicit ModbusPlc(std::vector<std::uint8_t> units) : device_{options(std::move(units))} {}

    std::unique_ptr<Connection> connect() override
    {
        harness::ModbusResponderOptions options;
        options.latency = latency_;
        return std::make_unique<ConnectionOf<harness::ModbusResponder>>(
            harness::ModbusResponder{device_, options});
    }
    bool set(std::string_view address, std::uint16_t value) override
    {
        const auto place = backend::parse_modbus_address(address);
        if (!place) {
            return false;
        }
        std::uint16_t& item = device_.table(place->table)[place->offset];
        if (place->bit) {
            const unsigned mask = 1U << *place->bit;
            item = static_cast<std::uint16_t>(value != 0 ? item | mask : item & ~mask);
        } else {
            item = has_bits(place->table) ? std::uint16_t{value != 0} : value;
        }
        return true;
    }
    std::optional<std::uint16_t> get(std::string_view address) override
    {
        const auto place = backend::parse_modbus_address(address);
        if (!place) {
            return std::nullopt;
        }
        const unsigned item = device_.table(place->table)[place->offset];
        return static_cast<std::uint16_t>(place->bit ? item >> *place->bit & 1U : item);
    }
    bool refuse(std::string_view address, std::uint16_t code) override
    {
        const auto place = backend::parse_modbus_address(address);
        if (place) {
            using enum backend::ModbusException;
            device_.refuse(place->table, place->offset, 1,
                           code == 0 ? IllegalDataAddress
                                     : static_cast<backend::ModbusException>(code));
        }
        return place.has_value();
    }
    void refuse_none() override { device_.refuse_none(); }
    void set_latency(Duration latency) override { latency_ = latency; }
    void set_running(bool is_running) override { is_running_ = is_running; }
    [[nodiscard]] bool is_running() const override { return is_running_; }
    bool add_label(std::string_view /*name*/, std::uint8_t /*type*/,
                   std::span<const std::byte> /*value*/) override
    {
        return false;
    }

private:
    [[nodiscard]] static harness::ModbusDeviceOptions options(std::vector<std::uint8_t> units)
    {
        harness::ModbusDeviceOptions options;
        options.units = std::move(units);
        options.objects = {{0, "Busbar"}, {1, "busbar-plc-responder"}, {2, "1"}};
        return options;
    }

    harness::ModbusDevice device_;
    Duration latency_{0};
    bool is_running_{true};
};

class SlmpPlc final : public Plc {
public:
    explicit SlmpPlc(const harness::SlmpPlcOptions& options)
        : has_labels_{options.has_labels}, responder_{options}
    {
        constexpr std::uint32_t bits = 8192;
        constexpr std::uint32_t words = 32'768;
        constexpr std::uint32_t few = 512;
        for (const char* const kind : {"X", "Y", "M", "L", "F", "V", "B", "SM", "SB"}) {
            responder_.add_devices(kind, bits);
        }
        for (const char* const kind : {"D", "W", "R", "ZR", "SD", "SW"}) {
            responder_.add_devices(kind, words);
        }
        for (const char* const kind : {"TS", "TC", "TN", "CS", "CC", "CN", "Z", "LTN", "LCN"}) {
            responder_.add_devices(kind, few);
        }
    }

    std::unique_ptr<Connection> connect() override
    {
        return std::make_unique<ConnectionOf<harness::SlmpResponder>>(
            responder_.another_connection());
    }
    bool set(std::string_view address, std::uint16_t value) override
    {
        return responder_.set(address, value);
    }
    std::optional<std::uint16_t> get(std::string_view address) override
    {
        const std::uint16_t value = responder_.get(address);
        // Only what is there can be set.
        return responder_.set(address, value) ? std::optional{value} : std::nullopt;
    }
    bool refuse(std::string_view address, std::uint16_t code) override
    {
        constexpr std::uint16_t out_of_range = 0x4031;
        return responder_.refuse(address, code == 0 ? out_of_range : code);
    }
    void refuse_none() override { responder_.refuse_none(); }
    void set_latency(Duration latency) override { responder_.set_latency(latency); }
    void set_running(bool is_running) override { responder_.set_running(is_running); }
    [[nodiscard]] bool is_running() const override { return responder_.is_running(); }
    bool add_label(std::string_view name, std::uint8_t type,
                   std::span<const std::byte> value) override
    {
        // Bytes of an element by type id; texts are one element.
        constexpr std::array<std::size_t, 9> sizes{0, 1, 2, 4, 2, 4, 4, 8, 4};
        const std::size_t size = type < sizes.size() ? sizes[type] : value.size();
        if (!has_labels_ || size == 0 || value.empty() || value.size() % size != 0) {
            return false;
        }
        responder_.add_label(name, type, value, size);
        return true;
    }

private:
    bool has_labels_;
    harness::SlmpResponder responder_;
};

} // namespace

std::unique_ptr<Plc> modbus_plc(std::vector<std::uint8_t> units)
{
    return std::make_unique<ModbusPlc>(std::move(units));
}

std::unique_ptr<Plc> slmp_plc(Family family, bool is_3e_only, bool is_datagram,
                              std::string password)
{
    harness::SlmpPlcOptions options;
    options.is_datagram = is_datagram;
    options.takes_4e = !is_3e_only && family != Family::Q;
    if (family != Family::IqR) {
        options.takes_long_form = false;
        options.has_labels = false;
        options.type_name = "FX5U-32MT/DS";
        options.model = 0x4A21;
    }
    options.is_fx5 = family == Family::Fx5;
    options.has_monitor = family != Family::Fx5;
    options.has_type_name = family != Family::Q;
    options.has_blocks = family != Family::Q;
    options.password = std::move(password);
    return std::make_unique<SlmpPlc>(options);
}

} // namespace plc_responder
