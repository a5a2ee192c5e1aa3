#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/types/enumerations.hpp>

/// The two sets of settings of a controller's server (W588, 3-2-2 and 3-2-6),
/// as plain values and as files. Users are a separate list.
namespace busbar::controller {

/// The controller's mode: settings change in PROGRAM only.
enum class MachineMode : std::uint8_t { Program, Run };

/// Settings of the execution log (W588, 3-2-2).
struct ExecutionLogSettings {
    bool is_recorded{false};
    std::uint32_t files{24};       // 2 to 100
    std::uint32_t records{12'000}; // in each file, 100 to 65,536

    friend bool operator==(const ExecutionLogSettings&, const ExecutionLogSettings&) = default;
};

/// OPC UA Server Settings (W588, 3-2-2). Port and execution log keep their
/// values while the server is not used.
struct ServerSettings {
    /// A value that differs from the one at power-on takes effect at the next power-on (manual of
    /// variables mode, 3-2-3).
    bool is_used{false};
    std::uint32_t port{4840}; // 1,025 to 65,535
    ExecutionLogSettings execution_log{};

    friend bool operator==(const ServerSettings&, const ServerSettings&) = default;
};

/// One way to secure messages (W588, 5-2-2).
struct MessageSecurity {
    MessageSecurityMode mode{MessageSecurityMode::SignAndEncrypt};
    /// A name for crypto::find_policy_by_name; "None" with mode None.
    std::string policy{"Basic256Sha256"};

    friend bool operator==(const MessageSecurity&, const MessageSecurity&) = default;
};

/// Returns every policy of this build that Part 7 still recommends, with Sign and with
/// SignAndEncrypt.
[[nodiscard]] BUSBAR_API std::vector<MessageSecurity> recommended_security();
/// Returns "SignAndEncrypt - Basic256Sha256", or "None".
[[nodiscard]] BUSBAR_API std::string text(const MessageSecurity& security);

/// Security Settings (W588, 3-2-6). That product admits every client until a
/// user restricts it; here no client connects anonymously or without security until a user allows
/// it.
struct SecuritySettings {
    bool allows_anonymous{false};
    /// At least one; no duplicates.
    std::vector<MessageSecurity> allowed{recommended_security()};

    friend bool operator==(const SecuritySettings&, const SecuritySettings&) = default;
};

/// Returns the first value that is out of range; `where` is its name: "execution_log.files".
[[nodiscard]] BUSBAR_API Configured<void> check(const ServerSettings& settings);
[[nodiscard]] BUSBAR_API Configured<void> check(const SecuritySettings& settings);

// As files: JSON with a version and a checksum, so that damage is never taken for another value. A
// program whose settings are edited by people has its own configuration and transfers it.

/// Writes the settings as such a document.
[[nodiscard]] BUSBAR_API std::string document_of(const ServerSettings& settings);
[[nodiscard]] BUSBAR_API std::string document_of(const SecuritySettings& settings);
/// Reads and checks such a document. `where` of a problem begins with `place`.
[[nodiscard]] BUSBAR_API Configured<ServerSettings> read_server_settings(std::string_view document,
                                                                         const std::string& place);
[[nodiscard]] BUSBAR_API Configured<SecuritySettings>
read_security_settings(std::string_view document, const std::string& place);

/// Both sets, each in a file of a Storage. Used by one thread.
class BUSBAR_API MachineSettings {
public:
    /// `storage` must outlive this object. The files' folders must exist; `transaction` is the
    /// folder of a FileTransaction, the same as that of a MachineMemory with these files.
    MachineSettings(Storage& storage, std::string server_file, std::string security_file,
                    std::string transaction)
        : storage_{&storage}, server_file_{std::move(server_file)},
          security_file_{std::move(security_file)}, transaction_{std::move(transaction)}
    {
    }

    /// Reads both. A controller that has neither file is new and gets the defaults. Everything else
    /// that cannot be read is a Configuration Error of LifeCycle, never a default: a file that is
    /// truncated, damaged or has another version, one file without the other, or a missing medium.
    /// The settings in force then stay.
    [[nodiscard]] Configured<void> load();
    [[nodiscard]] const ServerSettings& server() const { return server_; }
    [[nodiscard]] const SecuritySettings& security() const { return security_; }

    /// Replaces a set as a whole, first in its file and then here. Bad_InvalidState in RUN;
    /// otherwise the problem of check() or of the storage. After a problem nothing has changed, in
    /// the file either.
    [[nodiscard]] Configured<void> transfer(const ServerSettings& settings, MachineMode mode);
    [[nodiscard]] Configured<void> transfer(const SecuritySettings& settings, MachineMode mode);

private:
    struct Document {
        const std::string& file;
        std::string text;
    };

    /// Writes the first; if neither file exists also the other, so that a single file always means
    /// a loss.
    [[nodiscard]] Configured<void> write(const Document& changed, const Document& other);
    [[nodiscard]] bool is_there(const std::string& file) const;

    Storage* storage_;
    std::string server_file_;
    std::string security_file_;
    std::string transaction_;
    ServerSettings server_{};
    SecuritySettings security_{};
};

} // namespace busbar::controller
