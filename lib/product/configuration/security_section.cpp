#include "sections.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <utility>

#include "limit_keys.hpp"

namespace busbar::product {

namespace {

constexpr std::int64_t least_iterations = 10'000;
constexpr std::int64_t most_iterations = 10'000'000;

/// Reads "read" or "write"; `otherwise` if the key is missing.
AccountAccess read_access(const TomlTable& table, std::string_view key, std::string otherwise)
{
    const std::string text = table.text(key, std::move(otherwise));
    if (text != "read" && text != "write") {
        table.fail(key, "\"read\" or \"write\"");
    }
    return text == "write" ? AccountAccess::Write : AccountAccess::Read;
}

/// Reads the same, or "no".
std::optional<AccountAccess> read_optional_access(const TomlTable& table, std::string_view key)
{
    const std::string text = table.text(key, "no");
    if (text == "no") {
        return std::nullopt;
    }
    if (text != "read" && text != "write") {
        table.fail(key, "\"no\", \"read\" or \"write\"");
    }
    return text == "write" ? AccountAccess::Write : AccountAccess::Read;
}

crypto::StoreLimits read_store_limits(const TomlTable& table)
{
    const std::string preset = table.text("limits", "default");
    if (preset == "nj501") {
        return crypto::nj501_store_limits();
    }
    if (preset == "nx102") {
        return crypto::nx102_store_limits();
    }
    if (preset == "rd81opc96") {
        return crypto::rd81opc96_store_limits();
    }
    if (preset != "default") {
        table.fail("limits", "default, nj501, nx102 or rd81opc96");
    }
    return {};
}

crypto::ValidationSettings read_suppressed(const TomlTable& table)
{
    using Settings = crypto::ValidationSettings;
    static constexpr std::array<std::pair<std::string_view, bool Settings::*>, 7> steps = {{
        {"security policy check", &Settings::suppress_security_policy_check},
        {"validity period", &Settings::suppress_validity_period},
        {"issuer validity period", &Settings::suppress_issuer_validity_period},
        {"host name", &Settings::suppress_host_name},
        {"certificate usage", &Settings::suppress_certificate_usage},
        {"find revocation list", &Settings::suppress_find_revocation_list},
        {"find issuer revocation list", &Settings::suppress_find_issuer_revocation_list},
    }};
    Settings settings;
    for (const std::string& name : table.texts("suppress")) {
        const auto* const step = std::find_if(
            steps.begin(), steps.end(), [&](const auto& known) { return known.first == name; });
        if (step == steps.end()) {
            std::string names;
            for (const auto& known : steps) {
                names += (names.empty() ? "" : ", ") + std::string{known.first};
            }
            table.fail("suppress", "some of: " + names);
        }
        settings.*(step->second) = true;
    }
    return settings;
}

void read_subject(const TomlTable& table, SubjectNames& subject)
{
    for (const SubjectKey& key : subject_keys) {
        std::string& name = subject.*key.member;
        name = table.text(key.name, name);
        if (name.size() > key.longest) {
            table.fail(key.name, "at most " + std::to_string(key.longest) + " bytes");
        }
    }
    if (!subject.country.empty() && subject.country.size() != 2) {
        table.fail("country", "two letters, or \"\"");
    }
}

constexpr std::array roles{std::string_view{"Observer"},       std::string_view{"Operator"},
                           std::string_view{"Engineer"},       std::string_view{"Supervisor"},
                           std::string_view{"ConfigureAdmin"}, std::string_view{"SecurityAdmin"}};

Account read_account(const TomlTable& table)
{
    table.allow({"name", "password", "access", "roles"});
    Account account;
    account.name = table.text("name");
    if (account.name.empty()) {
        table.fail("name", "a name");
    }
    account.password_hash = table.text("password");
    if (!crypto::is_password_hash(account.password_hash)) {
        // Do not show the value: it may be the password itself.
        table.refuse("password", "found no hash, expected the output of --hash-password");
    }
    account.access = read_access(table, "access", "write");
    account.roles = read_roles(table, "roles",
                               {account.access == AccountAccess::Write ? "Operator" : "Observer"});
    return account;
}

std::string read_whole_file(const TomlTable& table, std::string_view key)
{
    const std::string path = table.text(key);
    std::ifstream file{path, std::ios::binary};
    std::string text{std::istreambuf_iterator<char>{file}, {}};
    if (!file || text.empty()) {
        table.fail(key, "a file that can be read");
    }
    return text;
}

/// Reads [users.tokens].
TokenConfig read_tokens(const TomlTable& table)
{
    table.allow({"issuer", "algorithm", "key_file", "audience", "role"});
    TokenConfig tokens;
    tokens.rules.issuer = table.text("issuer");
    tokens.rules.audience = table.text("audience", "");
    const std::string algorithm = table.text("algorithm", "RS256");
    const std::string pem = read_whole_file(table, "key_file");
    for (const auto known :
         {crypto::JwtAlgorithm::RS256, crypto::JwtAlgorithm::PS256, crypto::JwtAlgorithm::ES256}) {
        if (algorithm == name(known)) {
            auto key = crypto::JwtKey::from_public_key(known, std::as_bytes(std::span{pem}));
            if (!key) {
                table.fail("key_file", "a public key for " + algorithm + " as PEM");
            }
            tokens.rules.keys.push_back(*std::move(key));
        }
    }
    if (tokens.rules.keys.empty()) {
        table.fail("algorithm", "RS256, PS256 or ES256");
    }
    for (const TomlTable& entry : table.tables("role")) {
        entry.allow({"name", "access"});
        tokens.roles.emplace_back(entry.text("name"), read_access(entry, "access", "read"));
    }
    return tokens;
}

} // namespace

std::vector<std::string> read_roles(const TomlTable& table, std::string_view key,
                                    std::vector<std::string> otherwise)
{
    if (!table.has(key)) {
        return otherwise;
    }
    std::vector<std::string> given = table.texts(key);
    const auto unknown = std::find_if(given.begin(), given.end(), [](const std::string& role) {
        return std::find(roles.begin(), roles.end(), role) == roles.end();
    });
    if (unknown != given.end()) {
        std::string names;
        for (const std::string_view known : roles) {
            names += names.empty() ? "" : ", ";
            names += known;
        }
        table.refuse(key, "found \"" + *unknown + "\", expected some of: " + names);
    }
    return given;
}

void read_certificates(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"folder", "trust_all_clients", "key_bits", "valid_days", "limits", "suppress",
                 "common_name", "organization", "locality", "state", "country",
                 "organizational_unit"});
    CertificateConfig& certificates = config.certificates;
    certificates.folder = table.text("folder", certificates.folder);
    certificates.trusts_all_clients = table.flag("trust_all_clients", false);
    read_numbers(table, "certificates", config);
    read_subject(table, certificates.subject);
    if (table.has("limits")) {
        certificates.limits = read_store_limits(table);
    }
    certificates.validation = read_suppressed(table);
}

