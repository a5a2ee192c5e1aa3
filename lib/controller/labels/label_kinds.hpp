#pragma once

#include <optional>
#include <string_view>

#include <busbar/backend/label.hpp>
#include <busbar/controller/program_types.hpp>

/// Which labels a program's types and addresses are.
namespace busbar::controller::detail {

/// None: no label is of this type.
[[nodiscard]] std::optional<backend::LabelType> label_type_of(ElementaryType type);

/// What a structure of label_types() is; none for other types.
[[nodiscard]] std::optional<backend::LabelType> timer_type_of(const DerivedType& type);

/// Whether its elements are units of UTF-16, so that its last dimension is a text.
[[nodiscard]] bool is_utf16_text(const TypeUse& use, const ProgramTypes& types);

/// Whether what lies at an address, as "%FX0" or "U3E0\G10", cannot be sampled in each scan
/// (SH-082679, 8.3: collectible devices). False for an empty one.
[[nodiscard]] BUSBAR_API bool is_unsampled_device(std::string_view address);

} // namespace busbar::controller::detail
