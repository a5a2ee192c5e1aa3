#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "programs/controller_rights.hpp"

namespace secret_memory_test {

// The memory of a running controller has no password in it after a Method or a login that had one,
// however that ended.

using namespace busbar;
using namespace busbar::test;

namespace {

/// How often the text is in the memory of the process that can be written.
std::size_t copies(::pid_t process, std::string_view text)
{
    const std::string folder = "/proc/" + std::to_string(process);
    std::ifstream maps{folder + "/maps"};
    std::ifstream memory{folder + "/mem", std::ios::binary};
    REQUIRE(maps);
    REQUIRE(memory);
    std::size_t count = 0;
    for (std::string line; std::getline(maps, line);) {
        std::uint64_t begin = 0;
        std::uint64_t end = 0;
        char dash = 0;
        std::string rights;
        std::istringstream{line} >> std::hex >> begin >> dash >> end >> rights;
        if (!rights.starts_with("rw")) {
            continue;
        }
        std::string bytes(end - begin, '\0');
        memory.clear();
        memory.seekg(static_cast<std::streamoff>(begin));
        memory.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        bytes.resize(static_cast<std::size_t>(memory.gcount()));
        for (std::size_t at = bytes.find(text); at != std::string::npos;
             at = bytes.find(text, at + 1)) {
            ++count;
        }
    }
    return count;
}

/// A Method of UserManagement that gets the password.
struct Use {
    const char* what;
    const char* method;
    std::function<std::vector<Variant>(const char* password)> inputs;
    const char* answer;
};

Variant text(const char* value)
{
    return Variant{String{value}};
}

const Variant nothing{std::uint32_t{0}};

} // namespace

TEST_CASE("a controller's memory keeps no password of a Method or a login")
{
    RightsPlant plant{RightsPlant::Mode::Variables};
    // Else a password that is not found would say nothing.
    CHECK(copies(plant.process(), "ApplicationsExclude") > 0);
    const std::array uses{
        Use{"a user", "AddUser",
            [](const char* password) {
                return std::vector{text("mem"), text(password), nothing, text("")};
            },
            "Good"},
        Use{"a user who is there", "AddUser",
            [](const char* password) {
                return std::vector{text("mem"), text(password), nothing, text("")};
            },
            "Bad_AlreadyExists"},
        Use{"too many arguments", "AddUser",
            [](const char* password) {
                return std::vector{text("sam"), text(password), nothing, text(""), text("")};
            },
            "Bad_TooManyArguments"},
        Use{"arguments of other types", "AddUser",
            [](const char* password) {
                return std::vector{text("sam"), text(password), text("x"), text("")};
            },
            "Bad_InvalidArgument"},
        Use{"another password", "ModifyUser",
            [](const char* password) {
                return std::vector{text("mem"), Variant{true},  text(password), Variant{false},
                                   nothing,     Variant{false}, text("")};
            },
            "Good"},
        Use{"a wrong old one", "ChangePassword",
            [](const char* password) {
                return std::vector{text(password), text("some thing new")};
            },
            "Bad_IdentityTokenInvalid"},
        Use{"a new one after a wrong old one", "ChangePassword",
            [](const char* password) {
                return std::vector{text("not the one"), text(password)};
            },
            "Bad_IdentityTokenInvalid"},
        Use{"a new one", "ChangePassword",
            [](const char* password) {
                return std::vector{text(RightsPlant::password), text(password)};
            },
            "Good"},
    };
    RightsClient pat{plant, "pat", Channel::SignAndEncrypt};
    std::string password = "a secret 0 to find";
    for (const Use& use : uses) {
        INFO(use.what);
        ++password[9];
        const std::string path = std::string{"Server/ServerConfiguration/UserManagement/"};
        const FoundNode* const node = plant.crawl().find(path + use.method);
        REQUIRE(node != nullptr);
        RightsClient& client =
            std::string_view{use.method} == "ChangePassword" ? pat : plant.chief();
        CHECK(name(client.on(node->object, node->id, use.inputs(password.c_str())).status_code) ==
              use.answer);
        static_cast<void>(client.read(node->object)); // the request before is over
        CHECK(copies(plant.process(), password) == 0);
    }
    CHECK(pat.try_user("pat", "a secret 9 to find") == "Bad_UserAccessDenied");
    CHECK(copies(plant.process(), "a secret 9 to find") == 0);
    CHECK(pat.try_user("pat", password) == "Good");
    CHECK(copies(plant.process(), password) == 0);
}

} // namespace secret_memory_test
