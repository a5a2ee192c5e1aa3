#include "programs/controllers.hpp"

#include <stdexcept>

#include <busbar/crypto/own_certificate.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/system.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "support/kept_key.hpp"

namespace busbar::test {

namespace {

/// Keys are slow to make: one for all.
const crypto::PrivateKey& server_key()
{
    static const crypto::PrivateKey key = kept_key("controllers", 2048);
    return key;
}

std::string application_uri(const std::string& name)
{
    return "urn:busbar:test:" + name;
}

std::string between(const std::string& text, const std::string& before, const std::string& after)
{
    const std::size_t begin = text.find(before);
    if (begin == std::string::npos) {
        return "";
    }
    const std::size_t first = begin + before.size();
    return text.substr(first, text.find(after, first) - first);
}

} // namespace

Controller::Controller(const ScratchFolder& scratch, std::string name, std::string configuration,
                       std::vector<std::string> arguments)
    : scratch_{&scratch}, name_{std::move(name)}, configuration_{std::move(configuration)},
      arguments_{std::move(arguments)}
{
    start("0");
}

void Controller::start(const std::string& port)
{
    const std::string server = "[server]\nname = \"" + name_ +
                               "\"\naddress = \"127.0.0.1\"\nport = " + port +
                               "\napplication_uri = \"" + application_uri(name_) + "\"\n";
    const std::string file =
        scratch_->write(name_ + "/" + name_ + ".toml", server + configuration_);
    const std::string folder = scratch_->path() + "/" + name_;
    std::vector<std::string> command{BUSBAR_CONTROLLER, "--config", file};
    command.insert(command.end(), arguments_.begin(), arguments_.end());
    program_ = std::make_unique<Program>(command, folder, folder + "/log");
    if (!program_->wait_for("ready; ")) {
        throw std::runtime_error{name_ + " does not start, " + program_->end_text() + ": " +
                                 program_->output()};
    }
    port_ = between(program_->output(), "variables at opc.tcp://", "\n");
    port_ = port_.substr(port_.rfind(':') + 1);
}

std::string open_configuration()
{
    return R"(
[[endpoint]]
policy = "None"
[users]
anonymous = "write"
[[plc.variable]]
name = "Mode"
type = "Byte"
[[plc.variable]]
name = "Serial"
type = "String"
initial = "BB-0001"
access = "read"
[[plc.variable]]
name = "Curve"
type = "Int32"
dimensions = [1000]
)";
}

std::string secure_configuration()
{
    crypto::SystemRandom random;
    const auto hash = crypto::hash_password("Long-Password-123", random);
    return R"(
[certificates]
trust_all_clients = true
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[[users.account]]
name = "operator"
password = ")" +
           *hash + "\"\n";
}

std::string install_certificate(const ScratchFolder& scratch, const std::string& name,
                                const ServerCertificate& certificate)
{
    crypto::CertificateSubject subject;
    subject.common_name = name;
    subject.organization = "Busbar";
    subject.application_uri = application_uri(name);
    subject.dns_names = {certificate.host};
    subject.valid_from = certificate.valid_from;
    subject.valid_days = certificate.valid_days;
    const auto made = crypto::create_self_signed(server_key(), subject);
    storage::FolderStorage files{scratch.path() + "/" + name + "/busbar-certificates"};
    const crypto::OwnCertificateStore store{files};
    if (!made || !store.install({{*made}, server_key()}, subject.application_uri)) {
        throw std::runtime_error{name + " gets no certificate"};
    }
    const auto der = made->der();
    return scratch.write(name + ".der", {reinterpret_cast<const char*>(der.data()), der.size()});
}

DateTime in_days_from_now(std::int64_t days)
{
    const DateTime now = net::SystemWallClock{}.now();
    return {now.ticks + days * 86'400 * DateTime::ticks_per_second};
}

} // namespace busbar::test
