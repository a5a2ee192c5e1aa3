#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>
#include <core/json.hpp>
#include <core/json_writer.hpp>

/// Files of this layer: JSON with a version, readable by people, whole or not at all.
namespace busbar::administration::detail {

using busbar::detail::Json;
using busbar::detail::JsonWriter;

/// What the file has, an object with "version": `version`; nothing if there is no file. The problem
/// names the place of the file, what was found and what was expected.
[[nodiscard]] Configured<std::optional<Json>>
read_json_file(Storage& storage, std::string_view file, std::uint32_t version);

/// A problem with a member: "users.json: users[2].name", "found 7, expected a text".
[[nodiscard]] Problem wrong_member(const Storage& storage, std::string_view file,
                                   std::string_view member, const Json* found,
                                   std::string_view expected);

/// Whether a text is the same when it was written and is read again: it is UTF-8 without NUL. A
/// file with any other could not be read, or would have another text.
[[nodiscard]] bool is_kept_whole(std::string_view text);

/// A member that is a text; null if it is none.
[[nodiscard]] const std::string* text_of(const Json& object, std::string_view name);
/// A member that is a whole number of 32 bits.
[[nodiscard]] std::optional<std::uint32_t> number_of(const Json& object, std::string_view name);
/// A member that is true or false.
[[nodiscard]] std::optional<bool> flag_of(const Json& object, std::string_view name);
/// A member that is a list; null if it is none.
[[nodiscard]] const Json* list_of(const Json& object, std::string_view name);

} // namespace busbar::administration::detail
