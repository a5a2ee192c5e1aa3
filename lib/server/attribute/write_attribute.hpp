#pragma once

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>

#include "write_job.hpp"

namespace busbar::server::detail {

/// More would be looked through at every use of the node.
inline constexpr std::size_t max_written_role_permissions = 100;

/// Write of any attribute but the Value of a Variable (Part 4, 5.11.4), for nodes that the user may
/// see: what UserWriteMask allows is replaced at once.
///
/// Bad_SecurityModeInsufficient, Bad_AttributeIdInvalid if it is not there, Bad_NotWritable if the
/// WriteMask has it not, Bad_WriteNotSupported if the server cannot though NodeAccess has it, or
/// for an IndexRange, a status or a timestamp, Bad_UserAccessDenied; then Bad_TypeMismatch,
/// Bad_OutOfRange or Bad_LocaleNotSupported for the value.
[[nodiscard]] StatusCode write_attribute(const WriteContext& context, model::NodeIndex node,
                                         const WriteValue& value);

/// Part 4, 5.11.4.1: a text has no locale or one of the server's, or that of the text there is.
[[nodiscard]] StatusCode check_locale(const WriteContext& context, model::NodeIndex node,
                                      AttributeId attribute, const LocalizedText& text);

} // namespace busbar::server::detail
