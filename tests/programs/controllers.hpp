#pragma once

#include <memory>
#include <string>
#include <vector>

#include <busbar/core/date_time.hpp>

#include "support/program.hpp"

namespace busbar::test {

/// A busbar-controller at a port of its own, in a folder of its own.
class Controller {
public:
    /// `configuration` is TOML without its [server] table's port and address, `arguments` come
    /// after it on the command line. Throws if it does not start. The folder outlives it.
    Controller(const ScratchFolder& scratch, std::string name, std::string configuration,
               std::vector<std::string> arguments = {});

    void kill() { program_.reset(); }
    /// Starts it again, at the same port.
    void restart() { start(port_); }

    [[nodiscard]] ::pid_t process() const { return program_->process(); }
    [[nodiscard]] const std::string& port() const { return port_; }
    [[nodiscard]] std::string url() const { return "opc.tcp://localhost:" + port_; }

private:
    void start(const std::string& port);

    const ScratchFolder* scratch_;
    std::string name_;
    std::string configuration_;
    std::vector<std::string> arguments_;
    std::unique_ptr<Program> program_;
    std::string port_;
};

/// No security, and variables to write: Mode, a Byte, Serial, a String that may only be read, and
/// Curve, 1,000 Int32.
[[nodiscard]] std::string open_configuration();

/// Basic256Sha256, users by name only: operator, whose password is Long-Password-123. Every client
/// is trusted.
[[nodiscard]] std::string secure_configuration();

/// A certificate that a server is to have, self-signed.
struct ServerCertificate {
    std::string host{"localhost"};
    DateTime valid_from;
    std::uint32_t valid_days{30};
};
/// Lays it where the controller of this name looks for its own; its DER as a file in the folder.
std::string install_certificate(const ScratchFolder& scratch, const std::string& name,
                                const ServerCertificate& certificate);

[[nodiscard]] DateTime in_days_from_now(std::int64_t days);

} // namespace busbar::test
