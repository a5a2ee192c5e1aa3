#include "first_account.hpp"

#include <busbar/storage/folder_storage.hpp>

namespace busbar::product {

namespace {

/// 32 characters that are not easily confused.
constexpr std::string_view alphabet = "abcdefghjkmnpqrstuvwxyz023456789";
static_assert(alphabet.size() == 32);
constexpr std::size_t group = 5;
constexpr std::size_t groups = 4; // 100 bits
constexpr std::size_t max_file_size = 1'024;

constexpr std::string_view file_name = "operator.password";

Account account_with(std::string hash)
{
    return {"operator", std::move(hash), AccountAccess::Write, {"Operator"}};
}

} // namespace

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

std::optional<FirstAccount> load_first_account(const std::string& folder)
{
    storage::FolderStorage files{folder};
    const std::string path = files.place(file_name);
    const auto bytes = read_file(files, file_name, max_file_size);
    if (!bytes) {
        if (bytes.error() == StorageError::NotFound || bytes.error() == StorageError::Away) {
            return std::nullopt;
        }
        throw ConfigError{path, std::string{text(bytes.error())}};
    }
    std::string hash{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    if (hash.ends_with('\n')) {
        hash.pop_back();
    }
    if (!crypto::is_password_hash(hash)) {
        throw ConfigError{path, "found no hash of a password, expected the output of "
                                "--hash-password; remove the file to get a new password"};
    }
    return FirstAccount{account_with(std::move(hash)), std::nullopt};
}

FirstAccount make_first_account(const std::string& folder, crypto::Random& random,
                                const crypto::PasswordCost& cost)
{
    crypto::Secret password = new_password(random);
    auto hash = crypto::hash_password(password.text(), random, cost);
    if (!hash) {
        throw ConfigError{Problem{hash.error(), "the first password", "cannot be hashed"}};
    }
    storage::FolderStorage files{folder};
    const std::string line = *hash + "\n";
    if (!files.make_folder("", FileAccess::Everyone) ||
        !files.replace(file_name, std::as_bytes(std::span{line}), FileAccess::Owner)) {
        throw ConfigError{files.place(file_name),
                          "the file cannot be written, expected a folder of this user"};
    }
    return {account_with(*std::move(hash)), std::move(password)};
}

} // namespace busbar::product
