#pragma once

#include <optional>
#include <string_view>

#include <busbar/backend/label.hpp>
#include <busbar/controller/program_types.hpp>

/// Maps types and addresses of a program to types of labels.
namespace busbar::controller::detail {

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
