#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/access/admission.hpp"
#include "product/access/setup.hpp"
#include "product/configuration/live_config.hpp"
#include "product/configuration/sections.hpp"
#include "support/seeded_random.hpp"
#include "support/temporary_folder.hpp"

namespace users_test {

using namespace busbar;
using namespace busbar::product;
namespace fs = std::filesystem;

namespace {

constexpr crypto::PasswordCost cheap{.scheme = crypto::PasswordScheme::Pbkdf2,
                                     .iterations = 10'000};

void write(const fs::path& path, const std::string& text)
{
    std::ofstream{path, std::ios::binary} << text;
}

std::string read(const fs::path& path)
{
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

std::string complaint(const std::function<void()>& act)
{
    try {
        act();
    } catch (const ConfigError& error) {
        return error.what();
    }
    return "nothing";
}

std::string account(const std::string& name, const std::string& password,
                    const std::string& access = "write")
{
    test::SeededRandom random{1};
    return "[[users.account]]\nname = \"" + name + "\"\npassword = \"" +
           crypto::hash_password(password, random).value() + "\"\naccess = \"" + access + "\"\n";
}

/// A controller's configuration on the disk and who is let in by it.
struct Plant {
    Plant()
    {
        write(file, "[users]\nanonymous = \"read\"\n" + account("anna", "first password"));
        settings = std::make_unique<Settings>(file);
        ControllerConfig config = settings->config();
        config.certificates.folder = folder.path.string() + "/pki";
        admission = std::make_unique<Admission>(config, pki, log);
    }
    std::string reload()
    {
        return product::reload(file, *settings, *admission,
                               DateTime::from_unix_seconds(1'750'000'000));
    }
    bool lets_in(const std::string& name, const std::string& password)
    {
        return admission->users().log_in(name, password).has_value();
    }

    test::TemporaryFolder folder;
    storage::FolderStorage pki{folder.path.string() + "/pki"};
    std::string file{folder.path.string() + "/plant.toml"};
    NullLog log;
    std::unique_ptr<Settings> settings;
    std::unique_ptr<Admission> admission;
};

} // namespace

TEST_CASE("the first account has a password of its own, and keeps it")
{
    const test::TemporaryFolder folder;
    const std::string certificates = folder.path.string() + "/pki";
    CHECK_FALSE(load_first_account(certificates));
    test::SeededRandom random{7};
    const FirstAccount made = make_first_account(certificates, random, cheap);
    REQUIRE(made.password);
    const std::string password{made.password->text()};
    CHECK(made.account.name == "operator");
    CHECK(password.size() == 23); // four groups of five characters of 32
    CHECK(std::count(password.begin(), password.end(), '-') == 3);
    CHECK(crypto::verify_password(password, made.account.password_hash));
    CHECK(crypto::cost_of(made.account.password_hash) == cheap);

    const fs::path file = fs::path{certificates} / "operator.password";
    CHECK((fs::status(file).permissions() & fs::perms::mask) ==
          (fs::perms::owner_read | fs::perms::owner_write));
    CHECK(read(file) == made.account.password_hash + "\n");

    const auto again = load_first_account(certificates);
    REQUIRE(again);
    CHECK_FALSE(again->password); // shown once
    CHECK(again->account.password_hash == made.account.password_hash);
    CHECK(again->account.name == "operator");

    const FirstAccount other = make_first_account(certificates, random, cheap);
    CHECK(other.password->text() != password);
}

TEST_CASE("what new hashes cost is configured")
{
    const auto cost = [](const std::string& users) {
        return parse_config("[users]\n" + users, "plant.toml").users.password_rules.cost;
    };
    CHECK(cost("") == crypto::PasswordCost{});
    CHECK(cost("password_hash = \"scrypt\"") == crypto::PasswordCost{});
    CHECK(cost("password_hash = \"pbkdf2\"") ==
          crypto::PasswordCost{.scheme = crypto::PasswordScheme::Pbkdf2, .iterations = 600'000});
    CHECK(cost("password_hash = \"pbkdf2\"\npassword_iterations = 10000") == cheap);
    CHECK(cost("password_iterations = 10000000\npassword_hash = \"pbkdf2\"").iterations ==
          10'000'000);
    // A product's limits say nothing of it.
    const std::string preset = "[limits]\npreset = \"nj501\"\n[users]\npassword_hash = \"pbkdf2\"";
    const UserConfig users = parse_config(preset, "plant.toml").users;
    CHECK(users.password_rules.cost.scheme == crypto::PasswordScheme::Pbkdf2);
    CHECK(users.password_rules.max_users == 20);
}

TEST_CASE("a cost without sense is refused with its line")
{
    struct Row {
        std::string users;
        std::string said;
    };
    const std::string pbkdf2 = "password_hash = \"pbkdf2\"\n";
    const Row rows[] = {
        {"password_hash = \"bcrypt\"",
         "plant.toml:2: password_hash: found 'bcrypt', expected \"scrypt\" or \"pbkdf2\""},
        {"password_hash = 2", "plant.toml:2: password_hash: found "},
        {"password_iterations = 600000",
         "plant.toml:2: password_iterations: found it with scrypt, which has none, expected it "
         "with password_hash = \"pbkdf2\""},
        {"password_hash = \"scrypt\"\npassword_iterations = 600000",
         "plant.toml:3: password_iterations: found it with scrypt"},
        {pbkdf2 + "password_iterations = 9999",
         "plant.toml:3: password_iterations: found 9999, expected a number from 10000 to 10000000"},
        {pbkdf2 + "password_iterations = 10000001", "plant.toml:3: password_iterations: found "},
        {pbkdf2 + "password_iterations = -10000", "plant.toml:3: password_iterations: found "},
        {pbkdf2 + "password_iterations = \"many\"", "plant.toml:3: password_iterations: found "},
    };
    for (const Row& row : rows) {
        const std::string said = complaint(
            [&] { static_cast<void>(parse_config("[users]\n" + row.users, "plant.toml")); });
        INFO(said);
        CHECK(said.find(row.said) == 0);
    }
}

TEST_CASE("accounts of either scheme log in, whatever new hashes cost")
{
    test::SeededRandom random;
    const auto with = [&](const crypto::PasswordCost& cost) {
        return "password = \"" + crypto::hash_password("first password", random, cost).value() +
               "\"\n";
    };
    Plant plant;
    for (const char* scheme : {"scrypt", "pbkdf2"}) {
        write(plant.file, "[users]\nanonymous = \"read\"\npassword_hash = \"" +
                              std::string{scheme} + "\"\n[[users.account]]\nname = \"anna\"\n" +
                              with({.log_n = 4}) + "[[users.account]]\nname = \"bert\"\n" +
                              with(cheap));
        static_cast<void>(plant.reload());
        CHECK(plant.lets_in("anna", "first password"));
        CHECK(plant.lets_in("bert", "first password"));
        CHECK_FALSE(plant.lets_in("carl", "first password"));
    }
}

TEST_CASE("the code of a setup costs what passwords do")
{
    Plant plant;
    test::SeededRandom random;
    storage::FolderStorage files{plant.folder.path.string() + "/setup"};
    Setup setup{files, plant.admission->clients(), plant.admission->passwords()};
    const auto code = setup.begin(random, cheap);
    REQUIRE(code);
    CHECK(crypto::cost_of(read(plant.folder.path / "setup" / "setup.code")) == cheap);
    CHECK(plant.lets_in("setup", std::string{code->text()}));
    CHECK(plant.admission->users().has_code("setup"));
    CHECK_FALSE(plant.admission->users().has_code("anna"));
    // One that was made before lasts.
    setup.end();
    REQUIRE(setup.begin(random, cheap));
    Setup again{files, plant.admission->clients(), plant.admission->passwords()};
    CHECK_FALSE(again.begin(random, {}));
    CHECK(crypto::cost_of(plant.admission->passwords().password_hash("setup")) == cheap);
}

TEST_CASE("a first account whose file is damaged lets nobody in")
{
    const test::TemporaryFolder folder;
    write(folder.path.string() + "/operator.password", "operator");
    CHECK(complaint([&] {
              static_cast<void>(load_first_account(folder.path.string()));
          }).find("operator.password: found no hash of a password, expected") != std::string::npos);
}

TEST_CASE("accounts have roles, by themselves those of their access")
{
    struct Row {
        std::string text;
        std::vector<std::string> roles;
    };
    const Row rows[] = {
        {account("anna", "first password"), {"Operator"}},
        {account("anna", "first password", "read"), {"Observer"}},
        {account("anna", "first password") + "roles = [\"SecurityAdmin\", \"ConfigureAdmin\"]\n",
         {"SecurityAdmin", "ConfigureAdmin"}},
        {account("anna", "first password") + "roles = []\n", {}},
    };
    for (const Row& row : rows) {
        Plant plant;
        write(plant.file, "[users]\nanonymous = \"read\"\n" + row.text);
        plant.reload();
        const auto user = plant.admission->users().log_in("anna", "first password");
        REQUIRE(user);
        CHECK(user->roles == row.roles);
    }
    Plant plant;
    write(plant.file, account("anna", "first password") + "roles = [\"Boss\"]\n");
    CHECK(complaint([&] { plant.reload(); })
              .find("roles: found \"Boss\", expected some of: "
                    "Observer, Operator") != std::string::npos);
}

TEST_CASE("users are read again")
{
    Plant plant;
    CHECK(plant.lets_in("anna", "first password"));
    write(plant.file, "[users]\nanonymous = \"write\"\n" + account("anna", "second password") +
                          account("bert", "third password", "read"));
    CHECK_FALSE(plant.lets_in("bert", "third password"));
    const std::string said = plant.reload();
    INFO(said);
    CHECK(said.find("2 accounts of " + plant.file) != std::string::npos);
    CHECK(said.find("no client needs a certificate") != std::string::npos);
    CHECK(said.find('$') == std::string::npos);
    CHECK_FALSE(plant.lets_in("anna", "first password"));
    CHECK(plant.lets_in("anna", "second password"));
    CHECK(plant.lets_in("bert", "third password"));
    CHECK(plant.admission->users().anonymous().access_level_mask == 0xFF);
    write(plant.file, "[users]\nanonymous = \"write\"\n" + account("bert", "third password"));
    static_cast<void>(plant.reload());
    CHECK_FALSE(plant.lets_in("anna", "second password"));
    CHECK(plant.lets_in("bert", "third password"));
}

TEST_CASE("a broken file changes nothing, and its line is told")
{
    Plant plant;
    const std::string good = "[users]\nanonymous = \"read\"\n";
    struct Row {
        std::string text;
        std::string said;
    };
    const Row rows[] = {
        {good + account("bert", "third password") + "acess = 1", "plant.toml:7: "},
        {"[users]\nanonymous = \"all\"", "plant.toml:2: anonymous: found "},
        {good, "plant.toml: [users]: accounts were added or removed, expected "},
        {good + account("bert", "third password") + account("bert", "third password"), "again"},
    };
    for (const Row& row : rows) {
        write(plant.file, row.text);
        const std::string said = complaint([&] { static_cast<void>(plant.reload()); });
        INFO(said);
        CHECK(said.find(row.said) != std::string::npos);
        CHECK(plant.lets_in("anna", "first password"));
        CHECK_FALSE(plant.lets_in("bert", "third password"));
        CHECK(plant.admission->users().anonymous().access_level_mask != 0xFF);
    }
    fs::remove(plant.file);
    CHECK(complaint([&] { static_cast<void>(plant.reload()); }).find("cannot be read") !=
          std::string::npos);
    CHECK(plant.lets_in("anna", "first password"));
}

} // namespace users_test
