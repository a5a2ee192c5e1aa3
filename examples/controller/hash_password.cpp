#include "hash_password.hpp"

#include <cstdio>
#include <iostream>
#include <string>

#include <busbar/core/problem.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/password_rules.hpp>

namespace busbar::example {

int hash_password()
{
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
    const auto hash = crypto::hash_password(password, random);
    if (!hash) {
        return 1;
    }
    std::printf("%s\n", hash->c_str());
    return 0;
}

} // namespace busbar::example
