#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "admission.hpp"
#include "first_account.hpp"
#include "reload.hpp"
#include "support/seeded_random.hpp"
#include "support/temporary_folder.hpp"

using namespace busbar;
using namespace busbar::example;
namespace fs = std::filesystem;

namespace {

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
        return example::reload(file, *settings, *admission,
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

TEST_CASE("the first account has a password of its own, and keeps it (D8)")
{
    const test::TemporaryFolder folder;
    const std::string certificates = folder.path.string() + "/pki";
    CHECK_FALSE(load_first_account(certificates));
    test::SeededRandom random{7};
    const FirstAccount made = make_first_account(certificates, random);
    REQUIRE(made.password);
    const std::string password{made.password->text()};
    CHECK(made.account.name == "operator");
    CHECK(password.size() == 23); // four groups of five characters of 32
    CHECK(std::count(password.begin(), password.end(), '-') == 3);
    CHECK(crypto::verify_password(password, made.account.password_hash));

    const fs::path file = fs::path{certificates} / "operator.password";
    CHECK((fs::status(file).permissions() & fs::perms::mask) ==
          (fs::perms::owner_read | fs::perms::owner_write));
    CHECK(read(file) == made.account.password_hash + "\n");

    const auto again = load_first_account(certificates);
    REQUIRE(again);
    CHECK_FALSE(again->password); // shown once
    CHECK(again->account.password_hash == made.account.password_hash);
    CHECK(again->account.name == "operator");

    const FirstAccount other = make_first_account(certificates, random);
    CHECK(other.password->text() != password);
}

TEST_CASE("a first account whose file is damaged lets nobody in (D8)")
{
    const test::TemporaryFolder folder;
    write(folder.path.string() + "/operator.password", "operator");
    CHECK(complaint([&] {
              static_cast<void>(load_first_account(folder.path.string()));
          }).find("operator.password: found no hash of a password, expected") != std::string::npos);
}

TEST_CASE("B1: accounts have roles, by themselves those of their access")
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

TEST_CASE("users are read again (D6)")
{
    Plant plant;
    CHECK(plant.lets_in("anna", "first password"));
    write(plant.file, "[users]\nanonymous = \"write\"\n" + account("anna", "second password") +
                          account("bert", "third password", "read"));
    CHECK_FALSE(plant.lets_in("bert", "third password"));
    const std::string said = plant.reload();
    INFO(said);
    CHECK(said.find("2 accounts of " + plant.file) != std::string::npos);
    CHECK(said.find("0 trusted certificates") != std::string::npos);
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

TEST_CASE("a broken file changes nothing, and its line is told (D6)")
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
        {good, "plant.toml: [users]: accounts came or went, expected "},
        {account("anna", "second password"), "plant.toml: [users]: anonymous users came or went"},
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
