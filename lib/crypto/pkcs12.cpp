#include <busbar/crypto/pkcs12.hpp>

#include <openssl/err.h>
#include <openssl/pkcs12.h>

#include <optional>
#include <string>

#include "certificate_order.hpp"
#include "key_derivation.hpp"
#include "openssl.hpp"

namespace busbar::crypto {

namespace {

using File = std::unique_ptr<PKCS12, detail::FreeWith<PKCS12_free>>;
using PrivateKeyInfo =
    std::unique_ptr<PKCS8_PRIV_KEY_INFO, detail::FreeWith<PKCS8_PRIV_KEY_INFO_free>>;

struct FreeSafes {
    void operator()(STACK_OF(PKCS7) * safes) const { sk_PKCS7_pop_free(safes, PKCS7_free); }
};
using Safes = std::unique_ptr<STACK_OF(PKCS7), FreeSafes>;

struct FreeBags {
    void operator()(STACK_OF(PKCS12_SAFEBAG) * bags) const
    {
        sk_PKCS12_SAFEBAG_pop_free(bags, PKCS12_SAFEBAG_free);
    }
};
using Bags = std::unique_ptr<STACK_OF(PKCS12_SAFEBAG), FreeBags>;

constexpr std::size_t max_passphrase_size = 1'024;
constexpr int max_safes = 16;
constexpr int max_bags = 64;

Refusal refusal(std::string found, std::string remedy)
{
    return {status::Bad_ConfigurationError, "reading a PKCS#12 file", std::move(found), "RFC 7292",
            std::move(remedy)};
}

Refusal damaged(const std::string& what)
{
    return refusal(what + " cannot be read", "Export the file again");
}

/// Walks through a file once. Each function refuses, or adds to the findings.
class Reader {
public:
    Reader(std::string_view passphrase, const Pkcs12Limits& limits)
        : passphrase_{passphrase}, iterations_left_{limits.max_iterations}
    {
    }

    Checked<void> read(PKCS12* file);
    Checked<OwnCertificate> result() const;

private:
    /// Returns the passphrase for OpenSSL. A null one and an empty one differ.
    [[nodiscard]] const char* text() const
    {
        return is_null_ ? nullptr : passphrase_.empty() ? "" : passphrase_.text().data();
    }
    [[nodiscard]] int size() const { return static_cast<int>(passphrase_.size()); }

    Checked<void> spend(std::optional<std::uint64_t> iterations);
    Checked<void> check_mac(PKCS12* file);
    Checked<void> read_safe(PKCS7* safe);
    Checked<void> read_bags(const STACK_OF(PKCS12_SAFEBAG) * bags);
    Checked<void> read_bag(const PKCS12_SAFEBAG* bag);
    Checked<void> read_encrypted_key(const PKCS12_SAFEBAG* bag);
    Checked<void> add_key(const PKCS8_PRIV_KEY_INFO* info);
    Checked<void> add_certificate(const PKCS12_SAFEBAG* bag);

