#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/backend/device_source.hpp>
#include <busbar/backend/modbus_client.hpp>
#include <busbar/backend/slmp_client.hpp>
#include <busbar/backend/slmp_device.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// The protocols of a Device. The points of a protocol are read from the addresses that its
/// engineers write.
namespace busbar::backend {

/// A device of Modbus TCP, or a gateway to several ones.
struct ModbusProtocolOptions {
    /// Its connections.
    ModbusClientOptions client{};
    /// The unit of addresses that name none.
    std::uint8_t unit{255};
    /// Registers between two addresses that are read in vain, for one request fewer. Devices that
    /// have no register there refuse this once; the two are read apart from then on.
    std::uint16_t max_gap{16};
    /// Registers that a request reads; fewer than the protocol's limit for devices that take fewer.
    std::uint16_t max_read{max_modbus_read_registers};
    /// Registers that a request writes, likewise.
    std::uint16_t max_write{max_modbus_write_registers};
    /// Asks for the device's identification (function 43/14) on each connection, before all else. A
    /// device that does not answer this, or closes the connection, is not asked again.
    bool asks_identity{true};
};

/// Reads a point's address (modbus_address.hpp). Bits of holding registers are written by function
/// 22, which no other bit of the register is touched by.
[[nodiscard]] BUSBAR_API Configured<DevicePoint>
parse_modbus_point(std::string_view text, const ModbusProtocolOptions& options = {});
/// The protocol for a device with these points.
[[nodiscard]] BUSBAR_API std::unique_ptr<DeviceProtocol>
make_modbus_protocol(const ModbusProtocolOptions& options, std::span<const DevicePoint> points);

/// The families of PLCs with SLMP, whose ports differ in what they take (SH-080956ENG, and the
/// manuals of the ports).
enum class SlmpFamily : std::uint8_t {
    /// Found out on each connection, by the name that the PLC gives its type, and by what it
    /// refuses.
    Auto,
    /// iQ-R and iQ-L.
    IqR,
    /// The built-in ports of Q and L: short form, no blocks, no type name.
    Q,
    /// Q and L by their Ethernet modules: short form.
    QModule,
    /// FX5: short form, fewer bits, and one request at a time over TCP, since only the last one is
    /// answered otherwise. X and Y are octal.
    Fx5,
};

/// A PLC that speaks SLMP.
struct SlmpProtocolOptions {
    /// Its connections.
    SlmpClientOptions client{};
    /// Its family. Whatever a PLC of another family refuses is not asked for any more. A connection
    /// to one with another notation of X and Y than configured is ended if these are used.
    SlmpFamily family{SlmpFamily::IqR};
    /// The notation of its addresses. The short form of requests is used after a PLC has refused
    /// the long form that this says.
    SlmpNotation notation{};
    /// The frame is found out: 4E first, and 3E if that has no answer, which PLCs that know only 3E
    /// say nothing to.
    bool finds_frame{true};
    /// Words between two addresses that are read in vain, for one request fewer; bits 16 times as
    /// many. At most 8 while the PLC takes lists of words, which cost less then.
    std::uint16_t max_gap{32};
    /// Words of one request.
    std::uint16_t max_words{960};
    /// Bits of one request, if the family takes so many.
    std::uint16_t max_bits{7'168};
    /// Unlocks the port at the begin of each connection (remote password); empty: it is not locked.
    std::string password{};
};

/// Returns the name of a family in configurations: "auto", "iq-r", "q", "q-module", "fx5".
[[nodiscard]] BUSBAR_API const char* name_of(SlmpFamily family);
/// Returns the family with this name.
[[nodiscard]] BUSBAR_API std::optional<SlmpFamily> find_slmp_family(std::string_view name);
/// The options of a family.
[[nodiscard]] BUSBAR_API SlmpProtocolOptions slmp_options(SlmpFamily family);

/// Reads a point's address: a device (slmp_device.hpp), then `:type` and `:order` as in Modbus, but
/// with the lowest word first unless told otherwise: "D100:int32", "W1F:float", "D200:text20",
/// "X1F", "D10.3". A double word device, such as LZ, has int32 without a type. Bits of words are
/// read-only: the protocol writes whole words, and a word that is read, changed and written back
/// undoes what the PLC's program has made of the other bits in between. With SlmpFamily::Auto, X
/// and Y beyond 7 are refused, since they are other ones in octal and in hexadecimal.
[[nodiscard]] BUSBAR_API Configured<DevicePoint>
parse_slmp_point(std::string_view text, const SlmpProtocolOptions& options = {});
/// The protocol for a PLC with these points.
[[nodiscard]] BUSBAR_API std::unique_ptr<DeviceProtocol>
make_slmp_protocol(const SlmpProtocolOptions& options, std::span<const DevicePoint> points);

} // namespace busbar::backend
