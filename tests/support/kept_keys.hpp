#pragma once

namespace busbar::test {

/// A program that is linked with busbar_kept_keys does not make RSA keys: libcrypto gives it
/// kept ones (kept_key.hpp) in turn, sixteen of 2048 bits and two of each larger size, so that two
/// keys made after each other are two. While one of these lives, keys are made as they are without
/// it. For one thread.
class RealKeys {
public:
    RealKeys() { ++lives; }
    RealKeys(const RealKeys&) = delete;
    RealKeys& operator=(const RealKeys&) = delete;
    ~RealKeys() { --lives; }

    static inline int lives{0};
};

} // namespace busbar::test
