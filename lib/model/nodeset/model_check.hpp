#pragma once

#include <vector>

#include <busbar/model/space_reader.hpp>

#include "document.hpp"

namespace busbar::nodeset {

/// Returns the models that a Document requires and that neither it nor the AddressSpace has, or
/// only in an older version (Part 6, F.5).
[[nodiscard]] std::vector<Problem> missing_models(const Document& document,
                                                  const model::SpaceReader& space);

} // namespace busbar::nodeset
