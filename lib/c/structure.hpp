#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include <busbar/busbar.h>
#include <busbar/core/result.hpp>
#include <busbar/server/image_memory.hpp>
#include <busbar/server/image_structure.hpp>

#include "value.hpp"

namespace busbar::c {

/// Returns a field as a variable of an image. Bad_DataTypeIdUnknown for a type without a form
/// there.
[[nodiscard]] Result<server::ImageVariable> image_variable_of(const busbar_field& field);

} // namespace busbar::c

/// A structure: its form in memory, and an image of one in a program's memory, which converts.
struct busbar_structure {
    std::shared_ptr<const busbar::server::ImageStructure> form;
    busbar::Variant packed;
    busbar::c::Scratch scratch;
};
