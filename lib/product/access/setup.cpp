#include "setup.hpp"

#include <span>
#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "first_account.hpp"
#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

constexpr std::size_t max_code_file = 1'024;
constexpr std::uint8_t all_access = 0xFF;

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

} // namespace busbar::product
