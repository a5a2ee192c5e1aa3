#include <busbar/controller/machine_settings.hpp>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/file_transaction.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/security_policy.hpp>

namespace busbar::controller {

namespace {

constexpr std::size_t max_settings_file = 65'536;

Configured<void> check_range(const char* name, std::uint32_t value, std::uint32_t low,
                             std::uint32_t high)
{
    if (value < low || value > high) {
        return misconfigured(name,
                             "found " + std::to_string(value) + ", expected " +
                                 std::to_string(low) + " to " + std::to_string(high),
                             status::Bad_OutOfRange);
    }
    return {};
}

Configured<void> check_mode(const char* what, MachineMode mode)
{
    if (mode == MachineMode::Run) {
        return misconfigured(what, "found RUN mode, expected PROGRAM mode",
                             status::Bad_InvalidState);
    }
    return {};
}

Configured<void> check_security(const MessageSecurity& security, const std::string& where)
{
    const crypto::SecurityPolicy* const policy = crypto::find_policy_by_name(security.policy);
    if (policy == nullptr) {
        return misconfigured(where, "found " + printable(security.policy) +
                                        ", expected the name of a policy of this build");
    }
    const bool has_mode = security.mode == MessageSecurityMode::Sign ||
                          security.mode == MessageSecurityMode::SignAndEncrypt;
    if (policy->is_none() ? security.mode != MessageSecurityMode::None : !has_mode) {
        return misconfigured(where, "found " + std::string{channel::name(security.mode)} +
                                        " with policy " + security.policy +
                                        ", expected None with None and Sign or SignAndEncrypt "
                                        "with another policy");
    }
    return {};
}

Unexpected<Problem> not_kept(const Storage& storage, const std::string& file, StorageError error)
{
    return misconfigured(storage.place(file), std::string{text(error)}, status_of(error));
}

Configured<std::optional<std::string>> read_settings_text(Storage& storage, const std::string& file)
{
    const auto bytes = read_file(storage, file, max_settings_file);
    if (bytes) {
        return std::optional{
            std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}};
    }
    if (bytes.error() == StorageError::NotFound) {
        return std::nullopt;
    }
    return not_kept(storage, file, bytes.error());
}

} // namespace

std::vector<MessageSecurity> recommended_security()
{
    std::vector<MessageSecurity> all;
    for (const MessageSecurityMode mode :
         {MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt}) {
        for (const crypto::SecurityPolicy& policy : crypto::security_policies()) {
            if (!policy.is_none() && !policy.is_deprecated) {
                all.push_back({mode, std::string{policy.name}});
            }
        }
    }
    return all;
}

std::string text(const MessageSecurity& security)
{
    return security.mode == MessageSecurityMode::None
               ? "None"
               : std::string{channel::name(security.mode)} + " - " + security.policy;
}

Configured<void> check(const ServerSettings& settings)
{
    if (auto port = check_range("port", settings.port, 1'025, 65'535); !port) {
        return port;
    }
    const ExecutionLogSettings& log = settings.execution_log;
    if (auto files = check_range("execution_log.files", log.files, 2, 100); !files) {
        return files;
    }
    return check_range("execution_log.records", log.records, 100, 65'536);
}

Configured<void> check(const SecuritySettings& settings)
{
    if (settings.allowed.empty()) {
        return misconfigured("allowed", "found nothing, expected at least one way to connect");
    }
    for (auto each = settings.allowed.begin(); each != settings.allowed.end(); ++each) {
        const std::string where =
            "allowed[" + std::to_string(each - settings.allowed.begin()) + "]";
        if (auto checked = check_security(*each, where); !checked) {
            return checked;
        }
        if (std::find(settings.allowed.begin(), each, *each) != each) {
            return misconfigured(where, "found " + text(*each) + " twice, expected each once");
        }
    }
    return {};
}

Configured<void> MachineSettings::load()
{
    if (const auto finished = FileTransaction{*storage_, transaction_}.recover(); !finished) {
        return not_kept(*storage_, transaction_, finished.error());
    }
    const auto server_text = read_settings_text(*storage_, server_file_);
    if (!server_text) {
        return Unexpected{server_text.error()};
    }
    const auto security_text = read_settings_text(*storage_, security_file_);
    if (!security_text) {
        return Unexpected{security_text.error()};
    }
    if (!*server_text && !*security_text) {
        server_ = {};
        security_ = {};
        return {};
    }
    if (!*server_text || !*security_text) {
        return misconfigured(storage_->place(*server_text ? security_file_ : server_file_),
                             "is missing, while the other file of settings exists",
                             status::Bad_NotFound);
    }
    const auto server = read_server_settings(**server_text, storage_->place(server_file_));
    if (!server) {
        return Unexpected{server.error()};
    }
    const auto security = read_security_settings(**security_text, storage_->place(security_file_));
    if (!security) {
        return Unexpected{security.error()};
    }
    server_ = *server;
    security_ = *security;
    return {};
}

Configured<void> MachineSettings::transfer(const ServerSettings& settings, MachineMode mode)
{
    auto done =
        check_mode("server settings", mode).and_then([&] { return check(settings); }).and_then([&] {
            return write({server_file_, document_of(settings)},
                         {security_file_, document_of(security_)});
        });
    if (done) {
        server_ = settings;
    }
    return done;
}

Configured<void> MachineSettings::transfer(const SecuritySettings& settings, MachineMode mode)
{
    auto done = check_mode("security settings", mode)
                    .and_then([&] { return check(settings); })
                    .and_then([&] {
                        return write({security_file_, document_of(settings)},
                                     {server_file_, document_of(server_)});
                    });
    if (done) {
        security_ = settings;
    }
    return done;
}

bool MachineSettings::is_there(const std::string& file) const
{
    const auto entry = storage_->entry(file);
    return entry || entry.error() != StorageError::NotFound;
}

Configured<void> MachineSettings::write(const Document& changed, const Document& other)
{
    FileTransaction change{*storage_, transaction_};
    const auto put = [&](const Document& document) {
        return change.replace(document.file, std::as_bytes(std::span{document.text}),
                              FileAccess::Owner);
    };
    const bool is_new = !is_there(changed.file) && !is_there(other.file);
    auto done = put(changed);
    if (done && is_new) {
        done = put(other);
    }
    if (done) {
        done = change.commit();
    }
    // A change that is decided cannot be taken back.
    if (!done && !change.is_decided()) {
        return not_kept(*storage_, changed.file, done.error());
    }
    return {};
}

} // namespace busbar::controller
