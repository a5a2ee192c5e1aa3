#include "hash_password.hpp"

#include <cstdio>
#include <iostream>

#include <busbar/core/problem.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/password_rules.hpp>

#include "product/configuration/config.hpp"
#include "product/configuration/sections.hpp"

namespace busbar::product {

int hash_password(const std::string& config_file)
{
    SourceFiles sources;
    const toml::table file = parse_table(read_config_text(config_file, sources), config_file);
    const auto cost = read_password_cost(TomlTable{file, config_file, sources}.table("users"));
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
    const auto hash = crypto::hash_password(password, random, cost);
    if (!hash) {
        return 1;
    }
    std::printf("%s\n", hash->c_str());
    return 0;
}

} // namespace busbar::product
