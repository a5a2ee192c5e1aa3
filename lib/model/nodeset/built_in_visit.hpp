#pragma once

#include <type_traits>

#include <core/visit_built_in.hpp>

namespace busbar::nodeset {

/// Calls `function` with the std::type_identity of the built-in type and returns its result; with
/// that of Variant for Null and DiagnosticInfo, whose values no file has.
template <typename Function>
decltype(auto) visit_built_in(BuiltInType type, Function function)
{
    return detail::visit_built_in(
        type == BuiltInType::Null ? BuiltInType::Variant : type, [&](auto tag) -> decltype(auto) {
            using T = typename decltype(tag)::type;
            using Own = std::conditional_t<std::is_same_v<T, DiagnosticInfo>, Variant, T>;
            return function(std::type_identity<Own>{});
        });
}

} // namespace busbar::nodeset
