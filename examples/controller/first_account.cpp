#include "first_account.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <busbar/crypto/file.hpp>
#include <busbar/crypto/password_hash.hpp>

namespace busbar::example {

namespace {

namespace fs = std::filesystem;

/// 32 characters that are not mistaken for each other.
constexpr std::string_view alphabet = "abcdefghjkmnpqrstuvwxyz023456789";
static_assert(alphabet.size() == 32);
constexpr std::size_t group = 5;
constexpr std::size_t groups = 4; // 100 bits
constexpr std::size_t max_file_size = 1'024;

std::string file_in(const std::string& folder)
{
    return (fs::path{folder} / "operator.password").string();
}

Account account_with(std::string hash)
{
    return {"operator", std::move(hash), Access::Write, {"Operator"}};
}

/// As "xxxxx-xxxxx-xxxxx-xxxxx".
crypto::Secret new_password(crypto::Random& random)
{
    crypto::Secret numbers{group * groups};
    if (!random.fill(numbers.span())) {
        throw ConfigError{"the first password", "there are no random numbers for it"};
    }
    crypto::Secret password{numbers.size() + groups - 1};
    std::size_t at = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (i != 0 && i % group == 0) {
            password.span()[at++] = std::byte{'-'};
        }
        const auto index = static_cast<std::size_t>(numbers.span()[i]) % alphabet.size();
        password.span()[at++] = static_cast<std::byte>(alphabet[index]);
    }
    return password;
}

} // namespace

std::optional<FirstAccount> load_first_account(const std::string& folder)
{
    const std::string path = file_in(folder);
    if (std::error_code ignored; !fs::exists(path, ignored)) {
        return std::nullopt;
    }
    std::ifstream file{path, std::ios::binary};
    std::array<char, max_file_size> text{};
    file.read(text.data(), text.size());
    std::string hash{text.data(), static_cast<std::size_t>(file.gcount())};
    if (hash.ends_with('\n')) {
        hash.pop_back();
    }
    if (!crypto::is_password_hash(hash)) {
        throw ConfigError{path, "found no hash of a password, expected the output of "
                                "--hash-password; remove the file to get a new password"};
    }
    return FirstAccount{account_with(std::move(hash)), std::nullopt};
}

FirstAccount make_first_account(const std::string& folder, crypto::Random& random)
{
    crypto::Secret password = new_password(random);
    auto hash = crypto::hash_password(password.text(), random);
    if (!hash) {
        throw ConfigError{Problem{hash.error(), "the first password", "cannot be hashed"}};
    }
    const std::string path = file_in(folder);
    std::error_code error;
    fs::create_directories(folder, error);
    const std::string line = *hash + "\n";
    if (!crypto::save_file(path, std::as_bytes(std::span{line}), crypto::FileAccess::Owner)) {
        throw ConfigError{path, "the file cannot be written, expected a folder of this user"};
    }
    return {account_with(*std::move(hash)), std::move(password)};
}

} // namespace busbar::example
