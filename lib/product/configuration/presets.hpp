#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/machine_types.hpp>
#include <busbar/controller/publishing_limits.hpp>
#include <busbar/crypto/store_limits.hpp>
#include <busbar/server/limits.hpp>
#include <busbar/server/password_rules.hpp>

#include "subject_names.hpp"

namespace busbar::product {

/// What a shipping product allows: all its published limits at once.
struct Preset {
    std::string_view name;
    server::ServerLimits limits;
    crypto::StoreLimits store;
    server::PasswordRules passwords;
    /// Of a machine's variables; none where the product publishes none by itself.
    controller::PublishingLimits publishing{};
    controller::MachineTypeOptions types{.elementary = controller::ElementaryTypes::BuiltIn};
    /// Of the certificate that the product makes by itself.
    SubjectNames subject{};
};

/// "nj501, nx102 or rd81opc96".
inline constexpr std::string_view preset_names = "nj501, nx102 or rd81opc96";
[[nodiscard]] std::optional<Preset> find_preset(std::string_view name);
/// Its figures as one JSON object.
[[nodiscard]] std::string preset_json(const Preset& preset);
/// Prints that; 2 for a name that is none.
[[nodiscard]] int print_preset(const std::string& name);

} // namespace busbar::product
