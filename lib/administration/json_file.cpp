#include "json_file.hpp"

#include <charconv>

#include <busbar/core/text.hpp>
#include <core/utf8.hpp>

namespace busbar::administration::detail {

namespace {

constexpr std::size_t max_file_size = 4U << 20U;

} // namespace

Problem wrong_member(const Storage& storage, std::string_view file, std::string_view member,
                     const Json* found, std::string_view expected)
{
    return {status::Bad_ConfigurationError, storage.place(file) + ": " + std::string{member},
            "found " + (found != nullptr ? printable(found->describe()) : "nothing") +
                ", expected " + std::string{expected}};
}

Configured<std::optional<Json>> read_json_file(Storage& storage, std::string_view file,
                                               std::uint32_t version)
{
    const auto bytes = read_file(storage, file, max_file_size);
    if (!bytes) {
        if (bytes.error() == StorageError::NotFound || bytes.error() == StorageError::Away) {
            return std::nullopt;
        }
        return misconfigured(storage.place(file), std::string{text(bytes.error())},
                             status_of(bytes.error()));
    }
    auto json = busbar::detail::parse_json(
        {reinterpret_cast<const char*>(bytes->data()), bytes->size()}, {.allows_nul = false});
    if (!json) {
        return misconfigured(storage.place(file), printable(json.error()));
    }
    if (json->kind != Json::Kind::Object) {
        return Unexpected{wrong_member(storage, file, "the file", &*json, "an object")};
    }
    const auto found = number_of(*json, "version");
    if (found != version) {
        return Unexpected{
            wrong_member(storage, file, "version", json->find("version"), std::to_string(version))};
    }
    return std::optional{*std::move(json)};
}

bool is_kept_whole(std::string_view text)
{
    while (!text.empty()) {
        // Allow control characters of two bytes, which do harm on a terminal but not in a file.
        const bool is_control = text.size() > 1 && text[0] == '\xC2' &&
                                (static_cast<unsigned char>(text[1]) & 0xE0U) == 0x80U;
        const std::size_t size = is_control ? 2 : busbar::detail::utf8_sequence(text);
        if (size == 0 || text.front() == '\0') {
            return false;
        }
        text.remove_prefix(size);
    }
    return true;
}

const std::string* text_of(const Json& object, std::string_view name)
{
    const Json* const member = object.find(name);
    return member != nullptr && member->kind == Json::Kind::String ? &member->text : nullptr;
}

std::optional<std::uint32_t> number_of(const Json& object, std::string_view name)
{
    const Json* const member = object.find(name);
    if (member == nullptr || member->kind != Json::Kind::Number) {
        return std::nullopt;
    }
    const char* const end = member->text.data() + member->text.size();
    std::uint32_t number = 0;
    const auto read = std::from_chars(member->text.data(), end, number);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{number} : std::nullopt;
}

std::optional<bool> flag_of(const Json& object, std::string_view name)
{
    const Json* const member = object.find(name);
    if (member == nullptr ||
        (member->kind != Json::Kind::True && member->kind != Json::Kind::False)) {
        return std::nullopt;
    }
    return member->kind == Json::Kind::True;
}

const Json* list_of(const Json& object, std::string_view name)
{
    const Json* const member = object.find(name);
    return member != nullptr && member->kind == Json::Kind::List ? member : nullptr;
}

} // namespace busbar::administration::detail
