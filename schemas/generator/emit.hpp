#pragma once

#include <string>

#include "schema.hpp"

/// The texts of the generated files.
namespace busbar::generator {

[[nodiscard]] std::string emit_enumerations(const Schema& schema, const Options& options);
/// The structures of one group and the declarations of their codec.
[[nodiscard]] std::string emit_header(const Schema& schema, const Schema::Group& group,
                                      const Options& options);
/// The codec of one group.
[[nodiscard]] std::string emit_source(const Schema& schema, const Schema::Group& group,
                                      const Options& options);
/// types.hpp: everything.
[[nodiscard]] std::string emit_umbrella(const Schema& schema, const Options& options);
/// fields.hpp: a visitor over the fields of each structure.
[[nodiscard]] std::string emit_fields(const Schema& schema, const Options& options);
[[nodiscard]] std::string emit_registry_header(const Schema& schema, const Options& options);
[[nodiscard]] std::string emit_registry_source(const Schema& schema, const Options& options);
/// ids.hpp: the numeric NodeIds of the namespace as constants.
[[nodiscard]] Expected<std::string, Failure>
emit_ids(const Schema& schema, const nodeset::Document& document, const Options& options);

/// The first lines of every generated file.
[[nodiscard]] std::string preamble(const Schema& schema);
/// "StaticId" contents: {631, {}} or {0, "text"}.
[[nodiscard]] std::string static_id(const NodeId& id);

} // namespace busbar::generator
