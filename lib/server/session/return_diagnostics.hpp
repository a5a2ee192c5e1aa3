#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/array.hpp>
#include <busbar/core/diagnostic_info.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/types/common.hpp>

namespace busbar::server::detail {

/// Bits of RequestHeader.returnDiagnostics (Part 4, 7.32): at the level of the service, and the
/// same five to the left for its operations.
namespace diagnostic_bit {
inline constexpr std::uint32_t symbolic_id = 0x01;
inline constexpr std::uint32_t localized_text = 0x02;
inline constexpr std::uint32_t additional_info = 0x04;
inline constexpr std::uint32_t of_service = 0x1F;
inline constexpr unsigned to_operations = 5;
inline constexpr std::uint32_t of_operations = of_service << to_operations;
/// Only administrators get the subject of an operation.
inline constexpr std::uint32_t for_administrators = additional_info | additional_info
                                                                          << to_operations;
} // namespace diagnostic_bit

/// The diagnostics of a response, as far as the client has requested them (Part 4, 7.12). Texts are
/// in the response's string table, each once; there is never an innerStatusCode, since this server
/// does not depend on another system.
class ReturnDiagnostics {
public:
    /// Bytes of additionalInfo in one response; further ones are left out.
    static constexpr std::size_t max_additional_info = std::size_t{64} * 1'024;
    /// Approximate limit of the bytes that describe one operation, and of its reason.
    static constexpr std::size_t max_operand = 256;
    static constexpr std::size_t max_reason = 1'024;

    /// `wanted` has bits of returnDiagnostics.
    explicit ReturnDiagnostics(std::uint32_t wanted) : wanted_{wanted} {}

    [[nodiscard]] bool wants_operations() const
    {
        return (wanted_ & diagnostic_bit::of_operations) != 0;
    }
    /// Returns the diagnostics of the whole request.
    [[nodiscard]] DiagnosticInfo of_service(StatusCode status);
    /// Returns the diagnostics of one operation; nothing if that is Good. `operand` describes its
    /// subject, `reason` the reason of a refusal; empty if unknown or not for this client.
    [[nodiscard]] DiagnosticInfo of_operation(StatusCode status, FunctionRef<std::string()> operand,
                                              FunctionRef<std::string_view()> reason);
    /// Returns one for each of `count` operations; none at all if all were Good.
    [[nodiscard]] Array<DiagnosticInfo>
    of_operations(std::size_t count, FunctionRef<StatusCode(std::size_t)> status,
                  FunctionRef<std::string(std::size_t)> operand,
                  FunctionRef<std::string_view(std::size_t)> reason);
    /// Returns the same without reasons.
    [[nodiscard]] Array<DiagnosticInfo> of_operations(std::size_t count,
                                                      FunctionRef<StatusCode(std::size_t)> status,
                                                      FunctionRef<std::string(std::size_t)> operand)
    {
        return of_operations(count, status, operand,
                             [](std::size_t) { return std::string_view{}; });
    }
    /// Returns the string table of everything returned so far.
    [[nodiscard]] Array<String> string_table() const;

private:
    [[nodiscard]] DiagnosticInfo describe(StatusCode status, std::uint32_t bits);
    [[nodiscard]] std::int32_t index_of(std::string_view text);

    std::uint32_t wanted_;
    std::size_t info_left_{max_additional_info};
    /// A few dozen at most: names of StatusCodes.
    std::vector<std::string> table_;
};

} // namespace busbar::server::detail
