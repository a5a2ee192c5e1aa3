#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// The maker of the controller, as BuildInfo describes it to clients (Part 5, 12.4). Empty members
/// are Busbar's.
struct ProductNames {
    std::string manufacturer{};
    std::string product_uri{};
    std::string version{};
};

/// The sources of a controller's configuration. In order of precedence: the command line, which
/// here is `port` and `preset`; online changes of administrators; the project of model mode; the
/// file; built-in values.
struct Configuration {
    /// In TOML, as `busbar-controller --print-config` explains it; if empty, the built-in one.
    std::string file{};
    /// Replaces the file's port; 0 means any free one.
    std::optional<std::uint16_t> port{};
    /// The limits of a product, which replace the file's: nj501, nx102 or rd81opc96.
    std::string preset{};
    /// The folder of a project of model mode; empty for none.
    std::string project{};
    ProductNames names{};
};

/// Checks whether a controller could start with it, as far as possible without listening. The
/// problem names the place and the file.
[[nodiscard]] BUSBAR_API Configured<void> check(const Configuration& configuration);

} // namespace busbar::product
