#include "certificate_path.hpp"

#include <algorithm>

#include <openssl/err.h>
#include <openssl/x509_vfy.h>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

using Store = std::unique_ptr<X509_STORE, FreeWith<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, FreeWith<X509_STORE_CTX_free>>;

struct FreeStack {
    void operator()(STACK_OF(X509) * stack) const { sk_X509_free(stack); }
};
using Stack = std::unique_ptr<STACK_OF(X509), FreeStack>;

/// OpenSSL's finding in the words of the table.
StatusCode status_of(int error)
{
    switch (error) {
    case X509_V_OK:
    case X509_V_ERR_CERT_NOT_YET_VALID: // checked in a later step
    case X509_V_ERR_CERT_HAS_EXPIRED:
        return {};
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_CERT_CHAIN_TOO_LONG:
        return status::Bad_CertificateChainIncomplete;
    case X509_V_ERR_INVALID_CA:
    case X509_V_ERR_KEYUSAGE_NO_CERTSIGN:
    case X509_V_ERR_PATH_LENGTH_EXCEEDED:
        return status::Bad_CertificateIssuerUseNotAllowed;
    case X509_V_ERR_OUT_OF_MEM:
        return status::Bad_OutOfMemory;
    default:
        return status::Bad_CertificateInvalid;
    }
}

/// Notes what is wrong and lets OpenSSL go on: its order is not that of the table. An incomplete
/// chain comes before a bad signature, and is always found first.
int note_finding(int is_good, X509_STORE_CTX* context)
{
    if (is_good == 1) {
        return 1;
    }
    auto& path = *static_cast<CertificatePath*>(X509_STORE_CTX_get_app_data(context));
    const StatusCode finding = status_of(X509_STORE_CTX_get_error(context));
    StatusCode& noted =
        finding == status::Bad_CertificateIssuerUseNotAllowed ? path.usage : path.build;
    if (noted.is_good()) {
        noted = finding;
    }
    return 1;
}

bool is_root(const Certificate& certificate)
{
    return X509_self_signed(certificate.native(), 0) == 1;
}

/// Every root in `roots` ends a chain; whether one is trusted is asked afterwards.
Store make_store(const std::vector<Certificate>& roots, DateTime now)
{
    Store store{X509_STORE_new()};
    if (!store) {
        return store;
    }
    X509_VERIFY_PARAM* parameters = X509_STORE_get0_param(store.get());
    X509_VERIFY_PARAM_set_flags(parameters, X509_V_FLAG_CHECK_SS_SIGNATURE);
    X509_VERIFY_PARAM_set_time(parameters, now.unix_seconds());
    // OpenSSL counts the certificates between leaf and root.
    X509_VERIFY_PARAM_set_depth(parameters, static_cast<int>(max_chain_length) - 2);
    for (const Certificate& certificate : roots) {
        if (is_root(certificate)) {
            X509_STORE_add_cert(store.get(), certificate.native());
        }
    }
    return store;
}

Stack make_stack(const std::vector<Certificate>& pool)
{
    Stack stack{sk_X509_new_null()};
    for (const Certificate& certificate : pool) {
        if (stack && !is_root(certificate)) {
            sk_X509_push(stack.get(), certificate.native());
        }
    }
    return stack;
}

/// OpenSSL takes a root of version 1 and a CA without BasicConstraints; Part 6, 6.2.4 does not.
StatusCode check_issuers(const CertificateChain& path)
{
    const bool all_may_issue =
        std::all_of(path.begin() + 1, path.end(),
                    [](const Certificate& issuer) { return X509_check_ca(issuer.native()) == 1; });
    return all_may_issue ? StatusCode{} : status::Bad_CertificateIssuerUseNotAllowed;
}

void keep_certificates(const STACK_OF(X509) * found, const std::vector<Certificate>& pool,
                       CertificatePath& path)
{
    for (int i = 0; i < sk_X509_num(found); ++i) {
        const X509* native = sk_X509_value(found, i);
        const auto known = std::find_if(pool.begin(), pool.end(),
                                        [&](const auto& c) { return c.native() == native; });
        if (known != pool.end()) {
            path.certificates.push_back(*known);
        }
    }
}

CertificatePath build_path(const Certificate& leaf, const std::vector<Certificate>& roots,
                           const std::vector<Certificate>& pool, DateTime now)
{
    CertificatePath path;
    const Store store = make_store(roots, now);
    const Stack others = make_stack(pool);
    const StoreContext context{X509_STORE_CTX_new()};
    if (!store || !others || !context ||
        X509_STORE_CTX_init(context.get(), store.get(), leaf.native(), others.get()) != 1) {
        path.build = status::Bad_OutOfMemory;
        return path;
    }
    X509_STORE_CTX_set_app_data(context.get(), &path);
    X509_STORE_CTX_set_verify_cb(context.get(), note_finding);
    // Findings do not end the search, so that only a failure of OpenSSL itself is not 1.
    if (X509_verify_cert(context.get()) != 1 && path.build.is_good()) {
        path.build = status::Bad_CertificateInvalid;
    }
    keep_certificates(X509_STORE_CTX_get0_chain(context.get()), pool, path);
    if (path.certificates.empty() && path.build.is_good()) {
        path.build = status::Bad_CertificateInvalid;
    }
    if (path.usage.is_good() && path.certificates.size() > 1) {
        path.usage = check_issuers(path.certificates);
    }
    ERR_clear_error();
    return path;
}

} // namespace

CertificatePath find_path(const CertificateChain& sent, const std::vector<Certificate>& known,
                          DateTime now)
{
    const Certificate& leaf = sent.front();
    if (is_root(leaf)) { // a path by itself, whoever else has its name and key
        return build_path(leaf, {leaf}, {leaf}, now);
    }
    std::vector<Certificate> pool{known};
    pool.insert(pool.end(), sent.begin(), sent.end());
    CertificatePath path = build_path(leaf, known, pool, now);
    // With the roots that the peer sent there may be a chain, which is trusted only if a
    // certificate below them is.
    return path.build.is_good() ? path : build_path(leaf, pool, pool, now);
}

} // namespace busbar::crypto::detail
