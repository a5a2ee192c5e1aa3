#pragma once

namespace busbar::test {

/// A program that is linked with busbar_kept_keys does not make RSA keys: libcrypto gives it
/// sixteen kept ones of each size (kept_key.hpp) in turn, so that two keys made after each other
/// are two. While one of these lives, keys are made as they are without it. For one thread.
class RealKeys {
public:
    RealKeys() { ++lives; }
    RealKeys(const RealKeys&) = delete;
    RealKeys& operator=(const RealKeys&) = delete;
    ~RealKeys() { --lives; }

    static inline int lives{0};
};

} // namespace busbar::test
