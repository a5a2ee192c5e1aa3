#pragma once

#include <cstddef>
#include <string_view>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>

namespace busbar::controller::detail {

/// The label that a name denotes in a program.
struct FoundLabel {
    backend::LabelError error{backend::LabelError::Unknown};
    // Valid if there is no error.
    backend::LabelKind kind{};
    /// Points into the program's memory, which label_access.hpp reads and writes.
    std::byte* at{nullptr};
    bool is_unsampled{false};
};

/// Looks up a name that is written as in SH-082679, 8.3. Other texts give NotAName.
[[nodiscard]] FoundLabel find_label(const LabelProgram& program, std::string_view name);

} // namespace busbar::controller::detail
