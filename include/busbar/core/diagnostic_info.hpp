#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <busbar/core/api.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/string.hpp>

namespace busbar {

/// DiagnosticInfo (Part 4, 7.12; Part 6, 5.2.2.12). The numbers index the response's string table.
struct BUSBAR_API DiagnosticInfo {
    std::optional<std::int32_t> symbolic_id;
    std::optional<std::int32_t> namespace_uri;
    std::optional<std::int32_t> locale;
    std::optional<std::int32_t> localized_text;
    std::optional<String> additional_info;
    std::optional<StatusCode> inner_status_code;
    std::unique_ptr<DiagnosticInfo> inner_diagnostic_info;

    DiagnosticInfo() = default;
    DiagnosticInfo(const DiagnosticInfo& other);
    DiagnosticInfo(DiagnosticInfo&&) noexcept = default;
    DiagnosticInfo& operator=(const DiagnosticInfo& other);
    DiagnosticInfo& operator=(DiagnosticInfo&&) noexcept = default;
    ~DiagnosticInfo() = default;

    /// True if none of its members is set: the encoding is one zero byte.
    [[nodiscard]] bool is_null() const;

    friend BUSBAR_API bool operator==(const DiagnosticInfo& a, const DiagnosticInfo& b);
};

} // namespace busbar
