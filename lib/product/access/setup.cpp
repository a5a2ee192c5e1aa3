#include "setup.hpp"

#include <cstdio>
#include <iostream>
#include <span>
#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/password_rules.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/config.hpp"
#include "product/configuration/sections.hpp"
#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

constexpr std::size_t max_code_file = 1'024;
constexpr std::uint8_t all_access = 0xFF;

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

Setup::~Setup()
{
    if (takes_code_back_) { // the start failed after begin(): the next one makes another code
        busbar::detail::attempt([&] { static_cast<void>(files_.remove(code_file)); });
    }
}

std::optional<std::string> Setup::kept_hash() const
{
    const auto bytes = read_file(files_, code_file, max_code_file);
    if (bytes) {
        return std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    }
    if (bytes.error() != StorageError::NotFound && bytes.error() != StorageError::Away) {
        throw ConfigError{files_.place(code_file), std::string{text(bytes.error())}};
    }
    return std::nullopt;
}

std::optional<crypto::Secret> Setup::begin(crypto::Random& random, const crypto::PasswordCost& cost)
{
    std::optional<crypto::Secret> code;
    std::optional<std::string> hash = kept_hash();
    if (!hash) {
        code = new_password(random);
        auto made = crypto::hash_password(code->text(), random, cost);
        if (!made) {
            throw ConfigError{files_.place(code_file), "the code cannot be hashed"};
        }
        hash = *std::move(made);
    }
    server::PasswordUsers::Change change;
    if (!change.set_code(user_name, *hash, {all_access, {"SecurityAdmin", "ConfigureAdmin"}})) {
        throw ConfigError{files_.place(code_file),
                          "found no hash of a code; remove the file to get a new code"};
    }
    // The file comes last: once it is there, nothing may fail, since the code would not be known.
    if (code && (!files_.make_folder("", FileAccess::Everyone) ||
                 !files_.replace(code_file, std::as_bytes(std::span{*hash}), FileAccess::Owner))) {
        throw ConfigError{files_.place(code_file),
                          "the file cannot be written, expected a folder of this user"};
    }
    users_.apply(std::move(change));
    is_active_ = true;
    has_code_ = true;
    takes_code_back_ = code.has_value();
    return code;
}

void Setup::end()
{
    if (is_active_) {
        users_.remove(user_name);
        is_active_ = false;
    }
    if (has_code_) { // it is valid only while there is no administrator
        static_cast<void>(files_.remove(code_file));
        has_code_ = false;
        takes_code_back_ = false;
    }
}

Checked<void> Setup::validate(const crypto::CertificateChain& chain,
                              const crypto::ValidationContext& context)
{
    auto valid = inner_.validate(chain, context);
    const bool is_stranger =
        !valid && (valid.error().status == status::Bad_CertificateUntrusted ||
                   valid.error().status == status::Bad_CertificateChainIncomplete);
    // Only trust is waived: the checks after it still apply (Part 4, 6.1.3, Table 100).
    return is_active_ && is_stranger ? crypto::check_certificate(chain.front(), context) : valid;
}

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

int hash_password(const std::string& config_file)
{
    SourceFiles sources;
    const toml::table file = parse_table(read_config_text(config_file, sources), config_file);
    const auto cost = read_password_cost(TomlTable{file, config_file, sources}.table("users"));
    std::string password;
    if (!std::getline(std::cin, password) || password.empty()) {
        std::fprintf(stderr, "expected a password on standard input\n");
        return 1;
    }
    const auto allowed = server::check_password({}, {}, password);
    if (!allowed) {
        std::fprintf(stderr, "%s\n", text(allowed.error()).c_str());
        return 1;
    }
    crypto::SystemRandom random;
    const auto hash = crypto::hash_password(password, random, cost);
    if (!hash) {
        return 1;
    }
    std::printf("%s\n", hash->c_str());
    return 0;
}

} // namespace busbar::product
