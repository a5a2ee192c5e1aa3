#include <busbar/crypto/security_policy.hpp>

#include <algorithm>
#include <array>

namespace busbar::crypto {

namespace {

// Part 7, 6.6: a policy is completely described by one entry.
constexpr std::array policies = {
    SecurityPolicy{.uri = "http://opcfoundation.org/UA/SecurityPolicy#None", .name = "None"},
#ifdef BUSBAR_LEGACY_POLICIES
    SecurityPolicy{.uri = "http://opcfoundation.org/UA/SecurityPolicy#Basic128Rsa15",
                   .name = "Basic128Rsa15",
                   .signature = AsymmetricSignature::Pkcs1Sha1,
                   .encryption = AsymmetricEncryption::Pkcs1,
                   .signature_uri = "http://www.w3.org/2000/09/xmldsig#rsa-sha1",
                   .encryption_uri = "http://www.w3.org/2001/04/xmlenc#rsa-1_5",
                   .min_key_bits = 1024,
                   .max_key_bits = 2048,
                   .digest = SymmetricDigest::Sha1,
                   .symmetric_signature_size = 20,
                   .signing_key_size = 16,
                   .encrypting_key_size = 16,
                   .block_size = 16,
                   .nonce_size = 16,
                   .allows_sha1_certificates = true,
                   .is_deprecated = true},
    SecurityPolicy{.uri = "http://opcfoundation.org/UA/SecurityPolicy#Basic256",
                   .name = "Basic256",
                   .signature = AsymmetricSignature::Pkcs1Sha1,
                   .encryption = AsymmetricEncryption::OaepSha1,
                   .signature_uri = "http://www.w3.org/2000/09/xmldsig#rsa-sha1",
                   .encryption_uri = "http://www.w3.org/2001/04/xmlenc#rsa-oaep",
                   .min_key_bits = 1024,
                   .max_key_bits = 2048,
                   .digest = SymmetricDigest::Sha1,
                   .symmetric_signature_size = 20,
                   .signing_key_size = 24,
                   .encrypting_key_size = 32,
                   .block_size = 16,
                   .nonce_size = 32,
                   .allows_sha1_certificates = true,
                   .is_deprecated = true},
#endif
    SecurityPolicy{.uri = "http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256",
                   .name = "Basic256Sha256",
                   .signature = AsymmetricSignature::Pkcs1Sha256,
                   .encryption = AsymmetricEncryption::OaepSha1,
                   .signature_uri = "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256",
                   .encryption_uri = "http://www.w3.org/2001/04/xmlenc#rsa-oaep",
                   .min_key_bits = 2048,
                   .max_key_bits = 4096,
                   .symmetric_signature_size = 32,
                   .signing_key_size = 32,
                   .encrypting_key_size = 32,
                   .block_size = 16,
                   .nonce_size = 32},
    SecurityPolicy{.uri = "http://opcfoundation.org/UA/SecurityPolicy#Aes128_Sha256_RsaOaep",
                   .name = "Aes128_Sha256_RsaOaep",
                   .signature = AsymmetricSignature::Pkcs1Sha256,
                   .encryption = AsymmetricEncryption::OaepSha1,
                   .signature_uri = "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256",
                   .encryption_uri = "http://www.w3.org/2001/04/xmlenc#rsa-oaep",
                   .min_key_bits = 2048,
                   .max_key_bits = 4096,
                   .symmetric_signature_size = 32,
                   .signing_key_size = 32,
                   .encrypting_key_size = 16,
                   .block_size = 16,
                   .nonce_size = 32},
    SecurityPolicy{.uri = "http://opcfoundation.org/UA/SecurityPolicy#Aes256_Sha256_RsaPss",
                   .name = "Aes256_Sha256_RsaPss",
                   .signature = AsymmetricSignature::PssSha256,
                   .encryption = AsymmetricEncryption::OaepSha256,
                   .signature_uri = "http://opcfoundation.org/UA/security/rsa-pss-sha2-256",
                   .encryption_uri = "http://opcfoundation.org/UA/security/rsa-oaep-sha2-256",
                   .min_key_bits = 2048,
                   .max_key_bits = 4096,
                   .symmetric_signature_size = 32,
                   .signing_key_size = 32,
                   .encrypting_key_size = 32,
                   .block_size = 16,
                   .nonce_size = 32},
};

template <typename Predicate>
const SecurityPolicy* find_if(Predicate predicate)
{
    const auto found = std::find_if(policies.begin(), policies.end(), predicate);
    return found == policies.end() ? nullptr : &*found;
}

} // namespace

std::span<const SecurityPolicy> security_policies()
{
    return policies;
}

const SecurityPolicy* find_policy(std::string_view uri)
{
    return find_if([&](const SecurityPolicy& policy) { return policy.uri == uri; });
}

const SecurityPolicy* find_policy_by_name(std::string_view name)
{
    return find_if([&](const SecurityPolicy& policy) { return policy.name == name; });
}

const SecurityPolicy& policy_none()
{
    return policies.front();
}

} // namespace busbar::crypto
