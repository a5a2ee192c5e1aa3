#pragma once

#include <vector>

#include <busbar/server/modules.hpp>

namespace busbar::fuzz {

/// All modules but the one that takes longest of making a server, and that no request changes.
[[nodiscard]] inline server::ModuleTable quick_modules()
{
    static const auto modules = [] {
        const server::ModuleTable all = server::full_modules();
        std::vector<const server::Module*> quick{all.begin(), all.end()};
        std::erase(quick, &server::modules::conformance);
        return quick;
    }();
    return modules;
}

} // namespace busbar::fuzz
