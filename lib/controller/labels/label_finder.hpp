#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include <busbar/backend/label.hpp>
#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>
#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// The label that a name denotes in a program.
struct FoundLabel {
    backend::LabelError error{backend::LabelError::Unknown};
    // Valid if there is no error.
    backend::LabelKind kind{};
    /// Points into the program's memory, which load_label() and store_label() read and write.
    std::byte* at{nullptr};
    bool is_unsampled{false};
};

/// Looks up a name that is written as in SH-082679, 8.3. Other texts give NotAName.
[[nodiscard]] FoundLabel find_label(const LabelProgram& program, std::string_view name);

/// Nothing if labels cannot have this type.
[[nodiscard]] std::optional<backend::LabelType> label_type_of(ElementaryType type);

/// Tells which timer or counter a structure of label_types() is; nothing for other types.
[[nodiscard]] std::optional<backend::LabelType> timer_type_of(const DerivedType& type);

/// Tells whether the elements are UTF-16 units, so that the last dimension is a text.
[[nodiscard]] bool is_utf16_text(const TypeUse& use, const ProgramTypes& types);

/// Tells whether values at this address, such as "%FX0" or "U3E0\G10", cannot be sampled in each
/// scan (SH-082679, 8.3: collectible devices). False for an empty address.
[[nodiscard]] BUSBAR_API bool is_unsampled_device(std::string_view address);

} // namespace busbar::controller::detail
