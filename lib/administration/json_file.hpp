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

/// The JSON files of this layer: versioned, readable by people, written as a whole or not at all.
namespace busbar::administration::detail {

using busbar::detail::Json;
using busbar::detail::JsonWriter;

/// Reads a file, which must be an object with "version": `version`; nothing if it does not exist. A
/// problem names the file, what was found and what was expected.
[[nodiscard]] Configured<std::optional<Json>>
read_json_file(Storage& storage, std::string_view file, std::uint32_t version);

/// Makes a problem with a member: "users.json: users[2].name", "found 7, expected a text".
[[nodiscard]] Problem wrong_member(const Storage& storage, std::string_view file,
                                   std::string_view member, const Json* found,
                                   std::string_view expected);

/// Tells whether a text survives being written and read: it must be UTF-8 without NUL. Any other
/// would make the file unreadable, or be changed.
[[nodiscard]] bool is_kept_whole(std::string_view text);

/// Returns a member that is a text; null otherwise.
[[nodiscard]] const std::string* text_of(const Json& object, std::string_view name);
/// Returns a member that is an integer of 32 bits; nothing otherwise.
[[nodiscard]] std::optional<std::uint32_t> number_of(const Json& object, std::string_view name);
/// Returns a member that is true or false; nothing otherwise.
[[nodiscard]] std::optional<bool> flag_of(const Json& object, std::string_view name);
/// Returns a member that is a list; null otherwise.
[[nodiscard]] const Json* list_of(const Json& object, std::string_view name);

} // namespace busbar::administration::detail
