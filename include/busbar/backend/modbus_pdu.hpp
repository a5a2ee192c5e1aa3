#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/expected.hpp>
#include <busbar/core/result.hpp>

/// Requests and responses of Modbus (MODBUS Application Protocol V1.1b3) and their frames over TCP
/// (MODBUS Messaging on TCP/IP V1.0b), for both sides. Section numbers are of the former.
namespace busbar::backend {

/// The functions that are known here, by their codes (5.1).
enum class ModbusFunction : std::uint8_t {
    ReadCoils = 1,
    ReadDiscreteInputs = 2,
    ReadHoldingRegisters = 3,
    ReadInputRegisters = 4,
    WriteCoil = 5,
    WriteRegister = 6,
    WriteCoils = 15,
    WriteRegisters = 16,
    MaskWriteRegister = 22,
    ReadWriteRegisters = 23,
    /// Function 43 with MEI type 14, the only one that is known here.
    ReadDeviceIdentification = 43,
};

/// True if the function is one of the enumeration.
[[nodiscard]] BUSBAR_API bool is_known(ModbusFunction function);
/// True if the function changes the device.
[[nodiscard]] BUSBAR_API bool is_write(ModbusFunction function);

/// Maximum number of coils or inputs of a request that reads them (6.1, 6.2).
inline constexpr std::size_t max_modbus_read_bits = 2000;
/// Maximum number of registers of a request that reads them (6.3, 6.4).
inline constexpr std::size_t max_modbus_read_registers = 125;
/// Maximum number of coils of a request that writes them (6.11).
inline constexpr std::size_t max_modbus_write_coils = 1968;
/// Maximum number of registers of a request that writes them (6.12).
inline constexpr std::size_t max_modbus_write_registers = 123;
/// Registers that function 23 may write.
inline constexpr std::size_t max_modbus_read_write_registers = 121;
/// The size of a request or response from its function code on (4.1).
inline constexpr std::size_t max_modbus_pdu_size = 253;
/// The size of what precedes it over TCP, with the unit id.
inline constexpr std::size_t modbus_header_size = 7;

/// The reason for which a device refuses a request (section 7).
enum class ModbusException : std::uint8_t {
    IllegalFunction = 1,
    IllegalDataAddress = 2,
    IllegalDataValue = 3,
    DeviceFailure = 4,
    Acknowledge = 5,
    DeviceBusy = 6,
    NegativeAcknowledge = 7,
    MemoryParityError = 8,
    GatewayPathUnavailable = 10,
    GatewayTargetSilent = 11,
};

/// Returns the status of a value whose request was answered so. Never Good but for Acknowledge of a
/// write, which the device completes later: Good_CompletesAsynchronously.
[[nodiscard]] BUSBAR_API StatusCode status_of(ModbusException exception, ModbusFunction function);
/// True if the device refuses what is in the request, false if it can do nothing at present: the
/// same request may have another answer later.
[[nodiscard]] BUSBAR_API bool is_refusal(ModbusException exception);
/// Returns a text such as "exception 2 (address not available)".
[[nodiscard]] BUSBAR_API std::string text_of(ModbusException exception);

/// A request. Functions that have no use for a member ignore it.
struct ModbusRequest {
    /// The function that is asked for.
    ModbusFunction function{ModbusFunction::ReadHoldingRegisters};
    /// The first item, from 0: the one read by function 23, otherwise that read or written.
    std::uint16_t address{0};
    /// Number of items to read; not used by functions that only write.
    std::uint16_t quantity{1};
    /// The items to write: registers, or 0 and 1 for coils. One for functions 5 and 6.
    std::vector<std::uint16_t> values{};
    /// The first register that function 23 writes; it does so before it reads.
    std::uint16_t write_address{0};
    /// Function 22: the register becomes (old AND and_mask) OR (or_mask AND NOT and_mask).
    std::uint16_t and_mask{0};
    /// The bits that the mask leaves to set (6.16).
    std::uint16_t or_mask{0};
    /// Function 43: 1 basic, 2 regular, 3 extended, 4 one object (6.21).
    std::uint8_t read_code{1};
    /// Function 43: the object, or the first one.
    std::uint8_t object{0};

