#pragma once

#include <vector>

#include <busbar/model/space_reader.hpp>

#include "document.hpp"

namespace busbar::nodeset {

/// What the models of a Document require and neither the Document nor the AddressSpace has, or has
/// only in an older version (Part 6, F.5).
[[nodiscard]] std::vector<Problem> missing_models(const Document& document,
                                                  const model::SpaceReader& space);

} // namespace busbar::nodeset
