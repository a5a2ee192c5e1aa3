#pragma once

#include <busbar/core/detail/guarded.hpp>
#include <busbar/crypto/jwt.hpp>
#include <busbar/server/environment.hpp>

namespace busbar::server::detail {

/// The status of an exception of a callback during a request, which is answered with it and not
/// with a result derived from the callback's missing answer.
class RequestFault {
public:
    /// While it exists, this request is being served.
    class Serving {
    public:
        Serving(RequestFault& fault, const void* peer, std::uint32_t request_id) : fault_{fault}
        {
            fault_ = {peer, request_id, {}};
        }
        Serving(const Serving&) = delete;
        Serving& operator=(const Serving&) = delete;
        ~Serving() { fault_ = {}; }

    private:
        RequestFault& fault_;
    };

    RequestFault() = default;

    void note(StatusCode status) { status_ = status; }
    /// Call it before code that checks is_noted() by itself.
    void forget() { status_ = {}; }
    [[nodiscard]] bool is_noted() const { return status_.is_bad(); }
    /// Returns the answer of the request: `status` if no callback threw.
    [[nodiscard]] StatusCode answer(const void* peer, std::uint32_t request_id,
                                    StatusCode status) const
    {
        const bool is_its_own = peer == peer_ && request_id == request_id_ && is_noted();
        return is_its_own ? status_ : status;
    }

private:
    RequestFault(const void* peer, std::uint32_t request_id, StatusCode status)
        : peer_{peer}, request_id_{request_id}, status_{status}
    {
    }

    const void* peer_{nullptr};
    std::uint32_t request_id_{0};
    StatusCode status_;
};

/// The destination of reports of one server's guards.
struct FaultReport {
    LogSink* log;
    RequestFault* request;

    /// Calls user code.
    template <typename Function>
    StatusCode guard(std::string_view callback, Function&& function) const
    {
        const StatusCode status =
            busbar::detail::guarded(*log, callback, std::forward<Function>(function));
        if (status.is_bad()) {
            request->note(status);
        }
        return status;
    }
    /// Calls user code that returns a value; returns `otherwise` if it threw.
    template <typename T, typename Function>
    T guard(std::string_view callback, T otherwise, Function&& function) const
    {
        static_cast<void>(guard(callback, [&] { otherwise = function(); }));
        return otherwise;
    }
};

/// Denies everything if the user's AccessControl throws.
class GuardedAccess final : public AccessControl {
public:
    GuardedAccess(const AccessControl* inner, const FaultReport& report)
        : inner_{inner}, report_{report}
    {
    }

    [[nodiscard]] bool may_browse(const UserIdentity& user, const NodeId& node) const override;
    [[nodiscard]] std::uint8_t user_access_level(const UserIdentity& user, const NodeId& node,
                                                 std::uint8_t access_level) const override;
    [[nodiscard]] bool may_call(const UserIdentity& user, const NodeId& method) const override;
    [[nodiscard]] std::uint32_t user_write_mask(const UserIdentity& user, const NodeId& node,
                                                std::uint32_t write_mask) const override;
    [[nodiscard]] bool may_add_node(const UserIdentity& user, const NodeId& parent) const override;
    [[nodiscard]] bool may_delete_node(const UserIdentity& user, const NodeId& node) const override;
    [[nodiscard]] bool may_add_reference(const UserIdentity& user,
                                         const NodeId& node) const override;
    [[nodiscard]] bool may_remove_reference(const UserIdentity& user,
                                            const NodeId& node) const override;

private:
    const AccessControl* inner_;
    FaultReport report_;
};

/// Trusts no certificate if the user's validator throws.
class GuardedValidator final : public crypto::CertificateValidator {
public:
    explicit GuardedValidator(const FaultReport& report) : report_{report} {}

    void guard(crypto::CertificateValidator* inner) { inner_ = inner; }
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override;

private:
    crypto::CertificateValidator* inner_{nullptr};
    FaultReport report_;
};

/// Knows no user if the user's UserStore throws.
class GuardedUsers final : public UserStore {
public:
    GuardedUsers(UserStore* inner, const FaultReport& report)
        : inner_{inner}, report_{report}, validator_{report}
    {
    }

    /// For a Worker, which may still call the store when the server and its guards are destroyed.
    [[nodiscard]] UserStore& inner() { return *inner_; }

    [[nodiscard]] Result<UserIdentity> log_in(std::string_view name,
                                              std::string_view password) override;
    [[nodiscard]] Worker* worker() override;
    [[nodiscard]] bool has_code(std::string_view name) const override;
    [[nodiscard]] UserIdentity anonymous() const override;
    [[nodiscard]] crypto::CertificateValidator* certificate_validator() override;
    [[nodiscard]] Result<UserRights>
    certificate_user(const crypto::Certificate& certificate) override;
    [[nodiscard]] const crypto::JwtRules* token_rules() const override;
    [[nodiscard]] Result<UserRights> token_user(const crypto::JwtClaims& claims) override;

private:
    UserStore* inner_;
    FaultReport report_;
    GuardedValidator validator_;
};

/// The guards between a server and its environment.
class Guards {
public:
    /// Faults are reported to `rationed`, since peers can cause them.
    Guards(const ServerEnvironment& environment, LogSink& rationed);
    Guards(const Guards&) = delete;
    Guards& operator=(const Guards&) = delete;

    /// The guarded environment.
    [[nodiscard]] ServerEnvironment environment();
    [[nodiscard]] const FaultReport& report() const { return report_; }
    [[nodiscard]] RequestFault& request() { return request_; }
    /// Only if the environment has a UserStore.
    [[nodiscard]] UserStore& unguarded_users() { return users_.inner(); }

private:
    ServerEnvironment given_;
    RequestFault request_;
    FaultReport report_;
    busbar::detail::SafeLog log_;
    GuardedValidator validator_;
    GuardedUsers users_;
    GuardedAccess access_;
};

} // namespace busbar::server::detail