    friend bool operator==(const ModbusRequest&, const ModbusRequest&) = default;
};

/// The description that a device gives of itself (6.21).
struct ModbusIdentification {
    /// One of its texts, such as the vendor's name.
    struct Object {
        /// The object's number (6.21).
        std::uint8_t id{0};
        /// The bytes as the device sends them, mostly ASCII.
        std::string value{};

        friend bool operator==(const Object&, const Object&) = default;
    };

    /// The read code of the request.
    std::uint8_t read_code{1};
    /// The most detailed read code that it serves; with 80 hexadecimal, single objects also.
    std::uint8_t conformity{1};
    /// The object to go on with, if not all of them fit.
    std::optional<std::uint8_t> next{};
    /// The objects in the order of their numbers.
    std::vector<Object> objects{};

    friend bool operator==(const ModbusIdentification&, const ModbusIdentification&) = default;
};

/// The answer to a request.
struct ModbusResponse {
    /// The function that is answered.
    ModbusFunction function{ModbusFunction::ReadHoldingRegisters};
    /// If set, the device refuses, and the following members are empty.
    std::optional<ModbusException> exception{};
    /// The values read: registers, or 0 and 1 for bits.
    std::vector<std::uint16_t> values{};
    /// Function 43 only.
    ModbusIdentification identification{};

    friend bool operator==(const ModbusResponse&, const ModbusResponse&) = default;
};

/// Appends a request to `out`. Bad_OutOfRange, and nothing appended, if the function is unknown, if
/// it has no items or more than the protocol allows, if they end after item 65535, or if a coil's
/// value is not 0 or 1.
[[nodiscard]] BUSBAR_API Result<void> encode_modbus(const ModbusRequest& request,
                                                    std::vector<std::byte>& out);
/// Reads a request as the device that received it. Otherwise returns the exception that it must
/// answer with, in the order of 7: the function, then quantities and values. Whether the address
/// exists remains to be checked, as that is the device's own affair; `pdu` is not empty.
[[nodiscard]] BUSBAR_API Expected<ModbusRequest, ModbusException>
parse_modbus_request(std::span<const std::byte> pdu);

/// Appends the response to `asked`. Objects of an identification that do not fit are left out, and
/// `next` names the first of these. Bad_OutOfRange, and nothing appended, if the response has not
/// as many values as `asked` requests.
[[nodiscard]] BUSBAR_API Result<void> encode_modbus(const ModbusRequest& asked,
                                                    const ModbusResponse& response,
                                                    std::vector<std::byte>& out);
/// Reads the response to `asked`. Bad_UnknownResponse if it is that of another request: function,
/// number of values, and what the device must echo are compared, and nothing may follow.
[[nodiscard]] BUSBAR_API Result<ModbusResponse>
parse_modbus_response(const ModbusRequest& asked, std::span<const std::byte> pdu);

/// The header of a request or response over TCP (Messaging on TCP/IP, 3.1.3).
struct ModbusHeader {
    /// The number that a response repeats.
    std::uint16_t transaction{0};
    /// The unit behind a gateway; 0 or 255 for the device itself.
    std::uint8_t unit{255};
    /// Size of the request or response that follows, 1 to max_modbus_pdu_size.
    std::size_t pdu_size{1};

    friend bool operator==(const ModbusHeader&, const ModbusHeader&) = default;
};

/// Appends a header.
BUSBAR_API void encode_modbus(const ModbusHeader& header, std::vector<std::byte>& out);
/// Reads the header at the beginning of `bytes`; none if these are fewer than modbus_header_size.
/// Bad_DecodingError if the protocol is not 0 or the length not in the limits, as soon as these are
/// there: what follows cannot be told apart any more.
[[nodiscard]] BUSBAR_API Result<std::optional<ModbusHeader>>
parse_modbus_header(std::span<const std::byte> bytes);

} // namespace busbar::backend
