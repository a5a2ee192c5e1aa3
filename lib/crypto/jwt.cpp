#include <busbar/crypto/jwt.hpp>

#include <algorithm>
#include <charconv>
#include <optional>

#include <busbar/core/text.hpp>

#include "core/base64.hpp"
#include "core/json.hpp"

namespace busbar::crypto {

namespace {

using busbar::detail::Json;
using Kind = Json::Kind;

// A token is small, and its header is read before the sender has proved anything.
constexpr busbar::detail::JsonLimits json_limits{max_jwt_size, 8, 64, 512, false};

constexpr std::string_view rule_of_form = "RFC 7515, 5.2; Part 6, 6.5.2";
constexpr std::string_view rule_of_key = "RFC 8725, 3.1; Part 6, 6.5.2.3";
constexpr std::string_view rule_of_claims = "RFC 7519, 4.1; Part 6, 6.5.2.3";

Unexpected<Refusal> malformed(std::string found)
{
    return refuse({status::Bad_IdentityTokenInvalid, "JWT structure", std::move(found),
                   rule_of_form,
                   "The client sent something else than its authorization service issues"});
}

Unexpected<Refusal> unsigned_token(std::string found)
{
    return refuse({status::Bad_IdentityTokenRejected, "JWT signature", std::move(found),
                   rule_of_key, "If the authorization service has a new key, configure it"});
}

Unexpected<Refusal> rejected(std::string found, std::string remedy = {})
{
    return refuse({status::Bad_IdentityTokenRejected, "JWT claims", std::move(found),
                   rule_of_claims, std::move(remedy)});
}

/// Base64url without padding (RFC 7515, 2).
std::optional<std::vector<std::byte>> decode_part(std::string_view part)
{
    if (part.find_first_of("+/=") != std::string_view::npos || part.size() % 4 == 1) {
        return std::nullopt;
    }
    std::string text{part};
    std::replace(text.begin(), text.end(), '-', '+');
    std::replace(text.begin(), text.end(), '_', '/');
    text.append((4 - text.size() % 4) % 4, '=');
    return busbar::detail::from_base64(text);
}

std::optional<Json> decode_object(std::string_view part)
{
    const auto bytes = decode_part(part);
    if (!bytes) {
        return std::nullopt;
    }
    auto json = busbar::detail::parse_json(
        {reinterpret_cast<const char*>(bytes->data()), bytes->size()}, json_limits);
    if (!json || json->kind != Kind::Object) {
        return std::nullopt;
    }
    return *std::move(json);
}

/// The three parts of JWS Compact Serialization.
struct Parts {
    std::string_view header;
    std::string_view claims;
    std::string_view signature;
    /// Header and claims with the point between them.
    std::string_view signed_text;
};

std::optional<Parts> split(std::string_view token)
{
    const std::size_t first = token.find('.');
    const std::size_t last = token.rfind('.');
    if (first == std::string_view::npos || first == last ||
        token.find('.', first + 1) != last) { // JWE has five parts
        return std::nullopt;
    }
    return Parts{token.substr(0, first), token.substr(first + 1, last - first - 1),
                 token.substr(last + 1), token.substr(0, last)};
}

/// Returns the member of the object if it is of this kind, else null.
const Json* find(const Json& object, std::string_view name, Kind kind)
{
    const Json* found = object.find(name);
    return found != nullptr && found->kind == kind ? found : nullptr;
}

std::string text_of(const Json& object, std::string_view name)
{
    const Json* text = find(object, name, Kind::String);
    return text != nullptr ? text->text : std::string{};
}

bool is_text(const Json& json)
{
    return json.kind == Kind::String;
}

/// Returns the elements of a list of texts; nothing for any other list.
std::optional<std::vector<std::string>> texts_of(const Json& object, std::string_view name)
{
    const Json* list = find(object, name, Kind::List);
    if (list == nullptr || !std::all_of(list->items.begin(), list->items.end(), is_text)) {
        return std::nullopt;
    }
    std::vector<std::string> texts;
    for (const Json& item : list->items) {
        texts.push_back(item.text);
    }
    return texts;
}

/// Accepts only a token that declares itself an access token, or declares nothing (RFC 8725, 3.11).
bool is_known_type(std::string type)
{
    std::transform(type.begin(), type.end(), type.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return type.empty() || type == "jwt" || type == "at+jwt" || type == "application/at+jwt";
}

/// Checks that one of the keys signed the token with the algorithm of that key.
Checked<void> check_signature(const Parts& parts, const JwtRules& rules)
{
    const auto header = decode_object(parts.header);
    const auto signature = decode_part(parts.signature);
    if (!header || !signature) {
        return malformed("header or signature cannot be read");
    }
    if (header->find("crit") != nullptr || !is_known_type(text_of(*header, "typ"))) {
        return malformed("the header requires an unknown extension or type");
    }
    const std::string algorithm = text_of(*header, "alg");
    const std::string id = text_of(*header, "kid");
    std::size_t tried = 0;
    for (const JwtKey& key : rules.keys) {
        const bool is_named = id.empty() || key.id().empty() || key.id() == id;
        if (!is_named || name(key.algorithm()) != algorithm || ++tried > max_jwt_keys) {
            continue;
        }
        if (key.verify(parts.signed_text, *signature)) {
            return {};
        }
    }
    return unsigned_token(tried == 0
                              ? "no key is configured for algorithm \"" + printable(algorithm, 32) +
                                    "\" and key id \"" + printable(id, 64) + "\""
                              : "it was signed by another key");
}

/// Returns a NumericDate (RFC 7519, 2), whose fraction is ignored; null for another type, a number
/// with an exponent, and a time outside this calendar.
DateTime time_of(const Json& claims, std::string_view name)
{
    constexpr std::int64_t latest = 253'402'300'799; // the end of 9999
    const Json* number = find(claims, name, Kind::Number);
    if (number == nullptr || number->text.find_first_of("eE") != std::string::npos) {
        return {};
    }
    const std::string_view whole = std::string_view{number->text}.substr(0, number->text.find('.'));
    std::int64_t seconds = 0;
    const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
    return error == std::errc{} && seconds > 0 && seconds <= latest
               ? DateTime::from_unix_seconds(seconds)
               : DateTime{};
}

Checked<void> check_times(const Json& claims, const JwtRules& rules, DateTime now)
{
    const auto ticks = [](std::chrono::seconds time) {
        return time.count() * DateTime::ticks_per_second;
    };
    const DateTime expires = time_of(claims, "exp");
    if (expires.is_null()) {
        return rejected("it has no expiry time");
    }
    if (now.ticks >= expires.ticks + ticks(rules.clock_skew)) {
        return rejected("it expired at " + to_string(expires),
                        "If that is wrong, set the clock of this machine");
    }
    if (expires.ticks > now.ticks + ticks(rules.max_lifetime)) {
        return rejected("it is valid until " + to_string(expires) +
                        ", which is longer than allowed");
    }
    for (const std::string_view name : {"nbf", "iat"}) {
        const DateTime begin = time_of(claims, name);
        if (claims.find(name) != nullptr &&
            (begin.is_null() || begin.ticks > now.ticks + ticks(rules.clock_skew))) {
            return rejected("it is not valid before " + to_string(begin) + " on",
                            "If that is wrong, set the clock of this machine");
        }
    }
    return {};
}

bool is_meant_for(const Json& claims, std::string_view audience)
{
    if (const auto list = texts_of(claims, "aud")) {
        return std::find(list->begin(), list->end(), audience) != list->end();
    }
    const Json* one = find(claims, "aud", Kind::String);
    return one != nullptr && one->text == audience;
}

Checked<void> check_claims(const Json& claims, const JwtRules& rules, std::string_view audience,
                           DateTime now)
{
    if (auto times = check_times(claims, rules, now); !times) {
        return times;
    }
    if (text_of(claims, "sub").empty()) {
        return rejected("it names no subject");
    }
    if (const std::string issuer = text_of(claims, "iss");
        issuer != rules.issuer || (claims.find("iss") != nullptr) != !rules.issuer.empty()) {
        return rejected("its issuer is \"" + printable(issuer) + "\" and not \"" + rules.issuer +
                        "\"");
    }
    if (audience.empty() || !is_meant_for(claims, audience)) {
        return rejected("its audience is not \"" + std::string{audience} + "\"",
                        "Register this server with the authorization service");
    }
    const auto roles = texts_of(claims, "roles");
    if (roles && roles->size() > max_jwt_roles) {
        return rejected("it has more than " + std::to_string(max_jwt_roles) + " roles");
    }
    return {};
}

} // namespace

Checked<JwtClaims> verify_jwt(std::string_view token, const JwtRules& rules,
                              std::string_view application_uri, DateTime now)
{
    const auto parts = token.size() <= max_jwt_size ? split(token) : std::nullopt;
    if (!parts) {
        return malformed("it does not have three parts, or has more than " +
                         std::to_string(max_jwt_size) + " bytes");
    }
    if (const auto is_signed = check_signature(*parts, rules); !is_signed) {
        return refuse(is_signed.error());
    }
    const auto claims = decode_object(parts->claims);
    if (!claims) {
        return malformed("its claims are not a JSON object");
    }
    const std::string_view audience = rules.audience.empty() ? application_uri : rules.audience;
    if (const auto checked = check_claims(*claims, rules, audience, now); !checked) {
        return refuse(checked.error());
    }
    JwtClaims result;
    result.subject = text_of(*claims, "sub");
    result.issuer = text_of(*claims, "iss");
    result.name = text_of(*claims, "name");
    result.roles = texts_of(*claims, "roles").value_or(std::vector<std::string>{});
    result.issued_at = time_of(*claims, "iat");
    result.expires = time_of(*claims, "exp");
    return result;
}

} // namespace busbar::crypto
