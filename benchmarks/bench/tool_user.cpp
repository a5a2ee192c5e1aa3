#include "tool_user.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <busbar/net/system.hpp>

#include "identity.hpp"
#include "own_server.hpp"

namespace busbar::bench {

namespace fs = std::filesystem;

ToolUser::ToolUser(const OwnController& controller, const std::string& program)
    : controller_{controller}, program_{fs::absolute(program).string()}
{
}

bool ToolUser::prepare() const
{
    const fs::path folder{controller_.folder()};
    std::ofstream{folder / "password"} << good_password << "\n";
    if (!execute("cert create")) {
        return false;
    }
    std::error_code failed;
    for (const auto& each : fs::recursive_directory_iterator{folder / "data", failed}) {
        if (each.path().extension() == ".der") {
            fs::copy_file(each.path(), folder / "pki/trusted/certs/tool.der", failed);
        }
    }
    controller_.reload();
    const auto spare = make_identity(net::SystemWallClock{}.now());
    if (!spare) {
        return false;
    }
    const auto der = spare->certificates.front().der();
    std::ofstream{folder / "spare.der", std::ios::binary}.write(
        reinterpret_cast<const char*>(der.data()), static_cast<std::streamsize>(der.size()));
    std::ofstream{folder / "thumbprint"} << spare->certificates.front().thumbprint_text();
    return !failed;
}

bool ToolUser::run(std::string_view user, std::string_view words) const
{
    return execute("--user " + std::string{user} + " --password-file password --trust " +
                   std::string{words});
}

bool ToolUser::execute(std::string_view words) const
{
    const std::string command = "cd '" + controller_.folder() +
                                "' && XDG_DATA_HOME=\"$PWD/data\" BUSBAR_URL=" + controller_.url() +
                                " timeout 60 '" + program_ + "' " + std::string{words} +
                                " </dev/null >>tool.output 2>&1";
    return std::system(command.c_str()) == 0; // NOLINT(*-mt-unsafe)
}

} // namespace busbar::bench
