#include <catch2/catch.hpp>

#include <busbar/controller/backup.hpp>

namespace restore_command_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string command_problem(std::string_view command)
{
    const auto read = read_restore_command(command);
    return read ? "" : text(read.error());
}

bool restores_security(std::string_view command)
{
    const auto read = read_restore_command(command);
    REQUIRE(read);
    return read->security_profile;
}

} // namespace

TEST_CASE("RestoreCommand.ini as it is made (8-2-2)")
{
    CHECK(restores_security("[Restore]\r\n"
                            "; --- program ---\r\n"
                            "UserProgram=yes\r\n"
                            "IPAdr=yes\r\n"
                            "; --- profile ---\r\n"
                            "OpcuaSPF=yes\r\n"));
}

TEST_CASE("OpcuaSPF says whether the security profile is restored (8-2-2)")
{
    CHECK(restores_security("[Restore]\nOpcuaSPF=yes"));
    CHECK_FALSE(restores_security("[Restore]\nOpcuaSPF=no"));
    CHECK_FALSE(restores_security(" [restore] \n\n opcuaspf = NO \n"));
    CHECK(restores_security("[Restore]\n"));
    CHECK(restores_security("[Restore]\n;OpcuaSPF=no\n"));
    CHECK(restores_security("[Other]\nOpcuaSPF=no\n[Restore]\n"));
    CHECK_FALSE(restores_security("[Restore]\n[Other]\nx\n[Restore]\nOpcuaSPF=no"));
}

TEST_CASE("A wrong RestoreCommand.ini is told by its line (8-2-2)")
{
    CHECK(command_problem("") == "RestoreCommand.ini: found no section [Restore]");
    CHECK(command_problem("[Restore]\n\nOpcuaSPF=maybe") ==
          "RestoreCommand.ini:3: OpcuaSPF: found maybe, expected yes or no");
    CHECK(command_problem("[Restore]\nUserProgram=no") ==
          "RestoreCommand.ini:2: UserProgram: found no, expected yes");
    CHECK(command_problem("[Restore]\nOpcuaSPF") ==
          "RestoreCommand.ini:2: found OpcuaSPF, expected a name and =");
    CHECK(command_problem("[Restore]\nOpcuaSPF=yes\nOpcuaSPF=no") ==
          "RestoreCommand.ini:3: found OpcuaSPF twice, expected it once");
    CHECK(command_problem(std::string(70'000, ' ')) ==
          "RestoreCommand.ini: is too large (Bad_OutOfRange)");
}

} // namespace restore_command_test
