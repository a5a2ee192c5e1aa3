#pragma once

#include <busbar/core/expected.hpp>

#include <model/nodeset/document.hpp>

#include "options.hpp"

namespace busbar::generator {

/// Writes definitions.hpp and definitions.cpp with `busbar::binary::namespace0_definitions()`: what
/// the DataType nodes of namespace 0 say, in OPC UA Binary: their number (Int32), then of each its
/// NodeId, the name of its BrowseName, its supertype, the NodeId of "Default Binary", IsAbstract
/// and a Variant with the DataTypeDefinition.
[[nodiscard]] Expected<void, Failure> emit_definitions(const nodeset::Document& document,
                                                       const Options& options);

} // namespace busbar::generator
