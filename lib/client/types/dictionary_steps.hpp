#pragma once

#include "type_state.hpp"

namespace busbar::client::detail {

/// True for a concrete structure that has an encoding and no DataTypeDefinition.
[[nodiscard]] bool is_undescribed(const binary::DataTypeEntry& entry);

/// Looks for the definitions of `types`, which the cache has entries of, in the server's type
/// dictionaries, which it reads before the first time. They are then no longer undescribed in the
/// cache, unless an answer is missing, which `done` is told.
Operation learn_from_dictionaries(const std::shared_ptr<TypeCache::State>& cache,
                                  const std::set<NodeId>& types, std::function<void(bool)> done,
                                  const ServiceOptions& options);

} // namespace busbar::client::detail
