#pragma once

#include <cstddef>
#include <string_view>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>

namespace busbar::controller::detail {

/// What a name stands for in a program.
struct FoundLabel {
    backend::LabelError error{backend::LabelError::Unknown};
    // Of those without error.
    backend::LabelKind kind{};
    /// In the program's memory, as label_access.hpp reads and writes it.
    std::byte* at{nullptr};
    bool is_unsampled{false};
};

/// Looks up a name as SH-082679, 8.3 writes it. What is no such name is NotAName.
[[nodiscard]] FoundLabel find_label(const LabelProgram& program, std::string_view name);

} // namespace busbar::controller::detail
