#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/status_code.hpp>

/// The end codes with which a PLC says that it does not serve a request.
namespace busbar::backend {

/// The part of a request that an end code is about, which says what may help.
enum class SlmpFault : std::uint8_t {
    None,
    Address, // one of the devices or labels: the others can be asked without it
    Size,    // too much for one request: less may be right
    Request, // the request as a whole, which is never served
    State,   // the state of the PLC or the port, which may change
};

/// An end code.
struct SlmpEndCode {
    /// The code.
    std::uint16_t code{0};
    /// The part that it is about.
    SlmpFault fault{SlmpFault::None};
    /// The status of the values that were requested.
    StatusCode status;
    /// The reason, as a part of a sentence: "the port is locked by a remote password".
    std::string_view text;
};

/// Returns what is known of an end code. Codes that are not known are a fault of the request with
/// Bad_DeviceFailure and an empty text.
[[nodiscard]] BUSBAR_API SlmpEndCode slmp_end_code(std::uint16_t code);

/// Returns a text for people: "C201: the port is locked by a remote password".
[[nodiscard]] BUSBAR_API std::string slmp_end_code_text(std::uint16_t code);

} // namespace busbar::backend
