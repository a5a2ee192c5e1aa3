#include "setup.hpp"

#include <string>
#include <utility>

#include "first_account.hpp"
#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

constexpr std::size_t max_code_file = 1'024;
constexpr std::uint8_t all_access = 0xFF;

} // namespace

std::optional<crypto::Secret> Setup::begin(crypto::Random& random, const crypto::PasswordCost& cost)
{
    std::string hash;
    std::optional<crypto::Secret> code;
    const auto bytes = read_file(files_, code_file, max_code_file);
    if (bytes) {
        hash.assign(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    } else if (bytes.error() != StorageError::NotFound && bytes.error() != StorageError::Away) {
        throw ConfigError{files_.place(code_file), std::string{text(bytes.error())}};
    } else {
        code = new_password(random);
        auto made = crypto::hash_password(code->text(), random, cost);
        if (!made || !files_.make_folder("", FileAccess::Everyone) ||
            !files_.replace(code_file, std::as_bytes(std::span{*made}), FileAccess::Owner)) {
            throw ConfigError{files_.place(code_file),
                              "the file cannot be written, expected a folder of this user"};
        }
        hash = *std::move(made);
    }
    if (!users_.set_code(user_name, std::move(hash),
                         {all_access, {"SecurityAdmin", "ConfigureAdmin"}})) {
        throw ConfigError{files_.place(code_file),
                          "found no hash of a code; remove the file to get a new code"};
    }
    is_active_ = true;
    return code;
}

void Setup::end()
{
    if (is_active_) {
        is_active_ = false;
        users_.remove(user_name);
        static_cast<void>(files_.remove(code_file)); // the code is valid only while there is no
                                                     // administrator
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
