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
/// What only administrators are told: which of the server's things an operation was about.
inline constexpr std::uint32_t for_administrators = additional_info | additional_info
                                                                          << to_operations;
} // namespace diagnostic_bit

/// What a response tells of what went wrong, as far as the client has asked for it (Part 4, 7.12).
/// Texts lie in the response's string table, each once; the innerStatusCode is never there, as no
/// other system stands behind this one.
class ReturnDiagnostics {
public:
    /// Bytes of additionalInfo in one response; there are none beyond.
    static constexpr std::size_t max_additional_info = std::size_t{64} * 1'024;
    /// About the bytes of what one operation was about, and of why it was refused.
    static constexpr std::size_t max_operand = 256;
    static constexpr std::size_t max_reason = 1'024;

    /// `wanted`: bits of returnDiagnostics.
    explicit ReturnDiagnostics(std::uint32_t wanted) : wanted_{wanted} {}

    [[nodiscard]] bool wants_operations() const
    {
        return (wanted_ & diagnostic_bit::of_operations) != 0;
    }
    /// Of the whole request.
    [[nodiscard]] DiagnosticInfo of_service(StatusCode status);
    /// Of one operation; nothing if that is Good. `operand` says what it was about, `reason` why it
    /// was refused, empty where that is not known or not for this client.
    [[nodiscard]] DiagnosticInfo of_operation(StatusCode status, FunctionRef<std::string()> operand,
                                              FunctionRef<std::string_view()> reason);
    /// One for each of `count` operations; none at all if nothing was wrong with any.
    [[nodiscard]] Array<DiagnosticInfo>
    of_operations(std::size_t count, FunctionRef<StatusCode(std::size_t)> status,
                  FunctionRef<std::string(std::size_t)> operand,
                  FunctionRef<std::string_view(std::size_t)> reason);
    /// The same where no reason is known.
    [[nodiscard]] Array<DiagnosticInfo> of_operations(std::size_t count,
                                                      FunctionRef<StatusCode(std::size_t)> status,
                                                      FunctionRef<std::string(std::size_t)> operand)
    {
        return of_operations(count, status, operand,
                             [](std::size_t) { return std::string_view{}; });
    }
    /// The string table of what was asked for until now.
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
