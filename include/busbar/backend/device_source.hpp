#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <busbar/backend/device.hpp>
#include <busbar/backend/modbus_value.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/server/data_source.hpp>

/// The Variables of a PLC behind a Device.
namespace busbar::backend {

/// The line through two points by which a number of a PLC becomes one of the plant: 4 to 20 mA,
/// which a module has as 0 to 27648, as 0 to 400 degrees. The value is a Double then.
struct DeviceScale {
    /// A number of the PLC, whose value is `low`.
    double raw_low{0};
    /// Another one, whose value is `high`.
    double raw_high{1};
    /// The value of `raw_low`.
    double low{0};
    /// The value of `raw_high`.
    double high{1};

    friend bool operator==(const DeviceScale&, const DeviceScale&) = default;
};

/// A value in a PLC, by what the words of its place mean.
struct DevicePoint {
    /// Its place.
    PlanAddress address;
    /// The representation of the value in the words.
    ModbusValueType type{};
    /// For a Bool in a word: the bit that it is, 0 to 15.
    std::optional<std::uint8_t> bit{};
    /// For numbers only.
    std::optional<DeviceScale> scale{};
    /// False if the protocol cannot write it, or it shall not be written.
    bool is_writable{false};

    friend bool operator==(const DevicePoint&, const DevicePoint&) = default;
};

/// The data type of a point's value: that of its type, and Double with a scale.
[[nodiscard]] BUSBAR_API BuiltInType data_type_of(const DevicePoint& point);
/// Reads a point's value from its words. Errors of read_modbus().
[[nodiscard]] BUSBAR_API Result<Variant> read_point(const DevicePoint& point,
                                                    std::span<const std::uint16_t> words);
/// Writes a point's value to its words, which are as many as it has, and returns the bits that are
/// written of a word. Bad_TypeMismatch; Bad_OutOfRange for a value that the PLC's type has no
/// number for, which a scaled one is rounded to.
[[nodiscard]] BUSBAR_API Result<std::uint16_t>
write_point(const DevicePoint& point, const Variant& value, std::span<std::uint16_t> words);

/// The answer of a Variable while its PLC does not answer.
enum class WhenAway : std::uint8_t {
    /// Bad_NoCommunication, with the time when this was found and without the value.
    Bad,
    /// The last value with its time and Uncertain_NoCommunicationLastUsableValue, once there was
    /// one.
    LastValue,
};

/// The answer of a Variable while its PLC is not in RUN, as far as the PLC says so.
enum class WhenStopped : std::uint8_t {
    /// The value with Uncertain_LastUsableValue: the program does not renew it.
    Uncertain,
    /// The value as in RUN.
    Good,
    /// Bad_OutOfService without a value.
    Bad,
};

/// The configuration of a DeviceSource.
struct DeviceSourceOptions {
    /// After which a batch ends with Bad_Timeout for what has no answer yet.
    std::chrono::milliseconds timeout{5'000};
    /// For all points.
    WhenAway when_away{WhenAway::Bad};
    /// Likewise. The PLC's mode is read with each batch of values, in the same request if there is
    /// place in it.
    WhenStopped when_stopped{WhenStopped::Uncertain};
};

/// The state of a device as values of Variables, see DeviceSource::status_handle.
enum class DeviceFact : std::uint8_t {
    State,          // UInt32: DeviceState
    Trouble,        // String: the reason for not being Online
    Identity,       // String: what the PLC calls itself, in one line
    Vendor,         // String: its maker
    Product,        // String: its type
    Revision,       // String: its version
    Family,         // String: the family of PLCs that it is of
    Mode,           // UInt32: DeviceMode
    ConnectedSince, // DateTime, null while it is not Online
    Connections,    // UInt64, and so on, from DeviceCounters
    Requests,
    Answers,
    Refusals,
    Failures,
    RoundTrip,      // Double: milliseconds of the last answer
    WorstRoundTrip, // Double: milliseconds
    ReadTime,       // Double: milliseconds from the last batch of samples to its last answer
    LastRefusal,    // String: the PLC's last reason for refusing a request
};

/// Number of DeviceFacts.
inline constexpr std::size_t device_facts = 18;
/// BrowseName of a fact's Variable: "RoundTrip".
[[nodiscard]] BUSBAR_API const char* name_of(DeviceFact fact);

/// Serves the points of one device, and its facts. Samples of one interval are one batch, in which
/// each address is read once. The SourceTimestamp of a value is the time of the read that found it
/// changed, which values of one request have in common. Everything is on the server's thread, where
/// the device's driver is, too.
///
/// A Read with a maxAge is answered from the last values if all of these are young enough (Part 4,
/// 5.11.2.2), and nothing has been written or has failed since. A Write is answered by what the PLC
/// said: several writes stay in order and none is left out.
class BUSBAR_API DeviceSource final : public server::DataSource {
public:
    /// The handle of points[i] is i. `now` returns the time that the device's driver has, too.
    /// `device` and `clock` must outlive the object.
    DeviceSource(Device& device, std::vector<DevicePoint> points, const WallClock& clock,
                 TimePoint (*now)(), DeviceSourceOptions options = {});
    ~DeviceSource() override;

    /// The points.
    [[nodiscard]] std::span<const DevicePoint> points() const;
    /// The handle of a fact.
    [[nodiscard]] static constexpr std::uint64_t status_handle(DeviceFact fact)
    {
        return first_fact + static_cast<std::uint64_t>(fact);
    }
    /// A value of a fact's data type.
    [[nodiscard]] Variant fact(DeviceFact fact) const;

    /// Those of DeviceSourceOptions, and defaults.
    [[nodiscard]] server::DataSourceOptions options() const override;
    /// Answers at once while there is no connection.
    void read(server::ReadBatch batch) override;
    /// Likewise.
    void write(server::WriteBatch batch) override;

private:
    static constexpr std::uint64_t first_fact = std::uint64_t{1} << 32U;
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::backend
