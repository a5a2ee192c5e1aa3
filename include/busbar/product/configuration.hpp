#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// Who made the controller, as BuildInfo tells clients (Part 5, 12.4). What is empty is Busbar's.
struct ProductNames {
    std::string manufacturer{};
    std::string product_uri{};
    std::string version{};
};

/// Where a controller's configuration comes from. What is in force is, later ones first: the
/// command line, which here is `port` and `preset`; what administrators changed online; the project
/// of model mode; the file; built-in values.
struct Configuration {
    /// In TOML, as `busbar-controller --print-config` explains it; empty: that built-in one.
    std::string file{};
    /// Instead of the file's; 0 is any that is free.
    std::optional<std::uint16_t> port{};
    /// The limits of a product instead of the file's: nj501, nx102 or rd81opc96.
    std::string preset{};
    /// The folder of a project of model mode; empty: there is none.
    std::string project{};
    ProductNames names{};
};

/// Whether a controller could begin with it, as far as that can be told without listening. The
/// problem says where in which file it is.
[[nodiscard]] BUSBAR_API Configured<void> check(const Configuration& configuration);

} // namespace busbar::product
