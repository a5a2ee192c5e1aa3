#include "programs/controller_site.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <busbar/core/log.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/net/system.hpp>

#include "support/kept_key.hpp"
#include "tool/connection/pki.hpp"

namespace busbar::test {

namespace {

/// A socket of this machine that listens at no port, and is at the given one, or any if that is 0;
/// negative if it cannot be.
int bound_socket(std::uint16_t& port)
{
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    ::sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    ::socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<::sockaddr*>(&address);
    if (::bind(descriptor, any, size) != 0 || ::getsockname(descriptor, any, &size) != 0) {
        ::close(descriptor);
        return -1;
    }
    port = ntohs(address.sin_port);
    return descriptor;
}

std::string free_port()
{
    std::uint16_t port = 0;
    const int descriptor = bound_socket(port);
    if (descriptor < 0) {
        throw std::runtime_error{"there is no port"};
    }
    ::close(descriptor);
    return std::to_string(port);
}

/// What a simulation begins with, which takes long to make: keys.
struct Installation {
    Installation()
    {
        tool::Options options;
        options.pki = (folder.path / "client").string();
        NullLog log;
        tool::Pki pki{options, log};
        static_cast<void>(pki.identity());
        crypto::SystemRandom random;
        hash = *crypto::hash_password(ControllerSite::password, random, cost);
        const crypto::PrivateKey key = kept_key("trusted-clients", 2048);
        for (int i = 0; i < 3; ++i) {
            crypto::CertificateSubject subject;
            subject.common_name = "Client " + std::to_string(i);
            subject.application_uri = "urn:busbar:test:client-" + std::to_string(i);
            subject.valid_from = net::SystemWallClock{}.now();
            strangers.push_back(*crypto::create_self_signed(key, subject));
        }
    }

