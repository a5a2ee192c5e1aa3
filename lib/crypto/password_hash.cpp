#include <busbar/crypto/password_hash.hpp>

#include <array>
#include <charconv>
#include <optional>
#include <vector>

#include <busbar/crypto/secret.hpp>

#include "core/base64.hpp"
#include "openssl.hpp"

namespace busbar::crypto {

namespace {

constexpr std::string_view prefix = "$scrypt$";
constexpr std::size_t salt_size = 16;
constexpr std::size_t hash_size = 32;
constexpr std::uint64_t max_memory = 64U << 20U;

struct Parameters {
    std::uint32_t log_n{14};
    std::uint32_t r{8};
    std::uint32_t p{1};
    std::vector<std::byte> salt;
    std::vector<std::byte> hash;
};

bool derive(std::string_view password, const Parameters& parameters, std::span<std::byte> out)
{
    return EVP_PBE_scrypt(password.data(), password.size(),
                          detail::bytes_of(std::span<const std::byte>{parameters.salt}),
                          parameters.salt.size(), std::uint64_t{1} << parameters.log_n,
                          parameters.r, parameters.p, max_memory, detail::bytes_of(out),
                          out.size()) == 1;
}

/// Cuts the text up to the next '$' off the front.
std::string_view take_part(std::string_view& text)
{
    const std::size_t end = text.find('$');
    const std::string_view part = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return part;
}

bool take_number(std::string_view& text, std::uint32_t max, std::uint32_t& number)
{
    const std::string_view part = take_part(text);
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    return error == std::errc{} && end == part.data() + part.size() && number >= 1 && number <= max;
}

bool take_bytes(std::string_view& text, std::size_t size, std::vector<std::byte>& bytes)
{
    auto decoded = busbar::detail::from_base64(take_part(text));
    if (!decoded || decoded->size() != size) {
        return false;
    }
    bytes = *std::move(decoded);
    return true;
}

std::optional<Parameters> parse(std::string_view stored)
{
    Parameters parameters;
    if (stored.substr(0, prefix.size()) != prefix) {
        return std::nullopt;
    }
    stored.remove_prefix(prefix.size());
    if (!take_number(stored, 15, parameters.log_n) || !take_number(stored, 8, parameters.r) ||
        !take_number(stored, 4, parameters.p) || !take_bytes(stored, salt_size, parameters.salt) ||
        stored.find('$') != std::string_view::npos ||
        !take_bytes(stored, hash_size, parameters.hash)) {
        return std::nullopt;
    }
    return parameters;
}

} // namespace

Result<std::string> hash_password(std::string_view password, Random& random)
{
    Parameters parameters;
    parameters.salt.resize(salt_size);
    parameters.hash.resize(hash_size);
    if (!random.fill(parameters.salt) || !derive(password, parameters, parameters.hash)) {
        return fail(status::Bad_ResourceUnavailable);
    }
    return std::string{prefix} + std::to_string(parameters.log_n) + "$" +
           std::to_string(parameters.r) + "$" + std::to_string(parameters.p) + "$" +
           busbar::detail::to_base64(parameters.salt) + "$" +
           busbar::detail::to_base64(parameters.hash);
}

bool verify_password(std::string_view password, std::string_view stored)
{
    const auto parameters = parse(stored);
    std::array<std::byte, hash_size> hash{};
    return parameters && derive(password, *parameters, hash) &&
           equal_in_constant_time(hash, parameters->hash);
}

bool is_password_hash(std::string_view stored)
{
    return parse(stored).has_value();
}

} // namespace busbar::crypto
