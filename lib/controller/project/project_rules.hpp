#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/project.hpp>

namespace busbar::controller::detail {

/// A problem with a value, or nothing.
using ValueProblem = std::optional<Problem>;

[[nodiscard]] ValueProblem wrong_value(std::string where, std::string_view found,
                                       std::string_view expected);

/// The characters that a value may have with a preset (SH-082679, Appendix 6). The shading of that
/// table is missing in the text; the sets follow its footnotes: letters, digits and the underscore.
enum class Characters : std::uint8_t {
    Any,
    Word,      // letters, digits, underscore
    UpperWord, // the same without lower-case letters
    Url,       // letters, digits, ":", "/" and "."
};
[[nodiscard]] ValueProblem check_characters(const std::string& where, std::string_view value,
                                            Characters characters);

/// Parses "192.168.3.40" as a number.
[[nodiscard]] std::optional<std::uint32_t> ipv4_of(std::string_view text);

[[nodiscard]] ValueProblem check_network(const Project& project, bool has_preset);
[[nodiscard]] ValueProblem check_security(const ProjectSecurity& security);
[[nodiscard]] ValueProblem check_certificate(const ProjectCertificate& certificate,
                                             bool has_preset);
[[nodiscard]] ValueProblem check_discovery(const ProjectDiscovery& discovery, bool has_preset);
[[nodiscard]] ValueProblem check_users(const Project& project, bool has_preset);
[[nodiscard]] ValueProblem check_model_files(const Project& project, bool has_preset);

} // namespace busbar::controller::detail
