#include <busbar/crypto/password_hash.hpp>

#include <array>
#include <charconv>
#include <limits>
#include <vector>

#include <busbar/crypto/secret.hpp>

#include "core/base64.hpp"
#include "openssl.hpp"

namespace busbar::crypto {

namespace {

constexpr std::string_view scrypt_prefix = "$scrypt$";
constexpr std::string_view pbkdf2_prefix = "$pbkdf2-sha256$";
constexpr std::size_t salt_size = 16;
constexpr std::size_t hash_size = 32;

struct PasswordHash {
    PasswordCost cost;
    std::vector<std::byte> salt;
    std::vector<std::byte> hash;
};

bool is_in_range(const PasswordCost& cost)
{
    const auto is_within = [](std::uint32_t number, std::uint32_t least, std::uint32_t most) {
        return number >= least && number <= most;
    };
    return cost.scheme == PasswordScheme::Pbkdf2
               ? is_within(cost.iterations, 1'000, 10'000'000)
               : is_within(cost.log_n, 1, 15) && is_within(cost.r, 1, 8) && is_within(cost.p, 1, 4);
}

bool derive_pbkdf2(std::string_view password, const PasswordHash& with, std::span<std::byte> out)
{
    if (password.size() > std::size_t{std::numeric_limits<int>::max()}) {
        return false;
    }
    return PKCS5_PBKDF2_HMAC(password.data(), static_cast<int>(password.size()),
                             detail::bytes_of(std::span<const std::byte>{with.salt}),
                             static_cast<int>(with.salt.size()),
                             static_cast<int>(with.cost.iterations), EVP_sha256(),
                             static_cast<int>(out.size()), detail::bytes_of(out)) == 1;
}

bool derive_scrypt(std::string_view password, const PasswordHash& with, std::span<std::byte> out)
{
    return EVP_PBE_scrypt(password.data(), password.size(),
                          detail::bytes_of(std::span<const std::byte>{with.salt}), with.salt.size(),
                          std::uint64_t{1} << with.cost.log_n, with.cost.r, with.cost.p,
                          memory_of(with.cost), detail::bytes_of(out), out.size()) == 1;
}

/// Derives a hash with the salt and cost of `with`.
bool derive(std::string_view password, const PasswordHash& with, std::span<std::byte> out)
{
    return with.cost.scheme == PasswordScheme::Pbkdf2 ? derive_pbkdf2(password, with, out)
                                                      : derive_scrypt(password, with, out);
}

/// Removes the text up to the next '$' from the front and returns it.
std::string_view take_part(std::string_view& text)
{
    const std::size_t end = text.find('$');
    const std::string_view part = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return part;
}

bool take_number(std::string_view& text, std::uint32_t& number)
{
    const std::string_view part = take_part(text);
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    return error == std::errc{} && end == part.data() + part.size();
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

bool take_cost(std::string_view& text, PasswordCost& cost)
{
    bool is_complete = false;
    if (text.starts_with(pbkdf2_prefix)) {
        text.remove_prefix(pbkdf2_prefix.size());
        cost.scheme = PasswordScheme::Pbkdf2;
        is_complete = take_number(text, cost.iterations);
    } else if (text.starts_with(scrypt_prefix)) {
        text.remove_prefix(scrypt_prefix.size());
        is_complete =
            take_number(text, cost.log_n) && take_number(text, cost.r) && take_number(text, cost.p);
    }
    return is_complete && is_in_range(cost);
}

std::optional<PasswordHash> parse(std::string_view text)
{
    PasswordHash parsed;
    if (!take_cost(text, parsed.cost) || !take_bytes(text, salt_size, parsed.salt) ||
        text.find('$') != std::string_view::npos || !take_bytes(text, hash_size, parsed.hash)) {
        return std::nullopt;
    }
    return parsed;
}

std::string text_of(const PasswordHash& of)
{
    const PasswordCost& cost = of.cost;
    std::string text{cost.scheme == PasswordScheme::Pbkdf2 ? pbkdf2_prefix : scrypt_prefix};
    text += cost.scheme == PasswordScheme::Pbkdf2
                ? std::to_string(cost.iterations)
                : std::to_string(cost.log_n) + "$" + std::to_string(cost.r) + "$" +
                      std::to_string(cost.p);
    return text + "$" + busbar::detail::to_base64(of.salt) + "$" +
           busbar::detail::to_base64(of.hash);
}

} // namespace

std::uint64_t memory_of(const PasswordCost& cost)
{
    if (!is_in_range(cost)) {
        return 0;
    }
    if (cost.scheme == PasswordScheme::Pbkdf2) {
        return 2'048; // the contexts of HMAC and SHA-256
    }
    // RFC 7914, 5 and 6: V has N blocks and B has p; two more are mixed and written.
    const std::uint64_t block = std::uint64_t{128} * cost.r;
    return block * ((std::uint64_t{1} << cost.log_n) + cost.p + 2);
}

Result<std::string> hash_password(std::string_view password, Random& random,
                                  const PasswordCost& cost)
{
    if (!is_in_range(cost)) {
        return fail(status::Bad_InvalidArgument);
    }
    PasswordHash made{cost, std::vector<std::byte>(salt_size), std::vector<std::byte>(hash_size)};
    if (!random.fill(made.salt) || !derive(password, made, made.hash)) {
        return fail(status::Bad_ResourceUnavailable);
    }
    return text_of(made);
}

bool verify_password(std::string_view password, std::string_view stored)
{
    const auto parsed = parse(stored);
    std::array<std::byte, hash_size> hash{};
    return parsed && derive(password, *parsed, hash) && equal_in_constant_time(hash, parsed->hash);
}

std::optional<PasswordCost> cost_of(std::string_view stored)
{
    const auto parsed = parse(stored);
    return parsed ? std::optional{parsed->cost} : std::nullopt;
}

bool is_password_hash(std::string_view stored)
{
    return cost_of(stored).has_value();
}

} // namespace busbar::crypto
