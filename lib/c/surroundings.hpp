#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/busbar.h>
#include <busbar/channel/channel_types.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/store_validator.hpp>
#include <busbar/net/system.hpp>

#include "guard.hpp"

namespace busbar::c {

/// Passes lines of a level on to a program's callback.
class CallbackLog final : public LogSink {
public:
    CallbackLog(busbar_log_callback callback, void* context, int level)
        : callback_{callback}, context_{context}, level_{level}
    {
    }
    void write(LogLevel level, std::string_view source, std::string_view text) override;

private:
    busbar_log_callback callback_;
    void* context_;
    int level_;
};

/// Gives a server or client what it needs around it: log, clock, random numbers, its certificate
/// and whom it trusts, in a folder or in memory.
class ApplicationSurroundings {
public:
    /// `application` is read in open() too.
    explicit ApplicationSurroundings(const busbar_application& application);

    /// Opens the folder, or takes certificates from memory. Keeps what is wrong in `failure`.
    [[nodiscard]] StatusCode open(const busbar_application& application, FailureText& failure);

    [[nodiscard]] const std::string& uri() const { return uri_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const std::string& host() const { return host_; }
    [[nodiscard]] const std::optional<channel::ApplicationIdentity>& identity() const
    {
        return identity_;
    }
    [[nodiscard]] CallbackLog& log() { return log_; }
    [[nodiscard]] net::SystemWallClock& clock() { return clock_; }
    [[nodiscard]] crypto::SystemRandom& random() { return random_; }
    /// Null without a folder and without certificates.
    [[nodiscard]] crypto::CertificateValidator* validator()
    {
        return validator_ ? &*validator_ : nullptr;
    }

private:
    [[nodiscard]] StatusCode take_certificate(const busbar_application& application,
                                              FailureText& failure);
    [[nodiscard]] StatusCode load_certificate(FailureText& failure);

    std::string uri_;
    std::string name_;
    std::string host_;
    CallbackLog log_;
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    std::unique_ptr<Storage> storage_;
    std::optional<crypto::CertificateStore> store_;
    std::optional<crypto::StoreValidator> validator_;
    std::optional<channel::ApplicationIdentity> identity_;
};

} // namespace busbar::c
