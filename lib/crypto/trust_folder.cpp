#include <busbar/core/text.hpp>
#include <busbar/crypto/certificate_validator.hpp>

#include <openssl/err.h>
#include <openssl/x509_vfy.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

namespace fs = std::filesystem;

using Store = std::unique_ptr<X509_STORE, detail::FreeWith<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, detail::FreeWith<X509_STORE_CTX_free>>;

struct FreeStack {
    void operator()(STACK_OF(X509) * stack) const { sk_X509_free(stack); }
};
using Stack = std::unique_ptr<STACK_OF(X509), FreeStack>;

constexpr std::size_t max_files = 1'000;
constexpr std::uintmax_t max_file_size = 65'536;

std::vector<Certificate> read_folder(const fs::path& folder)
{
    std::vector<Certificate> result;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator{folder, error}) {
        if (!entry.is_regular_file(error) || entry.file_size(error) > max_file_size ||
            result.size() == max_files) {
            continue;
        }
        std::ifstream file{entry.path(), std::ios::binary};
        const std::string contents{std::istreambuf_iterator<char>{file}, {}};
        auto certificate = Certificate::parse_file(std::as_bytes(std::span{contents}));
        if (certificate) {
            result.push_back(*std::move(certificate));
        }
    }
    return result;
}

/// OpenSSL's verdict in the words of Part 4, 6.1.3, table 100.
StatusCode status_of(int error)
{
    switch (error) {
    case X509_V_OK:
        return {};
    case X509_V_ERR_CERT_HAS_EXPIRED:
    case X509_V_ERR_CERT_NOT_YET_VALID:
        return status::Bad_CertificateTimeInvalid;
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
        return status::Bad_CertificateChainIncomplete;
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_CERT_UNTRUSTED:
        return status::Bad_CertificateUntrusted;
    default:
        return status::Bad_CertificateInvalid;
    }
}

/// Any certificate of the trusted folder ends a chain, whether it signed itself or not.
Store make_store(const std::vector<Certificate>& trusted, DateTime now)
{
    Store store{X509_STORE_new()};
    if (!store) {
        return store;
    }
    X509_VERIFY_PARAM* parameters = X509_STORE_get0_param(store.get());
    X509_VERIFY_PARAM_set_flags(parameters, X509_V_FLAG_PARTIAL_CHAIN);
    X509_VERIFY_PARAM_set_depth(parameters, static_cast<int>(max_chain_length));
    X509_VERIFY_PARAM_set_time(parameters, now.unix_seconds());
    for (const Certificate& certificate : trusted) {
        X509_STORE_add_cert(store.get(), certificate.native());
    }
    return store;
}

StatusCode verify(const CertificateChain& chain, const std::vector<Certificate>& trusted,
                  const std::vector<Certificate>& issuers, DateTime now)
{
    const Store store = make_store(trusted, now);
    const StoreContext context{X509_STORE_CTX_new()};
    const Stack untrusted{sk_X509_new_null()};
    if (!store || !context || !untrusted) {
        return status::Bad_OutOfMemory;
    }
    for (std::size_t i = 1; i < chain.size(); ++i) {
        sk_X509_push(untrusted.get(), chain[i].native());
    }
    for (const Certificate& issuer : issuers) {
        sk_X509_push(untrusted.get(), issuer.native());
    }
    if (X509_STORE_CTX_init(context.get(), store.get(), chain.front().native(), untrusted.get()) !=
        1) {
        return status::Bad_OutOfMemory;
    }
    const bool is_good = X509_verify_cert(context.get()) == 1;
    const StatusCode result =
        is_good ? StatusCode{} : status_of(X509_STORE_CTX_get_error(context.get()));
    ERR_clear_error();
    return result;
}

} // namespace

Result<void> TrustFolder::create()
{
    for (const char* name : {"trusted", "issuers", "rejected"}) {
        std::error_code error;
        fs::create_directories(fs::path{folder_} / name, error);
        if (error) {
            return fail(status::Bad_ConfigurationError);
        }
    }
    return {};
}

Result<void> TrustFolder::validate(const CertificateChain& chain, const ValidationContext& context)
{
    const fs::path folder{folder_};
    const StatusCode verdict = verify(chain, read_folder(folder / "trusted"),
                                      read_folder(folder / "issuers"), context.now);
    if (verdict == status::Bad_CertificateUntrusted ||
        verdict == status::Bad_CertificateChainIncomplete) {
        save_rejected(chain.front());
    }
    if (!verdict.is_good()) {
        log_->write(LogLevel::Warning, "certificate",
                    std::string{name(verdict)} + ": " + printable(chain.front().subject()) + " " +
                        chain.front().thumbprint_text());
        return fail(verdict);
    }
    return check_certificate(chain.front(), context);
}

void TrustFolder::save_rejected(const Certificate& leaf)
{
    const fs::path folder = fs::path{folder_} / "rejected";
    const fs::path file = folder / (leaf.thumbprint_text() + ".der");
    std::error_code error;
    const auto count = std::distance(fs::directory_iterator{folder, error}, {});
    if (error || static_cast<std::size_t>(count) >= max_rejected || fs::exists(file, error)) {
        return;
    }
    std::ofstream out{file, std::ios::binary};
    out.write(reinterpret_cast<const char*>(leaf.der().data()),
              static_cast<std::streamsize>(leaf.der().size()));
}

} // namespace busbar::crypto
