#include <array>

#include <busbar/server/modules.hpp>

namespace busbar::server {

// Each table has a function of its own, so that a program links only the tables that it calls.

ModuleTable micro_modules()
{
    return {};
}

ModuleTable embedded_modules()
{
    static constexpr std::array table{&modules::methods, &modules::triggering,
                                      &modules::definition_checks};
    return table;
}

ModuleTable standard_modules()
{
    static constexpr std::array table{
        &modules::methods, &modules::triggering,  &modules::definition_checks, &modules::transfer,
        &modules::events,  &modules::diagnostics, &modules::conformance};
    return table;
}

ModuleTable full_modules()
{
    // All types first, which are then found at once.
    static constexpr std::array table{
        &modules::all_types,       &modules::methods,       &modules::triggering,
        &modules::transfer,        &modules::events,        &modules::diagnostics,
        &modules::node_management, &modules::issued_tokens, &modules::definition_checks,
        &modules::conformance,
    };
    return table;
}

} // namespace busbar::server