crypto::PasswordCost read_password_cost(const TomlTable& table)
{
    crypto::PasswordCost cost;
    const std::string scheme = table.text("password_hash", "scrypt");
    if (scheme == "pbkdf2") {
        cost.scheme = crypto::PasswordScheme::Pbkdf2;
        cost.iterations = static_cast<std::uint32_t>(table.integer(
            "password_iterations", cost.iterations, least_iterations, most_iterations));
    } else if (scheme != "scrypt") {
        table.fail("password_hash", "\"scrypt\" or \"pbkdf2\"");
    } else if (table.has("password_iterations")) {
        table.refuse("password_iterations", "found it with scrypt, which has none, expected it "
                                            "with password_hash = \"pbkdf2\"");
    }
    return cost;
}

void read_users(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"anonymous", "account", "certificates", "tokens", "setup", "authorities",
                 "passwords", "password_hash", "password_iterations"});
    UserConfig& users = config.users;
    users.password_rules.cost = read_password_cost(table);
    users.anonymous = read_optional_access(table, "anonymous");
    users.certified = read_optional_access(table, "certificates");
    for (const TomlTable& entry : table.tables("account")) {
        Account account = read_account(entry);
        if (has_account(users, account.name)) {
            entry.refuse("name",
                         "found \"" + account.name + "\" again, expected a name of its own");
        }
        users.accounts.push_back(std::move(account));
    }
    users.has_setup = table.flag("setup", false);
    if (const auto authorities =
            administration::find_authorities(table.text("authorities", "standard"))) {
        users.authorities = *authorities;
    } else {
        table.fail("authorities", "\"standard\" or \"five levels\"");
    }
    if (table.has("tokens")) {
        users.tokens = read_tokens(table.table("tokens"));
        config.server.issuer.authority_url = users.tokens->rules.issuer;
    }
    if (users.has_setup && (!users.accounts.empty() || users.tokens)) {
        table.refuse("setup", "found it beside accounts or tokens, expected it without these: "
                              "users are then added online");
    }
}

} // namespace busbar::product