    Secret passphrase_;
    bool is_null_{false};
    std::uint64_t iterations_left_;
    int bags_{0};
    std::vector<Certificate> certificates_;
    std::optional<PrivateKey> key_;
};

Checked<void> Reader::spend(std::optional<std::uint64_t> iterations)
{
    if (!iterations) {
        return refuse(
            refusal("its encryption is none that is supported", "Export it with AES and PBKDF2"));
    }
    if (*iterations > iterations_left_) {
        return refuse(refusal("decrypting would take too long: a key derivation with " +
                                  std::to_string(*iterations) + " iterations",
                              "Export it with fewer iterations"));
    }
    iterations_left_ -= *iterations;
    return {};
}

Checked<void> Reader::check_mac(PKCS12* file)
{
    if (PKCS12_mac_present(file) != 1) {
        return {};
    }
    const X509_ALGOR* digest = nullptr;
    const ASN1_INTEGER* count = nullptr;
    PKCS12_get0_mac(nullptr, &digest, nullptr, &count, file);
    std::uint64_t iterations = 1; // RFC 7292, 4: the default
    if (digest == nullptr || EVP_get_digestbyobj(digest->algorithm) == nullptr ||
        (count != nullptr && ASN1_INTEGER_get_uint64(&iterations, count) != 1)) {
        return refuse(damaged("its integrity check"));
    }
    // Twice, since an empty passphrase can be encoded in two ways.
    for (const bool is_null : {passphrase_.empty(), false}) {
        is_null_ = is_null;
        if (auto paid = spend(iterations); !paid) {
            return paid;
        }
        if (PKCS12_verify_mac(file, text(), size()) == 1) {
            return {};
        }
    }
    return refuse(refusal("the passphrase is wrong, or the file is damaged", ""));
}

Checked<void> Reader::read(PKCS12* file)
{
    if (auto checked = check_mac(file); !checked) {
        return checked;
    }
    const Safes safes{PKCS12_unpack_authsafes(file)};
    if (!safes || sk_PKCS7_num(safes.get()) > max_safes) {
        return refuse(damaged("its list of contents"));
    }
    for (int i = 0; i < sk_PKCS7_num(safes.get()); ++i) {
        if (auto read = read_safe(sk_PKCS7_value(safes.get(), i)); !read) {
            return read;
        }
    }
    return {};
}

Checked<void> Reader::read_safe(PKCS7* safe)
{
    if (safe == nullptr || safe->d.ptr == nullptr) {
        return refuse(damaged("a part of it"));
    }
    Bags bags;
    if (PKCS7_type_is_data(safe)) {
        bags.reset(PKCS12_unpack_p7data(safe));
    } else if (PKCS7_type_is_encrypted(safe)) {
        const PKCS7_ENC_CONTENT* content = safe->d.encrypted->enc_data;
        if (content == nullptr || content->algorithm == nullptr || content->enc_data == nullptr) {
            return refuse(damaged("an encrypted part of it"));
        }
        if (auto paid = spend(detail::iterations_of(*content->algorithm)); !paid) {
            return paid;
        }
        bags.reset(PKCS12_unpack_p7encdata(safe, text(), size()));
    }
    if (!bags) {
        return refuse(refusal("a part of it cannot be decrypted: the passphrase is wrong, the file "
                              "is damaged or its encryption is not supported",
                              "Export it with AES and PBKDF2"));
    }
    return read_bags(bags.get());
}

Checked<void> Reader::read_bags(const STACK_OF(PKCS12_SAFEBAG) * bags)
{
    for (int i = 0; i < sk_PKCS12_SAFEBAG_num(bags); ++i) {
        if (++bags_ > max_bags) {
            return refuse(refusal("it has more than " + std::to_string(max_bags) + " entries",
                                  "Export the key, its certificate and the issuers alone"));
        }
        if (auto read = read_bag(sk_PKCS12_SAFEBAG_value(bags, i)); !read) {
            return read;
        }
    }
    return {};
}

Checked<void> Reader::read_bag(const PKCS12_SAFEBAG* bag)
{
    switch (PKCS12_SAFEBAG_get_nid(bag)) {
    case NID_keyBag:
        return add_key(PKCS12_SAFEBAG_get0_p8inf(bag));
    case NID_pkcs8ShroudedKeyBag:
        return read_encrypted_key(bag);
    case NID_certBag:
        return add_certificate(bag);
    default:
        return {}; // revocation lists, secrets, bags of bags
    }
}

Checked<void> Reader::read_encrypted_key(const PKCS12_SAFEBAG* bag)
{
    const X509_SIG* encrypted = PKCS12_SAFEBAG_get0_pkcs8(bag);
    if (encrypted == nullptr) {
        return refuse(damaged("its private key"));
    }
    const X509_ALGOR* algorithm = nullptr;
    X509_SIG_get0(encrypted, &algorithm, nullptr);
    if (auto paid = spend(detail::iterations_of(*algorithm)); !paid) {
        return paid;
    }
    const PrivateKeyInfo info{PKCS12_decrypt_skey(bag, text(), size())};
    return add_key(info.get());
}

Checked<void> Reader::add_key(const PKCS8_PRIV_KEY_INFO* info)
{
    if (key_) {
        return refuse(refusal("it has more than one private key", "Export one alone"));
    }
    unsigned char* der = nullptr;
    const int size = info == nullptr ? -1 : i2d_PKCS8_PRIV_KEY_INFO(info, &der);
    if (size <= 0) {
        return refuse(damaged("its private key"));
    }
    const auto bytes = static_cast<std::size_t>(size);
    auto key = PrivateKey::parse(std::as_bytes(std::span{der, bytes}));
    OPENSSL_clear_free(der, bytes);
    if (!key) {
        return refuse(refusal("its private key is not an RSA key", "Make one with an RSA key"));
    }
    key_ = *std::move(key);
    return {};
}

Checked<void> Reader::add_certificate(const PKCS12_SAFEBAG* bag)
{
    if (PKCS12_SAFEBAG_get_bag_nid(bag) != NID_x509Certificate) {
        return {};
    }
    const detail::X509Pointer x509{PKCS12_SAFEBAG_get1_cert(bag)};
    unsigned char* der = nullptr;
    const int size = x509 ? i2d_X509(x509.get(), &der) : -1;
    const detail::DerPointer owned{der};
    if (size <= 0) {
        return refuse(damaged("a certificate in it"));
    }
    auto certificate =
        Certificate::parse(std::as_bytes(std::span{der, static_cast<std::size_t>(size)}));
    if (!certificate) {
        return refuse(damaged("a certificate in it"));
    }
    certificates_.push_back(*std::move(certificate));
    return {};
}

Checked<OwnCertificate> Reader::result() const
{
    if (!key_) {
        return refuse(refusal("it has no private key", "Export it with its private key"));
    }
    CertificateChain chain = detail::chain_of(*key_, certificates_);
    if (chain.empty()) {
        return refuse(refusal("it has no certificate for its private key",
                              "Export the certificate together with its key"));
    }
    return OwnCertificate{std::move(chain), *key_};
}

Checked<OwnCertificate> read(std::span<const std::byte> contents, std::string_view passphrase,
                             const Pkcs12Limits& limits)
{
    if (contents.size() > limits.max_bytes || passphrase.size() > max_passphrase_size) {
        return refuse(refusal("it, or the passphrase, is too long",
                              "Export the key, its certificate and the issuers alone"));
    }
    const unsigned char* at = detail::bytes_of(contents);
    const File file{d2i_PKCS12(nullptr, &at, static_cast<long>(contents.size()))};
    if (!file || at != detail::bytes_of(contents) + contents.size()) {
        return refuse(refusal("it is not a PKCS#12 file", ""));
    }
    Reader reader{passphrase, limits};
    if (const auto done = reader.read(file.get()); !done) {
        return refuse(done.error());
    }
    return reader.result();
}

} // namespace

Checked<OwnCertificate> read_pkcs12(std::span<const std::byte> contents,
                                    std::string_view passphrase, const Pkcs12Limits& limits)
{
    auto result = read(contents, passphrase, limits);
    ERR_clear_error();
    return result;
}

} // namespace busbar::crypto
