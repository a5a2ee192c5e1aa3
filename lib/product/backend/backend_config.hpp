#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/slmp_labels.hpp>

namespace busbar::product {

class TomlTable;

/// A Variable whose value is in the PLC of a backend.
struct BackendVariable {
    std::string name;
    /// Its address as the configuration or table has it.
    std::string at;
    backend::DevicePoint point;
    /// Code of UNECE Recommendation 20, such as "CEL"; empty for none.
    std::string unit;
    std::string description;
};

/// A PLC that the controller reads and writes over the network.
struct BackendConfig {
    /// Also the name of its folder.
    std::string name;
    backend::DeviceConfig device;
    std::variant<backend::ModbusProtocolOptions, backend::SlmpProtocolOptions> protocol;
    backend::DeviceSourceOptions source;
    std::vector<BackendVariable> variables;

    /// "modbus" or "slmp".
    [[nodiscard]] const char* protocol_name() const
    {
        return protocol.index() == 0 ? "modbus" : "slmp";
    }
    /// The points of its variables, in their order.
    [[nodiscard]] std::vector<backend::DevicePoint> points() const;
    /// Creates the protocol for these.
    [[nodiscard]] std::unique_ptr<backend::DeviceProtocol> make_protocol() const;
};

/// Variables of one backend.
inline constexpr std::size_t most_backend_variables = 100'000;

/// The keys of [labels] that read_slmp_labels() reads.
[[nodiscard]] std::span<const std::string_view> slmp_labels_keys();
/// Reads from [labels] how to reach the PLC whose labels these are. Throws ConfigError.
[[nodiscard]] backend::SlmpLabelsOptions read_slmp_labels(const TomlTable& table);
/// Returns the values of the keys, in a text that is the same for the same values.
[[nodiscard]] std::string keys_text(const TomlTable& table, std::span<const std::string_view> keys);
/// Reads all [[backend]]. Throws ConfigError.
[[nodiscard]] std::vector<BackendConfig> read_backends(const TomlTable& root);

} // namespace busbar::product
