#include "support/kept_keys.hpp"

#include <cstdarg>
#include <cstddef>
#include <cstring>
#include <map>
#include <mutex>
#include <vector>

#include <openssl/evp.h>

#include "support/kept_key.hpp"

namespace busbar::test {

namespace {

/// Large ones take seconds to make, and few tests use them.
std::size_t count_of(std::size_t bits)
{
    return bits == 2048 ? 16 : 2;
}

struct Keys {
    std::vector<crypto::PrivateKey> kept;
    std::size_t given{0};
};

/// The next one of this size, with a reference of its own.
EVP_PKEY* next_key(std::size_t bits)
{
    static std::mutex mutex;
    static std::map<std::size_t, Keys> sizes;
    const std::lock_guard lock{mutex};
    Keys& keys = sizes[bits];
    if (keys.kept.size() < count_of(bits)) {
        keys.kept.push_back(kept_key("made", static_cast<std::uint32_t>(bits)));
    }
    EVP_PKEY* const key = keys.kept[keys.given++ % keys.kept.size()].native();
    return EVP_PKEY_up_ref(key) == 1 ? key : nullptr;
}

} // namespace

} // namespace busbar::test

extern "C" {

EVP_PKEY* __real_EVP_PKEY_Q_keygen(OSSL_LIB_CTX* context, const char* properties, const char* type,
                                   ...);

EVP_PKEY* __wrap_EVP_PKEY_Q_keygen(OSSL_LIB_CTX* context, const char* properties, const char* type,
                                   ...)
{
    using namespace busbar::test;
    // What follows depends on the type: the size of a key or the name of a curve.
    std::size_t bits = 0;
    const char* curve = nullptr;
    va_list rest;
    va_start(rest, type);
    if (std::strcmp(type, "RSA") == 0) {
        bits = va_arg(rest, std::size_t);
    } else if (std::strcmp(type, "EC") == 0) {
        curve = va_arg(rest, const char*);
    }
    va_end(rest);
    if (curve != nullptr) {
        return __real_EVP_PKEY_Q_keygen(context, properties, type, curve);
    }
    // PrivateKey makes and reads no others.
    const bool is_kept = bits >= 2048 && bits <= 4096 && !makes_kept_key && RealKeys::lives == 0;
    return is_kept ? next_key(bits) : __real_EVP_PKEY_Q_keygen(context, properties, type, bits);
}

} // extern "C"
