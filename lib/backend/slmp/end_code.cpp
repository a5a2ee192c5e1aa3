#include <busbar/backend/slmp_end_code.hpp>

#include <algorithm>
#include <array>

#include <busbar/core/status_codes.hpp>

namespace busbar::backend {

namespace {

using enum SlmpFault;

/// Sorted by code. PLCs of different families use some of them for different reasons; then the text
/// has both.
constexpr std::array end_codes{
    SlmpEndCode{0x0000, None, status::Good, "done"},
    SlmpEndCode{0x0050, Request, status::Bad_CommunicationError,
                "the subheader of the frame is not one that the PLC knows"},
    SlmpEndCode{0x0054, Request, status::Bad_CommunicationError,
                "the port expects ASCII and found a byte that is not a hexadecimal digit"},
    SlmpEndCode{0x0055, State, status::Bad_InvalidState,
                "the PLC is in RUN and its port does not allow writing then"},
    SlmpEndCode{0x4013, State, status::Bad_InvalidState, "the PLC is not in STOP"},
    SlmpEndCode{0x4030, Address, status::Bad_ConfigurationError,
                "a device cannot be reached with this command"},
    SlmpEndCode{0x4031, Address, status::Bad_ConfigurationError,
                "a device is outside the range that the PLC's parameters give it"},
    SlmpEndCode{0x4043, Address, status::Bad_ConfigurationError,
                "there is no module with this number"},
    SlmpEndCode{0x4080, Size, status::Bad_RequestTooLarge,
                "too many random points, or a wrong module number"},
    SlmpEndCode{0x40C0, Address, status::Bad_ConfigurationError,
                "a label is unknown, or not open to access from external devices"},
    SlmpEndCode{0x413E, State, status::Bad_InvalidState, "the state of the file forbids it"},
    SlmpEndCode{0x414A, Address, status::Bad_NotWritable,
                "memory of another CPU must not be written"},
    SlmpEndCode{0xC050, Request, status::Bad_CommunicationError,
                "the port expects ASCII that it could convert"},
    SlmpEndCode{0xC051, Size, status::Bad_RequestTooLarge, "too many or no words in one request"},
    SlmpEndCode{0xC052, Size, status::Bad_RequestTooLarge, "too many or no bits in one request"},
    SlmpEndCode{0xC053, Size, status::Bad_RequestTooLarge, "too many random bits in one request"},
    SlmpEndCode{0xC054, Size, status::Bad_RequestTooLarge, "too many random words in one request"},
    SlmpEndCode{0xC056, Address, status::Bad_ConfigurationError,
                "a device is past the largest number"},
    SlmpEndCode{0xC058, Request, status::Bad_CommunicationError,
                "the length of the request does not fit its content in ASCII"},
    SlmpEndCode{0xC059, Request, status::Bad_NotSupported,
                "this PLC does not have the command, or not in this form"},
    SlmpEndCode{0xC05B, Address, status::Bad_ConfigurationError,
                "a device cannot be read or written with this command"},
    SlmpEndCode{0xC05C, Address, status::Bad_ConfigurationError,
                "a device is unknown, or does not have what is requested of it, such as bits"},
    SlmpEndCode{0xC05D, State, status::Bad_InvalidState, "no devices are registered as a monitor"},
    SlmpEndCode{0xC05F, Request, status::Bad_NotSupported,
                "the station that is addressed does not serve this request"},
    SlmpEndCode{0xC060, Request, status::Bad_OutOfRange, "a bit is neither 0 nor 1"},
    SlmpEndCode{0xC061, Request, status::Bad_CommunicationError,
                "the length of the request does not fit its content, or the PLC does not know the "
                "form"},
    SlmpEndCode{0xC06F, Request, status::Bad_CommunicationError,
                "the port expects ASCII and got binary, or the other way round"},
    SlmpEndCode{0xC075, Request, status::Bad_CommunicationError,
                "the PLC could not read the labels of the request"},
    SlmpEndCode{0xC201, State, status::Bad_UserAccessDenied,
                "the port is locked by a remote password"},
    SlmpEndCode{0xC207, State, status::Bad_InvalidState, "the state of the file forbids it"},
    SlmpEndCode{0xC810, State, status::Bad_UserAccessDenied, "the remote password is wrong"},
};

} // namespace

SlmpEndCode slmp_end_code(std::uint16_t code)
{
    const auto* const found = std::lower_bound(
        end_codes.begin(), end_codes.end(), code,
        [](const SlmpEndCode& row, std::uint16_t wanted) { return row.code < wanted; });
    return found == end_codes.end() || found->code != code
               ? SlmpEndCode{code, SlmpFault::Request, status::Bad_DeviceFailure, {}}
               : *found;
}

std::string slmp_end_code_text(std::uint16_t code)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (const unsigned shift : {12U, 8U, 4U, 0U}) {
        text += digits[code >> shift & 0xFU];
    }
    const std::string_view reason = slmp_end_code(code).text;
    return text + ": " +
           std::string{reason.empty() ? "a code that is not known here; the PLC's "
                                        "manual has it among its error codes"
                                      : reason};
}

} // namespace busbar::backend
