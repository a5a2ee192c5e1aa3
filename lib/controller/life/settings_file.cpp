#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include <busbar/channel/channel_types.hpp>
#include <busbar/controller/machine_settings.hpp>
#include <busbar/core/text.hpp>
#include <core/json.hpp>
#include <core/json_writer.hpp>

#include "checksum.hpp"

// A file of settings: {"version": 1, "settings": {...}, "checksum": "..."}. The checksum covers the
// settings as they are written here, so that white space does not matter but everything else does.

namespace busbar::controller {

namespace {

using busbar::detail::Json;
using busbar::detail::JsonWriter;

constexpr std::string_view settings_file_version = "1";

template <typename T>
using Maybe = std::optional<T>;

// Writing.

void write_number(JsonWriter& json, std::string_view name, std::uint32_t number)
{
    json.name(name);
    json.word(std::to_string(number));
}

void write_flag(JsonWriter& json, std::string_view name, bool flag)
{
    json.name(name);
    json.word(flag ? "true" : "false");
}

std::string body_of(const ServerSettings& settings)
{
    JsonWriter json;
    json.begin_object();
    write_flag(json, "use", settings.is_used);
    write_number(json, "port", settings.port);
    json.name("execution_log");
    json.begin_object();
    write_flag(json, "record", settings.execution_log.is_recorded);
    write_number(json, "files", settings.execution_log.files);
    write_number(json, "records", settings.execution_log.records);
    json.end_object();
    json.end_object();
    return json.take();
}

std::string body_of(const SecuritySettings& settings)
{
    JsonWriter json;
    json.begin_object();
    write_flag(json, "anonymous", settings.allows_anonymous);
    json.name("allowed");
    json.begin_list();
    for (const MessageSecurity& each : settings.allowed) {
        json.string(text(each));
    }
    json.end_list();
    json.end_object();
    return json.take();
}

std::string sealed(const std::string& body)
{
    JsonWriter json;
    json.begin_object();
    json.name("version");
    json.word(settings_file_version);
    json.name("settings");
    json.word(body);
    json.name("checksum");
    json.string(detail::checksum_text(body));
    json.end_object();
    return json.take() + "\n";
}

// Reading.

Unexpected<Problem> wrong_setting(const std::string& place, std::string_view member,
                                  const Json* found, std::string_view expected)
{
    return misconfigured(place + ": " + std::string{member},
                         "found " + (found != nullptr ? printable(found->describe()) : "nothing") +
                             ", expected " + std::string{expected});
}

bool has_only(const Json& json, std::size_t members)
{
    return json.kind == Json::Kind::Object && json.items.size() == members;
}

Maybe<bool> flag_in(const Json& json, std::string_view name)
{
    const Json* const found = json.find(name);
    if (found == nullptr || (found->kind != Json::Kind::True && found->kind != Json::Kind::False)) {
        return std::nullopt;
    }
    return found->kind == Json::Kind::True;
}

Maybe<std::uint32_t> number_in(const Json& json, std::string_view name)
{
    const Json* const found = json.find(name);
    if (found == nullptr || found->kind != Json::Kind::Number) {
        return std::nullopt;
    }
    const char* const end = found->text.data() + found->text.size();
    std::uint32_t number = 0;
    const auto read = std::from_chars(found->text.data(), end, number);
    return read.ec == std::errc{} && read.ptr == end ? Maybe<std::uint32_t>{number} : std::nullopt;
}

Maybe<MessageSecurity> security_in(const Json& json)
{
    constexpr std::array modes{MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt};
    if (json.kind != Json::Kind::String) {
        return std::nullopt;
    }
    if (json.text == "None") {
        return MessageSecurity{MessageSecurityMode::None, "None"};
    }
    for (const MessageSecurityMode mode : modes) {
        const std::string before = std::string{channel::name(mode)} + " - ";
        if (json.text.starts_with(before)) {
            return MessageSecurity{mode, json.text.substr(before.size())};
        }
    }
    return std::nullopt;
}

/// Nothing if a member is missing, unknown or of another type.
Maybe<ServerSettings> server_settings_in(const Json& json)
{
    const Json* const log = json.find("execution_log");
    if (!has_only(json, 3) || log == nullptr || !has_only(*log, 3)) {
        return std::nullopt;
    }
    const auto use = flag_in(json, "use");
    const auto port = number_in(json, "port");
    const auto record = flag_in(*log, "record");
    const auto files = number_in(*log, "files");
    const auto records = number_in(*log, "records");
    if (!use || !port || !record || !files || !records) {
        return std::nullopt;
    }
    return ServerSettings{*use, *port, {*record, *files, *records}};
}

Maybe<SecuritySettings> security_settings_in(const Json& json)
{
    const Json* const allowed = json.find("allowed");
    const auto anonymous = flag_in(json, "anonymous");
    if (!has_only(json, 2) || allowed == nullptr || allowed->kind != Json::Kind::List ||
        !anonymous) {
        return std::nullopt;
    }
    SecuritySettings settings{*anonymous, {}};
    for (const Json& each : allowed->items) {
        auto security = security_in(each);
        if (!security) {
            return std::nullopt;
        }
        settings.allowed.push_back(*std::move(security));
    }
    return settings;
}

template <typename Settings>
Configured<Settings> read_sealed(std::string_view document, const std::string& place,
                                 Maybe<Settings> (*settings_in)(const Json&))
{
    constexpr std::size_t max_size = 65'536;
    const auto json = busbar::detail::parse_json(
        document, {.max_size = max_size, .max_depth = 8, .allows_nul = false});
    if (!json) {
        return misconfigured(place, printable(json.error()));
    }
    const Json* const version = json->find("version");
    if (version == nullptr || version->kind != Json::Kind::Number ||
        version->text != settings_file_version) {
        return wrong_setting(place, "version", version, settings_file_version);
    }
    const Json* const body = json->find("settings");
    const Json* const sum = json->find("checksum");
    if (!has_only(*json, 3) || body == nullptr || sum == nullptr) {
        return misconfigured(place, "found other members than version, settings and checksum");
    }
    auto settings = settings_in(*body);
    if (!settings) {
        return misconfigured(place + ": settings", "found members missing, of another type or "
                                                   "unknown, expected those that are written");
    }
    const std::string expected = detail::checksum_text(body_of(*settings));
    if (sum->kind != Json::Kind::String || sum->text != expected) {
        return wrong_setting(place, "checksum", sum, expected);
    }
    if (auto checked = check(*settings); !checked) {
        checked.error().where = place + ": " + checked.error().where;
        return Unexpected{std::move(checked.error())};
    }
    return *std::move(settings);
}

} // namespace

std::string document_of(const ServerSettings& settings)
{
    return sealed(body_of(settings));
}

std::string document_of(const SecuritySettings& settings)
{
    return sealed(body_of(settings));
}

Configured<ServerSettings> read_server_settings(std::string_view document, const std::string& place)
{
    return read_sealed<ServerSettings>(document, place, &server_settings_in);
}

Configured<SecuritySettings> read_security_settings(std::string_view document,
                                                    const std::string& place)
{
    return read_sealed<SecuritySettings>(document, place, &security_settings_in);
}

} // namespace busbar::controller
