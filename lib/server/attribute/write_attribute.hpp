#pragma once

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>

#include "write_job.hpp"

namespace busbar::server::detail {

/// Each use of the node searches all of them.
inline constexpr std::size_t max_written_role_permissions = 100;

/// Writes any attribute except the Value of a Variable (Part 4, 5.11.4), of nodes that the user may
/// see: an attribute that UserWriteMask allows is replaced at once.
///
/// Bad_SecurityModeInsufficient, Bad_AttributeIdInvalid if it does not exist, Bad_NotWritable if it
/// is not in the WriteMask, Bad_WriteNotSupported if it is in NodeAccess but the server cannot
/// write it, or for an IndexRange, a status or a timestamp, Bad_UserAccessDenied; then
/// Bad_TypeMismatch, Bad_OutOfRange or Bad_LocaleNotSupported for the value.
[[nodiscard]] StatusCode write_attribute(const WriteContext& context, model::NodeIndex node,
                                         const WriteValue& value);

/// Part 4, 5.11.4.1: a text has no locale, one of the server's, or that of an existing text.
[[nodiscard]] StatusCode check_locale(const WriteContext& context, model::NodeIndex node,
                                      AttributeId attribute, const LocalizedText& text);

} // namespace busbar::server::detail