    static constexpr crypto::PasswordCost cost{.scheme = crypto::PasswordScheme::Pbkdf2,
                                               .iterations = 10'000};
    TemporaryFolder folder;
    std::string hash;
    std::vector<crypto::Certificate> strangers;
    /// The controller's own certificate, once one has made it.
    bool has_own{false};
};

Installation& installation()
{
    static Installation all;
    return all;
}
} // namespace

std::vector<std::string> setting_names()
{
    std::vector<std::string> names{mode_setting};
    std::ranges::transform(drawn_settings, std::back_inserter(names), &DrawnSetting::name);
    return names;
}

std::vector<std::string> variable_names()
{
    return {"Speed", "Extra1", "Extra2", "Extra3", "Total", "Kept1", "Kept2", "Kept3"};
}

bool is_retained(const std::string& variable)
{
    return variable == "Total" || variable.starts_with("Kept");
}

Variant variant_of(const std::string& setting, const std::string& text)
{
    const auto drawn = std::ranges::find_if(
        drawn_settings, [&](const DrawnSetting& each) { return each.name == setting; });
    const bool is_number = drawn != drawn_settings.end() && drawn->most != 0;
    return text.empty() ? Variant{}
           : is_number  ? Variant{static_cast<std::int64_t>(std::stoll(text))}
                        : Variant{String{text}};
}

std::string read_all(const fs::path& path)
{
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

ControllerSite::ControllerSite(harness::Chance& chance, bool is_model)
    : file{(folder.path / "controller.toml").string()}, chance_{chance}, is_model_{is_model}
{
    const Installation& all = installation();
    fs::copy(all.folder.path / "client", folder.path / "client", fs::copy_options::recursive);
    lay_certificate();
    if (all.has_own) {
        fs::copy(all.folder.path / "own", folder.path / "pki/own", fs::copy_options::recursive);
    }
    ports = {free_port(), free_port()};
    for (const DrawnSetting& setting : drawn_settings) {
        settings[setting.name] = setting.most == 0 ? "Press" : std::to_string(setting.least + 1);
    }
    settings[mode_setting] = chance_.one_in(3) ? in_run : in_program;
    settings["port"] = ports.front();
    write_configuration();
    program = new_program(false);
    write_program();
}

void ControllerSite::lay_certificate() const
{
    fs::create_directories(folder.path / "pki/trusted/certs");
    fs::copy(installation().folder.path / "client/own/certs/own.der",
             folder.path / "pki/trusted/certs/chief.der", fs::copy_options::overwrite_existing);
}

void ControllerSite::write_configuration()
{
    const std::string place = folder.path.string();
    std::ofstream{file} << "[server]\naddress = \"127.0.0.1\"\nport = " << settings["port"]
                        << "\nname = \"" << settings["server.name"]
                        << "\"\n[certificates]\nfolder = \"" << place << "/pki\"\n"
                        << R"([[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[limits]
login_failures = 1000
login_failures_per_address = 1000
first_login_delay_ms = 0
max_login_delay_ms = 0
)"
                        << "sessions = " << settings["limits.sessions"]
                        << "\npending_requests = " << settings["limits.pending_requests"] << R"(
[users]
password_hash = "pbkdf2"
password_iterations = 10000
[[users.account]]
name = "chief"
roles = ["SecurityAdmin", "ConfigureAdmin", "Operator"]
password = ")" << installation().hash
                        << (is_model_ ? "\"\n[labels]" : "\"\n[machine]") << "\nprogram = \""
                        << place << "/press.st\"\n"
                        << (is_model_ ? std::string{} : machine_lines())
                        << "[plc]\nrealtime_priority = 0\nscan_ms = " << settings["plc.scan_ms"]
                        << "\nwaiting_writes = " << settings["plc.waiting_writes"] << "\n";
    is_file_good = true;
}

std::string ControllerSite::machine_lines()
{
    const std::string place = folder.path.string();
    return "state = \"" + place + "/state\"\nmedium = \"" + place + "/medium\"\nmode = \"" +
           settings[mode_setting] + "\"\nexecution_log = true\nexecution_log_files = " +
           settings["machine.execution_log_files"] + "\nretained_ms = 200\n";
}

void ControllerSite::write_program()
{
    std::ofstream{folder.path / "press.st"} << program.text;
    is_program_good = true;
}

MachineText ControllerSite::new_program(bool is_other_type)
{
    MachineText program;
    program.variables = {"Speed", "Total"};
    std::string extras;
    std::string kept;
    for (int i = 1; i <= 3; ++i) {
        if (chance_.one_in(2)) {
            program.variables.insert("Extra" + std::to_string(i));
            extras += "    Extra" + std::to_string(i) + " : DINT;\n";
        }
        if (chance_.one_in(2)) {
            program.variables.insert("Kept" + std::to_string(i));
            kept += "    Kept" + std::to_string(i) + " : DINT := 5;\n";
        }
    }
    const std::string published = "{attribute 'publish' := 'publish only'}\n";
    program.text = "(* " + std::to_string(++number_) + " *)\n" + published +
                   "VAR_GLOBAL\n    Speed : " + (is_other_type ? "REAL" : "INT") + ";\n" + extras +
                   "END_VAR\n" + published + "VAR_GLOBAL RETAIN\n    Total : DINT := 5;\n" + kept +
                   "END_VAR\n";
    return program;
}

void ControllerSite::damage_configuration()
{
    std::ofstream{file, std::ios::app} << "[[[\n";
    is_file_good = false;
}

void ControllerSite::damage_program()
{
    std::ofstream{folder.path / "press.st", std::ios::app} << "VAR_GLOBAL\n";
    is_program_good = false;
}

std::string ControllerSite::other_port() const
{
    return settings.at("port") == ports.front() ? ports.back() : ports.front();
}

bool ControllerSite::occupy(const std::string& port)
{
    release();
    auto number = static_cast<std::uint16_t>(std::stoul(port));
    occupier_ = bound_socket(number);
    occupied_ = occupier_ >= 0 ? port : std::string{};
    return occupier_ >= 0;
}

void ControllerSite::release()
{
    if (occupier_ >= 0) {
        ::close(std::exchange(occupier_, -1));
    }
    occupied_.clear();
}

void ControllerSite::forget_controller() const
{
    fs::remove_all(folder.path / "client/trusted/certs");
}

void ControllerSite::keep_own_certificate() const
{
    Installation& all = installation();
    if (!std::exchange(all.has_own, true)) {
        fs::copy(folder.path / "pki/own", all.folder.path / "own", fs::copy_options::recursive);
    }
}

std::vector<fs::path> ControllerSite::kept_files() const
{
    std::vector<fs::path> files;
    for (const char* const part : {"pki", "state", "medium"}) {
        for (const auto& entry : fs::recursive_directory_iterator{folder.path / part}) {
            const std::string path = entry.path().string();
            if (entry.is_regular_file() && path.find("/own/") == std::string::npos &&
                path.find("chief.der") == std::string::npos &&
                path.find("program.received") == std::string::npos) {
                files.push_back(entry.path());
            }
        }
    }
    std::ranges::sort(files);
    return files;
}

const std::vector<crypto::Certificate>& ControllerSite::strangers()
{
    return installation().strangers;
}

} // namespace busbar::test
